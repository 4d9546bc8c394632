// The converter chart as a plot, computed point by point while the browser is idle.

import { CURVES } from "../common/colours";
import type { Run } from "../run/run";
import { valueAt } from "../run/sample";
import { element } from "../common/dom";
import { numberText, readUnit } from "../common/units";
import { chartPoint, chartRatios, operatingPoint, type ChartPoint } from "./chart";
import { Plot } from "./plot";

/** Parameters without effect on a chart: fixed by it, or start values. */
const APART = new Set(["output_inertia", "omega_out_start", "omega2_start", "fidelity", "drive", "driven_inertia"]);

export class ChartPanel {
  readonly root = element("div", { class: "plot" });
  readonly note = element("p", { class: "note" });
  private plot: Plot | null = null;
  private run: Run | null = null;
  points: ChartPoint[] = [];
  private made = "";
  private waiting = 0;
  /** Input speed of the complete chart, rad/s; 0 while points are missing. */
  private complete = 0;

  show(run: Run): void {
    this.run = run;
    this.refresh();
  }

  rebuild(): void {
    this.plot?.destroy();
    this.plot = null;
    if (!this.root.isConnected || this.root.hidden) return;
    this.plot = new Plot(this.root, {
      x: "speed ratio ω3/ω1",
      axes: [{ label: "mean torque [N·m]" }, { label: "efficiency [%]", scale: "right" }],
      lines: [
        { label: "input", colour: CURVES.blue },
        { label: "output", colour: CURVES.purple },
        { label: "efficiency", colour: CURVES.grey, right: true, dash: true },
      ],
      range: { x: () => [0, 1] },
    }, this.data());
    this.explain();
    this.refresh();
  }

  stand(time: number): void {
    if (!this.run || !this.plot) return;
    const { ratio, torque } = operatingPoint(this.run, time);
    this.plot.point(ratio >= 0 && ratio <= 1.02 ? ratio : NaN, torque);
  }

  /** Compute the missing points, one at a time. */
  private refresh(): void {
    if (!this.run || this.root.hidden || !this.root.isConnected) return;
    const speed = Number(Math.abs(valueAt(this.run, "input_speed", Infinity)).toPrecision(3));
    const { parameters } = this.run;
    const counts = Object.entries(parameters).filter(([name]) => !APART.has(name));
    const wanted = JSON.stringify([speed, counts]);
    if (wanted === this.made) return;
    this.made = wanted;
    this.points = [];
    this.complete = 0;
    clearTimeout(this.waiting);
    if (!(speed > 0)) {
      this.tell("The chart needs a turning input.");
      return;
    }
    this.next(parameters, speed, chartRatios());
  }

  private next(parameters: Run["parameters"], speed: number, [ratio, ...rest]: number[]): void {
    if (ratio === undefined) {
      this.complete = speed;
      this.explain();
      return;
    }
    this.waiting = window.setTimeout(() => {
      try {
        this.points.push(chartPoint(parameters, speed, ratio));
      } catch (error) {
        this.tell(`Chart not available: ${(error as Error).message}`);
        return;
      }
      this.plot?.plot.setData(this.data());
      this.next(parameters, speed, rest);
    }, 5);
  }

  /** Write the note of a complete chart. */
  private explain(): void {
    if (this.complete === 0) return;
    const { text: unit, factor } = readUnit("rad/s");
    this.tell(`Periodic steady state at ω1 = ${numberText(factor * this.complete)} ${unit}: input and output torque; efficiency dashed. The dot is the current time of the run.`);
  }

  private data(): [number[], ...number[][]] {
    const of = (name: keyof ChartPoint): number[] => this.points.map((point) => point[name]);
    return [of("ratio"), of("input"), of("output"), of("efficiency")];
  }

  private tell(text: string): void {
    this.note.textContent = text;
  }
}
