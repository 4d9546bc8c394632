// Materials of the parts.

import { DoubleSide, MeshLambertMaterial, type Plane, type Vector3 } from "three";
import { PARTS } from "../common/colours";

export type Part = keyof typeof PARTS;

const CUT_PARTS = ["link2", "output", "housing"] as const;

/** Draw inner surfaces, which only a cut shows, in one light colour: the cut looks like the section of a solid. */
function capped(shader: { fragmentShader: string }): void {
  shader.fragmentShader = shader.fragmentShader.replace(
    "#include <opaque_fragment>",
    "if (!gl_FrontFacing) outgoingLight = mix(diffuse, vec3(1.0), 0.35);\n#include <opaque_fragment>");
}

/** Materials of all parts. Races, gears and housing are cut in the cut-away. */
export class Palette {
  readonly materials: Record<Part, MeshLambertMaterial>;

  constructor() {
    const make = (colour: string): MeshLambertMaterial =>
      new MeshLambertMaterial({ color: colour, flatShading: true, side: DoubleSide });
    this.materials = Object.fromEntries(
      Object.entries(PARTS).map(([part, colour]) => [part, make(colour)]),
    ) as Record<Part, MeshLambertMaterial>;
    for (const part of CUT_PARTS) this.materials[part].onBeforeCompile = capped;
  }

  /** Cut the outer parts along planes; without planes they are whole. */
  cut(planes: Plane[] | null): void {
    for (const part of CUT_PARTS) {
      const material = this.materials[part];
      material.clippingPlanes = planes;
      material.clipIntersection = true;
      material.needsUpdate = true;
    }
  }

  /** Return true if a point of a part is cut away. */
  isCutAway(part: Part, point: Vector3): boolean {
    const planes = CUT_PARTS.some((name) => name === part) ? this.materials[part].clippingPlanes : null;
    return planes !== null && planes.length > 0 && planes.every((plane) => plane.distanceToPoint(point) < 0);
  }

  /** Brighten the parts of one kind; null: none. */
  highlight(part: Part | null): void {
    for (const [name, material] of Object.entries(this.materials)) material.emissive.set(name === part ? 0x3a3a3a : 0);
  }

  /** Return the part that has a material, or null. */
  partOf(material: unknown): Part | null {
    const found = Object.entries(this.materials).find(([, own]) => own === material);
    return found ? found[0] as Part : null;
  }

  dispose(): void {
    for (const material of Object.values(this.materials)) material.dispose();
  }
}
