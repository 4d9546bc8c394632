// The animation of a run: the mechanism at one time.

import { byId } from "./common/dom";
import { holding, plays, pulseAround } from "./controls/pulses";
import { View, type Shown } from "./machine/view";
import { value, type Parameters } from "./machine/geometry";
import type { Run } from "./run/run";
import { largest, lengthOf, nearest, shownName, valueAt } from "./run/sample";

const AXES = ["x", "y", "z"] as const;
const TORQUES = ["input_torque", "mesh_torque", "housing_torque", "output_torque"];
/** Time constant of the freewheel colour, without flashes, s. */
const CALM = 0.15;

export class Picture {
  private readonly view: View;
  private readonly holds = { housing: 0, output: 0 };
  /** Displayed take-up angle remaining of each freewheel, 0 to 1. */
  readonly play = { housing: 0, output: 0 };
  private plays: Run | null = null;
  private built = "";
  private homeWanted = true;
  private trail = 0.1;

  constructor(private readonly again: () => void) {
    const host = byId("machine");
    const canvas = host.querySelector("canvas");
    if (!canvas) throw new Error("internal error: missing canvas");
    this.view = new View(canvas, byId("labels"));
    this.view.controls.addEventListener("change", again);
    new ResizeObserver(() => { this.resize(host); }).observe(host);
    this.resize(host);
  }

  /** Look at all of it again when the next run comes. */
  home(): void {
    this.homeWanted = true;
  }

  look(): void {
    this.view.lookHome();
    this.again();
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
    });
  }

  /** Show the mechanism of a run; build it again only if its parameters differ. */
  run(run: Run): void {
    const parameters = JSON.stringify(run.parameters);
    if (parameters !== this.built) {
      this.view.build(run.parameters, this.homeWanted);
      this.built = parameters;
    } else if (this.homeWanted) this.view.lookHome();
    this.homeWanted = false;
    this.plays = plays(run);
    this.view.scale(
      largest(run, AXES.map((axis) => `imbalance_acceleration_${axis}`)),
      largest(run, AXES.map((axis) => `shaking_force_${axis}`)), largest(run, TORQUES.map((name) => shownName(run, name))));
    // the trail of the unbalanced mass in the fixed frame covers two pulses
    const [from, to] = pulseAround(run, lengthOf(run) / 2);
    this.trail = 2 * (to - from) || lengthOf(run);
  }

  /** Draw the mechanism; return true while its colours change. */
  draw(run: Run, time: number, passed: number): boolean {
    const mode = holding(nearest(run, "contact_mode", time));
    const part = 1 - Math.exp(-passed / CALM);
    let changing = false;
    for (const name of ["housing", "output"] as const) {
      this.play[name] = this.plays ? valueAt(this.plays, name, time) : 0;
      this.holds[name] += (Number(mode[name]) - this.holds[name]) * part;
      changing ||= Math.abs(Number(mode[name]) - this.holds[name]) > 0.01;
    }
    this.view.draw({
      q: valueAt(run, "q", time), theta1: valueAt(run, "theta1", time), thetaOut: valueAt(run, "theta_out", time),
      twist: value(run.parameters, "fidelity") === 3 ? valueAt(run, "shaft_twist", time) : 0,
      holds: this.holds, play: this.play,
      column: (name) => valueAt(run, shownName(run, name), time),
      past: (part) => {
        const at = Math.max(0, time - this.trail * (1 - part));
        return { q: valueAt(run, "q", at), theta1: valueAt(run, "theta1", at) };
      },
    });
    return changing;
  }

  /** Displayed position of the reference mass and start of its arrow, m in the fixed frame: for tests. */
  imbalance(): { drawn: number[]; arrow: number[] } | null {
    return this.view.imbalance();
  }

  private resize(host: HTMLElement): void {
    this.view.resize(Math.max(host.clientWidth, 1), Math.max(host.clientHeight, 1), Math.min(devicePixelRatio, 2));
    this.again();
  }
}
