// A panel of curves over time: choice of signals, legend with values at the clock, scrubbing.

import { choice, element } from "../common/dom";
import { readUnit, steadyText } from "../common/units";
import type { Run } from "../run/run";
import { indexAt, isCoarse } from "../run/sample";
import { Plot } from "./plot";
import { labelOf, PANELS, type Panel } from "./signals";

function panelOf(id: string): Panel {
  const found = PANELS.find((panel) => panel.id === id);
  if (!found) throw new Error(`there is no panel ${id}`);
  return found;
}

/** A panel of curves over time. */
export class TimePanel {
  readonly root: HTMLElement;
  private readonly area = element("div", { class: "plot" });
  private readonly legend = element("ul", { class: "legend" });
  private readonly select: HTMLSelectElement;
  private plot: Plot | null = null;
  private panel: Panel;
  private run: Run | null = null;
  private data: Float64Array[] = [];
  private cells: { cell: HTMLElement; largest: number }[] = [];
  private window: [number, number] = [0, 1];
  private time = 0;

  constructor(first: string, private readonly scrub: (time: number) => void) {
    this.panel = panelOf(first);
    this.select = choice("Curves", PANELS.map(({ id }) => [id, ""]), first, (id) => {
      this.panel = panelOf(id);
      this.rebuild();
    });
    this.root = element("section", { class: "panel" }, element("header", {}, this.select), this.legend, this.area);
    this.title();
    this.listen();
  }

  /** Show another panel of signals. */
  choose(id: string): void {
    this.select.value = id;
    this.panel = panelOf(id);
    this.rebuild();
  }

  /** Show a run between two times, s. */
  show(run: Run, window: [number, number]): void {
    const other = !this.run || isCoarse(this.run) !== isCoarse(run);
    this.run = run;
    this.window = window;
    if (!this.plot || other) { this.rebuild(); return; }
    this.compute(run);
    this.plot.plot.setData([run.time, ...this.data]);
  }

  /** Move the window without another run. */
  move(window: [number, number]): void {
    this.window = window;
    this.plot?.plot.setScale("x", { min: window[0], max: window[1] });
  }

  /** Create the plot again after a change of colours or size. */
  rebuild(): void {
    const { run } = this;
    this.title();
    this.plot?.destroy();
    this.plot = null;
    if (!run || !this.area.isConnected) return;
    this.legendOf(this.panel, run);
    this.compute(run);
    this.plot = new Plot(this.area, {
      x: "time [s]",
      axes: [{ label: `[${readUnit(this.panel.unit).text}]` }],
      lines: this.panel.series.map((series) => ({ ...series, dots: series.coarse === "dots" && isCoarse(run) })),
      range: { x: () => this.window },
    }, [run.time, ...this.data]);
    this.stand(this.time, true);
  }

  /** Move the cursor to the time of the animation; write the values into the legend if `tell`. */
  stand(time: number, tell: boolean): void {
    this.time = time;
    this.plot?.stand(time);
    if (!tell || !this.run) return;
    const index = indexAt(this.run.time, time);
    this.cells.forEach(({ cell, largest }, n) => {
      cell.textContent = steadyText(this.data[n]?.[index] ?? NaN, largest);
    });
  }

  /** Name the panel and its choices, in the displayed units. */
  private title(): void {
    PANELS.forEach(({ title, unit }, n) => {
      const option = this.select.options[n];
      if (option) option.textContent = `${title} [${readUnit(unit).text}]`;
    });
    this.root.setAttribute("aria-label", `Curves: ${this.panel.title}`);
  }

  private compute(run: Run): void {
    const { factor } = readUnit(this.panel.unit);
    this.data = this.panel.series.map((series) => factor === 1 ? series.of(run) : series.of(run).map((value) => factor * value));
    this.data.forEach((values, n) => {
      const cell = this.cells[n];
      if (cell) cell.largest = values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    });
  }

  private legendOf(panel: Panel, run: Run): void {
    this.legend.replaceChildren();
    this.cells = panel.series.map((series) => {
      const cell = element("output", { "aria-live": "off" });
      const mark = element("i", { style: `background:${series.colour}` });
      this.legend.append(element("li", {}, mark, `${labelOf(series, run)} `, cell, ` ${readUnit(panel.unit).text}`));
      return { cell, largest: 0 };
    });
  }

  private listen(): void {
    const move = (event: PointerEvent): void => {
      const over = this.plot?.plot.over.getBoundingClientRect();
      if (over && this.plot) this.scrub(this.plot.plot.posToVal(event.clientX - over.left, "x"));
    };
    this.area.addEventListener("pointerdown", (event) => {
      this.area.setPointerCapture(event.pointerId);
      move(event);
    });
    this.area.addEventListener("pointermove", (event) => {
      if (this.area.hasPointerCapture(event.pointerId)) move(event);
    });
  }
}
