// What a layout draws, in the frame of link 1.

import { Mesh, type Group, type Object3D, type Vector3 } from "three";
import { bevelMechanism } from "./bevel";
import { geometry, value, type Geometry, type Parameters } from "./geometry";
import type { Palette } from "./palette";
import { planarMechanism } from "./planar";

export interface Mechanism {
  /** Turns with link 1; holds all but link 2. */
  readonly link1: Group;
  /** Wheel 2, in the frame of link 1. */
  readonly link2: Group;
  /** Where the shafts of links 1 and 2 begin on the central axis, m. */
  readonly from: number;
  readonly to: number;
  /** Radius of what turns, m. */
  readonly reach: number;
  readonly thick: number;
  /** Distance along Ox from module to module (planar: drawn side by side), m. */
  readonly shift: number;
  /** Where on Ox the path of an imbalance is drawn, so that its satellite does not hide it, m. */
  readonly front: number;
  /** Imbalance 0 of module 0 as it is drawn, and its centre in the frame of its mesh. */
  readonly imbalance: Mesh;
  readonly imbalanceAt: Vector3;
  /** Turn drives, satellites and wheel 2 to the drive angle q, rad. */
  turn(q: number): void;
}

// more modules or satellites are counted, not drawn
const MOST_MODULES = 12;
const MOST_SATELLITES = 12;

/** Radius of an imbalance drawn as a ball of lead, within what can be seen, m. */
function ballRadius(mass: number, size: number): number {
  const radius = Math.cbrt((3 * mass) / (4 * Math.PI * 11340));
  return Math.min(Math.max(radius, 0.07 * size), 0.24 * size);
}

/** The mechanism of these parameters. */
export function buildMechanism(parameters: Parameters, palette: Palette): { mechanism: Mechanism; shape: Geometry } {
  const shape = geometry(parameters);
  const mass = value(parameters, "imbalance_mass");
  const seen = { ...shape, satellites: Math.min(shape.satellites, MOST_SATELLITES) };
  const drawn = Math.min(shape.modules, MOST_MODULES);
  const mechanism = seen.layout === "planar"
    ? planarMechanism(seen, ballRadius(mass, 2 * seen.satellite), drawn, palette)
    : bevelMechanism(seen, ballRadius(mass, seen.slant), drawn, palette);
  return { mechanism, shape };
}

/** Free what the graphics card keeps of a drawn thing. */
export function discard(thing: Object3D): void {
  thing.removeFromParent();
  thing.traverse((part) => {
    if (part instanceof Mesh) (part as Mesh).geometry.dispose();
  });
}
