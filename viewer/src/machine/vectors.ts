// Arrows for accelerations and forces, arcs for torques.

import {
  type BufferGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, TubeGeometry,
  CatmullRomCurve3, Vector3,
} from "three";
import { merged } from "./solids";

const UP = new Vector3(0, 1, 0);

/** Arrows are drawn over the mechanism. */
function over(colour: string): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.92 });
}

/** A straight arrow. */
export class Arrow extends Group {
  private readonly shaft: Mesh;
  /** Its head, where its label is. */
  readonly tip: Mesh;
  private readonly turn = new Quaternion();
  private readonly along = new Vector3();

  constructor(colour: string, private readonly thick: number) {
    super();
    const material = over(colour);
    this.shaft = new Mesh(new CylinderGeometry(thick, thick, 1, 12).translate(0, 0.5, 0), material);
    this.tip = new Mesh(new ConeGeometry(2.6 * thick, 6 * thick, 16).translate(0, 3 * thick, 0), material);
    this.add(this.shaft, this.tip);
  }

  /** Draw from a point along a vector, m. */
  point(from: Vector3, x: number, y: number, z: number): void {
    this.along.set(x, y, z);
    const length = this.along.length();
    this.position.copy(from);
    this.shaft.scale.set(1, Math.max(length - 6 * this.thick, 1e-9), 1);
    this.tip.scale.setScalar(Math.min(1, length / (6 * this.thick) + 1e-9));
    this.tip.position.y = Math.max(length - 6 * this.thick, 0);
    if (length > 0) this.quaternion.copy(this.turn.setFromUnitVectors(UP, this.along.divideScalar(length)));
  }
}

const SEGMENTS = 96;
const SIDES = 8;
const WIDEST = 1.6 * Math.PI;

/** A curved arrow about the central axis; its length scales with a torque. */
export class TorqueArc extends Group {
  private readonly tube: Mesh;
  private readonly head: Mesh;

  constructor(colour: string, private readonly radius: number, thick: number) {
    super();
    const material = over(colour);
    const points = Array.from({ length: 65 }, (_, n) => {
      const angle = (WIDEST * n) / 64;
      return new Vector3(0, radius * Math.cos(angle), radius * Math.sin(angle));
    });
    const shape: BufferGeometry = new TubeGeometry(new CatmullRomCurve3(points), SEGMENTS, thick, SIDES);
    this.tube = new Mesh(shape, material);
    // the head points along +z, where an arc from +y begins
    this.head = new Mesh(merged([new ConeGeometry(2.8 * thick, 7 * thick, 16).rotateX(Math.PI / 2)]), material);
    this.add(this.tube, this.head);
  }

  /** Show a fraction of the longest arc, -1 to 1; negative values reverse the direction. */
  bend(part: number): void {
    const size = Math.min(Math.abs(part), 1);
    const shown = Math.round(size * SEGMENTS);
    this.tube.geometry.setDrawRange(0, shown * SIDES * 6);
    this.visible = shown > 0;
    const angle = (WIDEST * shown) / SEGMENTS;
    this.head.position.set(0, this.radius * Math.cos(angle), this.radius * Math.sin(angle));
    this.head.rotation.x = angle;
    this.scale.z = part < 0 ? -1 : 1;
  }
}
