// The row of curves: two panels over time, and the phase plot or the torque converter chart.

import { choice, element } from "../common/dom";
import type { Run } from "../run/run";
import { lengthOf, valueAt } from "../run/sample";
import type { ChartPoint } from "./chart";
import { ChartPanel } from "./chartpanel";
import { PhasePlot } from "./phase";
import { TimePanel } from "./timeplot";

const PHASE_NOTE = "The pinion shaft turns at q′ = k (ω1 − ω2). All its revolutions are overlaid; the dot is the current time.";

export class Curves {
  private readonly panels: TimePanel[];
  private readonly phase = new PhasePlot();
  private readonly chart = new ChartPanel();
  private readonly note = element("p", { class: "note" }, PHASE_NOTE);
  private readonly select: HTMLSelectElement;
  private run: Run | null = null;
  private turns = 0;
  private window: [number, number] = [0, 1];
  private updated = 0;
  private time = 0;

  constructor(host: HTMLElement, scrub: (time: number) => void) {
    this.panels = ["speeds", "torques"].map((id) => new TimePanel(id, scrub));
    this.select = choice("Phase plot or torque converter chart",
      [["phase", "Phase plot, ω2 over q"], ["chart", "Torque converter chart"]], "phase", (shown) => { this.turnTo(shown); });
    const third = element("section", { class: "panel", "aria-label": "Phase plot and torque converter chart" },
      element("header", {}, this.select), this.note, this.chart.note, this.phase.root, this.chart.root);
    host.append(...this.panels.map((panel) => panel.root), third);
    this.chart.root.hidden = this.chart.note.hidden = true;
  }

  show(run: Run): void {
    this.run = run;
    this.window = this.windowAt(0);
    for (const panel of this.panels) panel.show(run, this.window);
    this.phase.show(run);
    this.chart.show(run);
  }

  /** Choose the panels over time and the third panel. */
  choose(ids: readonly string[], third: "phase" | "chart"): void {
    this.panels.forEach((panel, n) => { panel.choose(ids[n] ?? ""); });
    this.select.value = third;
    this.turnTo(third);
  }

  /** Show a number of revolutions of link 1 at a time, 0: the whole run. */
  zoom(turns: number): void {
    this.turns = turns;
    this.window = [NaN, NaN];
  }

  /** Stand at the time of the picture. Numbers change ten times a second, or at once if nothing plays. */
  stand(time: number, playing: boolean): void {
    const window = this.windowAt(time);
    if (window[0] !== this.window[0] || window[1] !== this.window[1]) {
      this.window = window;
      for (const panel of this.panels) panel.move(window);
    }
    const now = performance.now();
    const tell = !playing || now - this.updated > 100;
    if (tell) this.updated = now;
    for (const panel of this.panels) panel.stand(time, tell);
    this.time = time;
    this.standThird();
  }

  /** Draw again in the colours of the theme. */
  rebuild(): void {
    for (const panel of this.panels) panel.rebuild();
    this.phase.rebuild();
    this.chart.rebuild();
    this.standThird();
  }

  /** The converter chart as far as it has been computed. */
  chartPoints(): readonly ChartPoint[] {
    return this.chart.points;
  }

  private turnTo(shown: string): void {
    const chart = shown === "chart";
    this.phase.root.hidden = this.note.hidden = chart;
    this.chart.root.hidden = this.chart.note.hidden = !chart;
    this.phase.rebuild();
    this.chart.rebuild();
    this.standThird();
  }

  private standThird(): void {
    if (this.phase.root.hidden) this.chart.stand(this.time);
    else this.phase.stand(this.time);
  }

  /** The time window of the curves that contains a time, as on an oscilloscope. */
  private windowAt(time: number): [number, number] {
    if (!this.run) return [0, 1];
    const length = lengthOf(this.run);
    const speed = Math.abs(valueAt(this.run, "input_speed", time));
    const span = (2 * Math.PI * this.turns) / Math.max(speed, 1e-9);
    if (this.turns === 0 || !(span < length)) return [0, length];
    // with changing speed a window starts only approximately at the end of the last one; it must contain the time
    const known = this.window;
    if (time >= known[0] && time <= known[1]) return known;
    const from = Math.min(span * Math.floor(time / span), length - span);
    return [from, from + span];
  }
}
