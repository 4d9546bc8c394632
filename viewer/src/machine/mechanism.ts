// The drawn parts of a layout, in the frame of link 1.

import { Mesh, type Group, type Object3D, type Vector3 } from "three";
import { bevelMechanism } from "./bevel";
import { geometry, value, type Geometry, type Parameters } from "./geometry";
import type { PartName } from "./labels";
import type { Palette } from "./palette";
import { planarMechanism } from "./planar";

export interface Mechanism {
  /** Rotates with link 1; contains all parts except link 2. */
  readonly link1: Group;
  /** Gear 2, in the frame of link 1. */
  readonly link2: Group;
  /** Start of the shafts of links 1 and 2 on the central axis, m. */
  readonly from: number;
  readonly to: number;
  /** Radius of the rotating parts, m. */
  readonly reach: number;
  readonly thick: number;
  /** Distance along Ox from module to module (planar: drawn side by side), m. */
  readonly shift: number;
  /** Position on Ox of the path of an unbalanced mass, in front of its planet, m. */
  readonly front: number;
  /** Reference mass (planet 0, module 0), and its centre in the frame of its mesh. */
  readonly imbalance: Mesh;
  readonly imbalanceAt: Vector3;
  /** Remarks on the picture. */
  readonly remarks: readonly string[];
  /** Names of its parts. */
  readonly names: readonly PartName[];
  /** Turn pinion shafts, planets and gear 2 to the pinion-shaft angle q, rad. */
  turn(q: number): void;
}

// further modules or planets are counted, not drawn
const MOST_MODULES = 12;
const MOST_SATELLITES = 12;

/** Radius of an unbalanced mass as a ball of lead, limited to visible sizes, m. */
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

/** Free the graphics memory of an object. */
export function discard(thing: Object3D): void {
  thing.removeFromParent();
  thing.traverse((part) => {
    if (part instanceof Mesh) (part as Mesh).geometry.dispose();
  });
}
