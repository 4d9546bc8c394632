// Labels of the parts, and arrows of accelerations, forces and torques.

import { Group, Vector3, type Object3D } from "three";
import { PARTS } from "../common/colours";
import { setText } from "../common/dom";
import { steadyText } from "../common/units";
import { aboutAxis, imbalance, type Geometry } from "./geometry";
import type { Labels } from "./labels";
import type { Mechanism } from "./mechanism";
import type { Shafts } from "./shafts";
import { Arrow, TorqueArc } from "./vectors";
import type { Instant, Shown } from "./view";

const TORQUES = ["input_torque", "mesh_torque", "housing_torque", "output_torque"] as const;
type Torque = (typeof TORQUES)[number];
const SYMBOLS: Readonly<Record<Torque, string>> = {
  input_torque: "M1", mesh_torque: "M2", housing_torque: "Th", output_torque: "Tc",
};
const PART: Readonly<Record<Torque, string>> = {
  input_torque: "link1", mesh_torque: "link2", housing_torque: "housing", output_torque: "output",
};
// shades that differ from the parts, for contrast
const ARC: Readonly<Record<Torque, string>> = {
  input_torque: "#1d4f91", mesh_torque: "#0c5c40", housing_torque: "#2f3840", output_torque: "#7a2c68",
};
/** Height of a torque value above the axis, as a fraction of the reach: next to labels and other values. */
const HEIGHT: Readonly<Record<Torque, number>> = {
  input_torque: -0.62, mesh_torque: -0.85, housing_torque: -1.02, output_torque: -0.78,
};
/** Interval between updates of values in the view, readable, ms. */
const READABLE = 120;

/** Labels and arrows on the mechanism. */
export class Annotations {
  readonly group = new Group();
  private readonly acceleration: Arrow;
  private readonly force: Arrow;
  private readonly arcs: Record<Torque, TorqueArc>;
  private readonly arcGroup = new Group();
  private readonly origin = new Vector3();
  /** Reference mass (planet 0, module 0) by the formulas, m in the fixed frame. */
  readonly imbalance = new Vector3();
  private readonly marker = new Group();
  private readonly longest: number;
  private readonly texts: { element: HTMLElement; text: (column: (name: string) => number) => string }[] = [];
  private updated = 0;
  private largest = { acceleration: 1, force: 1, torque: 1 };

  constructor(mechanism: Mechanism, shafts: Shafts, private readonly shape: Geometry, labels: Labels) {
    const { reach } = mechanism;
    const { stations } = shafts;
    this.longest = 0.95 * reach;
    this.acceleration = new Arrow(PARTS.imbalance, 0.016 * reach);
    this.force = new Arrow(PARTS.force, 0.02 * reach);
    const arc = (colour: string, at: number, radius: number): TorqueArc => {
      const found = new TorqueArc(colour, radius * reach, 0.022 * reach);
      found.position.x = at;
      this.arcGroup.add(found);
      return found;
    };
    this.arcs = {
      input_torque: arc(ARC.input_torque, stations.input + 0.14 * reach, 0.36),
      mesh_torque: arc(ARC.mesh_torque, stations.link2, 0.42),
      housing_torque: arc(ARC.housing_torque, stations.housing, 0.48),
      output_torque: arc(ARC.output_torque, stations.output, 0.42),
    };
    this.group.add(this.acceleration, this.force, this.arcGroup, this.marker);
    this.name(labels, mechanism, shafts);
    this.number(labels, mechanism.reach);
  }

  show({ acceleration, force, torques }: Shown): void {
    this.acceleration.visible = acceleration;
    this.force.visible = force;
    // with its acceleration shown, the mass is labelled at the arrow
    this.marker.visible = !acceleration;
    this.arcGroup.visible = torques;
  }

  /** Set the values of the longest arrows: m/s2, N and N.m. */
  scale(acceleration: number, force: number, torque: number): void {
    this.largest = { acceleration: acceleration || 1, force: force || 1, torque: torque || 1 };
  }

  /** Point the arrows; write the values if `isDue`. */
  place({ q, theta1, column }: Instant, isDue: boolean): void {
    const now = performance.now();
    if (isDue && now - this.updated > READABLE) {
      this.updated = now;
      for (const { element, text } of this.texts) setText(element, text(column));
    }
    this.imbalance.set(...aboutAxis(imbalance(this.shape, q), theta1));
    this.marker.position.copy(this.imbalance);
    if (this.acceleration.visible) this.point(this.acceleration, this.imbalance, "imbalance_acceleration", column, this.largest.acceleration);
    if (this.force.visible) this.point(this.force, this.origin, "shaking_force", column, this.largest.force);
    if (!this.arcGroup.visible) return;
    for (const name of TORQUES) this.arcs[name].bend(column(name) / this.largest.torque || 0);
  }

  private point(arrow: Arrow, from: Vector3, name: string, column: (name: string) => number, largest: number): void {
    const size = this.longest / largest;
    const [x, y, z] = ["x", "y", "z"].map((axis) => (column(`${name}_${axis}`) || 0) * size) as [number, number, number];
    arrow.point(from, x, y, z);
  }

  /** Values next to the arrows. */
  private number(labels: Labels, reach: number): void {
    const add = (part: string, on: Object3D, at: Vector3, text: (column: (name: string) => number) => string): void => {
      this.texts.push({ element: labels.add({ text: "−0000.00 N·m", part, on, at, side: "below" }), text });
    };
    for (const name of TORQUES) {
      const at = new Vector3(this.arcs[name].position.x, 0, HEIGHT[name] * reach);
      add(PART[name], this.arcGroup, at, (column) => `${SYMBOLS[name]} ${steadyText(column(name), this.largest.torque)} N·m`);
    }
    add("imbalance", this.acceleration.tip, new Vector3(),
      (column) => `unbalanced mass, acceleration ${steadyText(column("imbalance_acceleration"), this.largest.acceleration)} m/s²`);
    add("force", this.force.tip, new Vector3(), (column) => {
      const size = Math.hypot(column("shaking_force_x"), column("shaking_force_y"), column("shaking_force_z"));
      return `${steadyText(size, this.largest.force)} N on the mounting`;
    });
  }

  private name(labels: Labels, mechanism: Mechanism, { stations, names }: Shafts): void {
    for (const name of [...mechanism.names, ...names]) labels.add(name);
    labels.add({
      text: "link 1, carrier", part: "link1", on: this.group, at: new Vector3(stations.input, 0, 0), side: "below",
    });
    labels.add({ text: "unbalanced mass", part: "imbalance", on: this.marker, at: new Vector3(), side: "below" });
  }
}
