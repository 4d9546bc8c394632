// The animation of a run: the mechanism at one time.

import { byId } from "./common/dom";
import { holding, plays, pulseAround } from "./controls/pulses";
import { View, type Shown, type ViewName } from "./machine/view";
import type { Part } from "./machine/palette";
import { value, type Parameters } from "./machine/geometry";
import type { Run } from "./run/run";
import { largest, lengthOf, nearest, shownName, valueAt } from "./run/sample";

const AXES = ["x", "y", "z"] as const;
const TORQUES = ["input_torque", "mesh_torque", "housing_torque", "output_torque"];
/** Time constant of the freewheel colour, without flashes, s. */
const CALM = 0.15;
/** Distance of names from the edges of the view, px. */
const EDGE = 6;
/** Time without movement of the camera until the picture is sharp, ms. */
const SETTLED = 200;

export class Picture {
  private readonly view: View;
  private readonly holds = { housing: 0, output: 0 };
  /** Displayed take-up angle remaining of each freewheel, 0 to 1. */
  readonly play = { housing: 0, output: 0 };
  private plays: Run | null = null;
  private built = "";
  private homeWanted = true;
  private trail = 0.1;
  private isInSight = true;
  /** Timer that runs while the camera moves, else 0. */
  private settling = 0;
  /** Called with the part under the pointer, or null. */
  pointed: (part: Part | null) => void = () => undefined;

  constructor(private readonly again: () => void) {
    const host = byId("machine");
    const canvas = host.querySelector("canvas");
    if (!canvas) throw new Error("internal error: missing canvas");
    this.view = new View(canvas, byId("labels"));
    this.view.controls.addEventListener("change", () => { this.move(); });
    new ResizeObserver(() => { this.resize(host); }).observe(host);
    new IntersectionObserver(([entry]) => {
      this.isInSight = entry?.isIntersecting ?? true;
      again();
    }).observe(host);
    this.listen(canvas);
    this.resize(host);
  }

  /** Look at all of it again when the next run comes. */
  home(): void {
    this.homeWanted = true;
  }

  /** See the whole mechanism from a direction. */
  look(from: ViewName): void {
    this.homeWanted = false;
    this.view.look(from);
    this.again();
  }

  /** Turn the camera, rad. */
  turn(right: number, upward: number): void {
    this.view.turn(right, upward);
  }

  /** Change the distance of the camera by a factor. */
  zoom(factor: number): void {
    this.view.zoom(factor);
  }

  /** Brighten a part. */
  highlight(part: Part | null): void {
    this.view.highlight(part);
    this.again();
  }

  /** Remarks on the picture. */
  get remarks(): readonly string[] {
    return this.view.remarks;
  }

  /** Pixels per CSS pixel of the last picture: for tests. */
  get pixelRatio(): number {
    return this.view.pixelRatio;
  }

  /** Return true while frames are slow. */
  get isSlow(): boolean {
    return this.view.isSlow;
  }

  show(shown: Shown): void {
    this.view.show(shown);
    this.again();
  }

  /** Show the mechanism before its first run. */
  still(parameters: Parameters): void {
    const column = (): number => 0;
    this.view.build(parameters, true);
    this.view.draw({
      q: 0, theta1: 0, thetaOut: 0, twist: 0, holds: this.holds, play: this.play, column, past: () => ({ q: 0, theta1: 0 }),
    }, true, true);
  }

  /** Show the mechanism of a run; build it again only if its parameters differ. */
  run(run: Run): void {
    const parameters = JSON.stringify(run.parameters);
    if (parameters !== this.built) {
      this.view.build(run.parameters, this.homeWanted);
      this.built = parameters;
    } else if (this.homeWanted) this.view.look("home");
    this.homeWanted = false;
    this.plays = plays(run);
    this.view.scale(
      largest(run, AXES.map((axis) => `imbalance_acceleration_${axis}`)),
      largest(run, AXES.map((axis) => `shaking_force_${axis}`)), largest(run, TORQUES.map((name) => shownName(run, name))));
    // the trail of the unbalanced mass in the fixed frame covers two pulses
    const [from, to] = pulseAround(run, lengthOf(run) / 2);
    this.trail = 2 * (to - from) || lengthOf(run);
  }

  /** Draw the mechanism, and move its names if `isDue`; return true while its colours change. */
  draw(run: Run, time: number, passed: number, isDue: boolean): boolean {
    const mode = holding(nearest(run, "contact_mode", time));
    const part = 1 - Math.exp(-passed / CALM);
    let changing = false;
    for (const name of ["housing", "output"] as const) {
      this.play[name] = this.plays ? valueAt(this.plays, name, time) : 0;
      this.holds[name] += (Number(mode[name]) - this.holds[name]) * part;
      changing ||= Math.abs(Number(mode[name]) - this.holds[name]) > 0.01;
    }
    if (this.isInSight) this.view.draw({
      q: valueAt(run, "q", time), theta1: valueAt(run, "theta1", time), thetaOut: valueAt(run, "theta_out", time),
      twist: value(run.parameters, "fidelity") === 3 ? valueAt(run, "shaft_twist", time) : 0,
      holds: this.holds, play: this.play,
      column: (name) => valueAt(run, shownName(run, name), time),
      past: (part) => {
        const at = Math.max(0, time - this.trail * (1 - part));
        return { q: valueAt(run, "q", at), theta1: valueAt(run, "theta1", at) };
      },
    }, Number.isFinite(passed) || this.settling !== 0, isDue || this.settling !== 0);
    return changing;
  }

  /** Displayed position of the reference mass and start of its arrow, m in the fixed frame: for tests. */
  imbalance(): { drawn: number[]; arrow: number[] } | null {
    return this.view.imbalance();
  }

  /** The camera moves: sharp again a moment after its last movement. */
  private move(): void {
    clearTimeout(this.settling);
    this.settling = window.setTimeout(() => {
      this.settling = 0;
      this.again();
    }, SETTLED);
    this.again();
  }

  /** Report the part under the pointer. */
  private listen(canvas: HTMLCanvasElement): void {
    let part: Part | null = null;
    const point = (next: Part | null): void => {
      if (next === part) return;
      part = next;
      this.highlight(part);
      this.pointed(part);
    };
    canvas.addEventListener("pointermove", ({ offsetX, offsetY, buttons }) => {
      if (buttons !== 0) return;
      point(this.view.partAt((2 * offsetX) / canvas.clientWidth - 1, 1 - (2 * offsetY) / canvas.clientHeight));
    });
    canvas.addEventListener("pointerleave", () => { point(null); });
  }

  private resize(host: HTMLElement): void {
    this.view.resize(Math.max(host.clientWidth, 1), Math.max(host.clientHeight, 1), Math.min(devicePixelRatio, 2));
    // the check boxes and the description lie over a wide view
    const isWide = matchMedia("(min-width: 1181px)").matches;
    const over = (id: string): number => (isWide ? byId(id).offsetHeight + 12 : EDGE);
    this.view.setMargins(over("shown"), Math.max(over("views"), over("story")));
    this.again();
  }
}
