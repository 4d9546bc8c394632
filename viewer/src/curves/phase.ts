// The phase plot: speed of link 2 over the pinion-shaft angle.

import type uPlot from "uplot";
import { CURVES } from "../common/colours";
import { element } from "../common/dom";
import { readUnit } from "../common/units";
import type { Run } from "../run/run";
import { isCoarse, valueAt } from "../run/sample";
import { Plot } from "./plot";

const TURN = 2 * Math.PI;

/** An angle within one turn, rad. */
export function inTurn(angle: number): number {
  return angle - TURN * Math.floor(angle / TURN);
}

/** ω2 over q, all turns of the run over one another. */
export class PhasePlot {
  readonly root = element("div", { class: "plot" });
  private plot: Plot | null = null;
  private run: Run | null = null;

  show(run: Run): void {
    this.run = run;
    if (this.plot) this.plot.plot.setData(this.limits(run));
    else this.rebuild();
  }

  rebuild(): void {
    this.plot?.destroy();
    this.plot = null;
    if (!this.run || !this.root.isConnected || this.root.hidden) return;
    this.plot = new Plot(this.root, {
      x: "pinion-shaft angle q [rad]",
      axes: [{ label: `ω2 [${readUnit("rad/s").text}]` }],
      lines: [{ label: "ω2", colour: "transparent" }],
      range: { x: () => [0, TURN] },
      paint: (plot) => { this.paint(plot); },
    }, this.limits(this.run));
  }

  stand(time: number): void {
    if (this.run) this.plot?.point(inTurn(valueAt(this.run, "q", time)), readUnit("rad/s").factor * valueAt(this.run, "omega2", time));
  }

  /** Two points that hold all: uPlot makes the axes, paint the lines. */
  private limits(run: Run): [number[], number[]] {
    const speeds = run.columns.omega2 ?? new Float64Array();
    const low = speeds.reduce((least, value) => Math.min(least, value), 0);
    const high = speeds.reduce((most, value) => Math.max(most, value), low + 1);
    const { factor } = readUnit("rad/s");
    return [[0, TURN], [factor * low, factor * high]];
  }

  private paint(plot: uPlot): void {
    const { q, omega2 } = this.run?.columns ?? {};
    if (!this.run || !q || !omega2) return;
    const dots = isCoarse(this.run);
    const { factor } = readUnit("rad/s");
    const { ctx } = plot;
    const { left, top, width, height } = plot.bbox;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.beginPath();
    let before = NaN;
    for (let n = 0; n < q.length; n++) {
      const angle = inTurn(q[n] ?? NaN);
      const x = plot.valToPos(angle, "x", true);
      const y = plot.valToPos(factor * (omega2[n] ?? NaN), "y", true);
      // no line back where a turn ends
      if (dots) ctx.rect(x, y, devicePixelRatio, devicePixelRatio);
      else if (Math.abs(angle - before) < 0.5 * TURN) ctx.lineTo(x, y);
      else ctx.moveTo(x, y);
      before = angle;
    }
    ctx.strokeStyle = CURVES.green;
    ctx.globalAlpha = 0.85;
    ctx.lineWidth = devicePixelRatio;
    ctx.stroke();
    ctx.restore();
  }
}
