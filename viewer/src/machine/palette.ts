// Materials of the parts.

import { DoubleSide, MeshPhongMaterial, type Plane } from "three";
import { PARTS } from "../common/colours";

export type Part = keyof typeof PARTS;

/** Materials of all parts. Races, gears and housing are cut in the cut-away. */
export class Palette {
  readonly materials: Record<Part, MeshPhongMaterial>;

  constructor() {
    const make = (colour: string): MeshPhongMaterial =>
      new MeshPhongMaterial({ color: colour, flatShading: true, side: DoubleSide, shininess: 30, specular: 0x222222 });
    this.materials = Object.fromEntries(
      Object.entries(PARTS).map(([part, colour]) => [part, make(colour)]),
    ) as Record<Part, MeshPhongMaterial>;
  }

  /** Cut the outer parts along planes; without planes they are whole. */
  cut(planes: Plane[] | null): void {
    for (const part of ["link2", "output", "housing"] as const) {
      const material = this.materials[part];
      material.clippingPlanes = planes;
      material.clipIntersection = true;
      material.needsUpdate = true;
    }
  }

  dispose(): void {
    for (const material of Object.values(this.materials)) material.dispose();
  }
}
