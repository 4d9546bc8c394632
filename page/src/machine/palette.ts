// Colours and materials: one colour for a part and for its curves, apart for the colour-blind (Okabe and Ito).

import { DoubleSide, MeshPhongMaterial, type Plane } from "three";

export const COLOURS = {
  link1: "#3f7fb5",
  drive: "#7fb2d6",
  satellite: "#d3a04a",
  imbalance: "#c8501e",
  link2: "#2f9c78",
  output: "#b0729a",
  steel: "#9aa2ab",
  housing: "#7d858e",
  holds: "#f2a900",
  force: "#8a5cc2",
  trace: "#cc1f1a",
} as const;

export type Part = keyof typeof COLOURS;

/** The materials of all parts. Those of races, wheels and housing give way to the cut-away. */
export class Palette {
  readonly materials: Record<Part, MeshPhongMaterial>;

  constructor() {
    const make = (colour: string): MeshPhongMaterial =>
      new MeshPhongMaterial({ color: colour, flatShading: true, side: DoubleSide, shininess: 30, specular: 0x222222 });
    this.materials = Object.fromEntries(
      Object.entries(COLOURS).map(([part, colour]) => [part, make(colour)]),
    ) as Record<Part, MeshPhongMaterial>;
  }

  /** Cut the parts that hide others open along planes; none: whole. */
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
