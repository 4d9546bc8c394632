// One plot: axes and lines by uPlot, a mark that follows the picture over it.

import uPlot, { type AlignedData, type Options, type Series } from "uplot";
import { element } from "../common/dom";
import { numberText } from "../common/units";

/** Colours of axes and grid, from the style sheet. */
function themed(host: HTMLElement): { text: string; grid: string } {
  const style = getComputedStyle(host);
  return { text: style.getPropertyValue("--muted"), grid: style.getPropertyValue("--grid") };
}

export interface Axis {
  readonly label: string;
  readonly scale?: "y" | "right";
}

/** Content of a plot; every line except x has its own scale. */
export interface Look {
  readonly x: string;
  readonly axes: readonly Axis[];
  readonly lines: readonly { readonly label: string; readonly colour: string; readonly right?: boolean; readonly dash?: boolean; readonly dots?: boolean }[];
  /** Limits of x and y; without them those of the data. */
  readonly range?: { x?: () => [number, number]; y?: () => [number, number] };
  readonly paint?: (plot: uPlot) => void;
}

// eslint-disable-next-line @typescript-eslint/no-unsafe-enum-assignment -- uPlot's types name the sides, its code does not
const ON_THE_RIGHT: Partial<uPlot.Axis> = { side: 1, grid: { show: false } };

/** A plot in an element that it fills. */
export class Plot {
  readonly plot: uPlot;
  private readonly mark = element("div", { class: "mark", "aria-hidden": "true" });
  private readonly sizes = new ResizeObserver(() => { this.plot.setSize(this.size()); });
  private place: () => void = () => undefined;

  constructor(private readonly host: HTMLElement, look: Look, data: AlignedData) {
    const { text, grid } = themed(host);
    const axis = { stroke: text, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: "12px system-ui", labelFont: "12px system-ui" };
    const values = (_: uPlot, ticks: number[]): string[] => ticks.map((tick) => numberText(tick, 5));
    const options: Options = {
      ...this.size(),
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, ...(look.range?.x && { range: look.range.x }) },
        y: look.range?.y ? { range: look.range.y } : {},
      },
      axes: [
        { ...axis, label: look.x, labelSize: 18, size: 30, values },
        ...look.axes.map(({ label, scale }) => ({
          ...axis, label, scale: scale ?? "y", labelSize: 18, size: 54, values,
          ...(scale === "right" && ON_THE_RIGHT),
        })),
      ],
      series: [{}, ...look.lines.map(({ label, colour, right, dash, dots }): Series => ({
        label, stroke: colour, width: 1.5, scale: right ? "right" : "y", points: { show: false },
        ...(dash && { dash: [6, 4] }),
        ...(dots && { paths: () => null, points: { show: true, size: 2.5, width: 0, fill: colour } }),
      }))],
      // the overlay of the plot moves with its axes
      hooks: { draw: [(plot) => { look.paint?.(plot); this.place(); }] },
    };
    this.plot = new uPlot(options, data, host);
    this.plot.over.append(this.mark);
    this.sizes.observe(host);
  }

  /** Stand at a value of x: a line from top to bottom. */
  stand(x: number): void {
    this.place = () => {
      this.mark.className = "mark line";
      this.mark.style.transform = `translateX(${this.plot.valToPos(x, "x").toFixed(1)}px)`;
    };
    this.place();
  }

  /** Stand on a point. */
  point(x: number, y: number): void {
    this.place = () => {
      const [left, top] = [this.plot.valToPos(x, "x"), this.plot.valToPos(y, "y")];
      const seen = Number.isFinite(left) && Number.isFinite(top);
      this.mark.className = seen ? "mark point" : "mark";
      if (seen) this.mark.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px)`;
    };
    this.place();
  }

  destroy(): void {
    this.sizes.disconnect();
    this.plot.destroy();
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(this.host.clientWidth, 80), height: Math.max(this.host.clientHeight, 80) };
  }
}
