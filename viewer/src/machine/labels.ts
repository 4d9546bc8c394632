// Names of the parts over the view, in rows above and below the mechanism, with lines to the parts.

import { Vector3, type Camera, type Object3D } from "three";
import { element } from "../common/dom";

/** Name of a part and the point to which its line leads, in the frame of an object. */
export interface PartName {
  readonly text: string;
  /** Part whose colour the name has. */
  readonly part: string;
  readonly on: Object3D;
  readonly at: Vector3;
  readonly side: "above" | "below";
}

interface Label extends PartName {
  readonly chip: HTMLElement;
  readonly line: HTMLElement;
  /** Length of the text at the last measurement, and its width, px. */
  length: number;
  width: number;
}

/** A label with the projection of its point, px. */
interface Placed {
  readonly label: Label;
  readonly x: number;
  readonly y: number;
}

/** Height of a row and gap between names, px. */
const ROW = 21;
const GAP = 6;
/** Largest shift of a name to the right that keeps it in a row, px. */
const SHIFT = 140;

/** Names with lines. */
export class Labels {
  private labels: Label[] = [];
  private readonly point = new Vector3();
  /** Space for other things at the upper and lower edge, px. */
  margins = { above: 4, below: 4 };

  constructor(private readonly host: HTMLElement) {
    // screen readers find the names in the table of values
    host.setAttribute("aria-hidden", "true");
  }

  set visible(shown: boolean) {
    this.host.hidden = !shown;
  }

  clear(): void {
    this.labels = [];
    this.host.replaceChildren();
  }

  add(name: PartName): HTMLElement {
    const chip = element("span", { class: `label part-${name.part}` }, name.text);
    const line = element("i", { class: `leader part-${name.part}` });
    this.host.append(line, chip);
    this.labels.push({ ...name, chip, line, length: 0, width: 0 });
    return chip;
  }

  /** Measure all names again: the size of the letters depends on the size of the page. */
  resize(): void {
    for (const label of this.labels) label.width = 0;
  }

  /** Move the names into rows by their places along the view; names of one row do not overlap. */
  place(camera: Camera, width: number, height: number): void {
    if (this.host.hidden) return;
    const placed = this.labels.flatMap((label): Placed[] => {
      const isVisible = isShown(label.on);
      label.chip.hidden = label.line.hidden = !isVisible;
      if (!isVisible) return [];
      this.point.copy(label.at).applyMatrix4(label.on.matrixWorld).project(camera);
      measure(label);
      return [{ label, x: (0.5 + this.point.x / 2) * width, y: (0.5 - this.point.y / 2) * height }];
    });
    for (const side of ["above", "below"] as const) {
      const ofSide = placed.filter(({ label }) => label.side === side).sort((one, other) => one.x - other.x);
      // ends of the names in each row so far, px
      const rows: number[] = [];
      for (const { label, x, y } of ofSide) {
        const most = Math.max(width - label.width - 2, 2);
        const natural = Math.min(Math.max(x - label.width / 2, 2), most);
        const free = rows.findIndex((end) => end + GAP <= Math.min(natural + SHIFT, most));
        const row = free === -1 ? rows.length : free;
        const left = Math.max(natural, (rows[row] ?? -GAP) + GAP);
        rows[row] = left + label.width;
        const top = side === "above" ? this.margins.above + ROW * row : height - this.margins.below - ROW * (row + 1);
        const edge = side === "above" ? top + ROW - 3 : top;
        label.chip.style.transform = `translate(clamp(0px, ${left.toFixed(1)}px, ${width}px - 100%), ${top.toFixed(1)}px)`;
        lead(label.line, left + label.width / 2, edge, x, y);
      }
    }
  }
}

/** Measure the width of a label whose text has another length. */
function measure(label: Label): void {
  const { length } = label.chip.textContent;
  if (length === label.length && label.width > 0) return;
  label.length = length;
  label.width = label.chip.offsetWidth;
}

/** Draw a straight line as a turned bar, without a layout of the page. */
function lead(line: HTMLElement, fromX: number, fromY: number, toX: number, toY: number): void {
  const length = Math.hypot(toX - fromX, toY - fromY);
  const angle = Math.atan2(toY - fromY, toX - fromX);
  line.style.transform = `translate(${fromX.toFixed(1)}px, ${fromY.toFixed(1)}px) rotate(${angle.toFixed(4)}rad) scaleX(${length.toFixed(1)})`;
}

/** Return true if an object and all its parents are visible. */
function isShown(thing: Object3D): boolean {
  return thing.visible && (thing.parent === null || isShown(thing.parent));
}
