// The way of the imbalance: Karetin's curve in the frame of link 1, or what it has passed lately in the fixed frame.

import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial } from "three";
import { aboutAxis, imbalance, period, type Geometry } from "./geometry";
import type { Mechanism } from "./mechanism";
import { COLOURS } from "./palette";

export type TraceFrame = "link1" | "fixed" | "off";

const POINTS_A_TURN = 240;
const MOST_POINTS = 12000;
const TRAIL = 900;
const MOST_LINES = 24;

function line(points: number, opacity: number): Line<BufferGeometry, LineBasicMaterial> {
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(new Float32Array(3 * points), 3));
  const found = new Line(shape, new LineBasicMaterial({ color: COLOURS.imbalance, transparent: true, opacity }));
  found.frustumCulled = false;
  return found;
}

/** All traces of a mechanism. `closed` belongs into the frame of link 1, `trail` into the fixed frame. */
export class Trace {
  readonly closed = new Group();
  readonly trail = line(TRAIL, 0.9);

  constructor(private readonly shape: Geometry, { shift, front }: Pick<Mechanism, "shift" | "front">) {
    this.closed.position.x = this.trail.position.x = front;
    const span = period(shape);
    const points = Math.min(Math.ceil((span / (2 * Math.PI)) * POINTS_A_TURN), MOST_POINTS) + 1;
    const satellites = shape.layout === "planar" ? shape.satellites : 1;
    const first = line(points, 0.85);
    const place = first.geometry.getAttribute("position") as BufferAttribute;
    for (let n = 0; n < points; n++) place.setXYZ(n, ...imbalance(shape, (span * n) / (points - 1)));
    this.closed.add(first);
    const others = Math.min(shape.modules * satellites, MOST_LINES);
    for (let n = 1; n < others; n++) {
      const other = new Line(first.geometry, first.material.clone());
      other.material.opacity = 0.3;
      const module = Math.floor(n / satellites);
      other.rotation.x = 2 * Math.PI * (module / shape.modules + (n % satellites) / satellites);
      other.position.x = module * shift;
      this.closed.add(other);
    }
    this.show("link1");
  }

  show(frame: TraceFrame): void {
    this.closed.visible = frame === "link1";
    this.trail.visible = frame === "fixed";
  }

  /** Lay the trail of imbalance 0 along angles (q, theta1), oldest first. */
  follow(angles: (part: number) => { q: number; theta1: number }): void {
    if (!this.trail.visible) return;
    const place = this.trail.geometry.getAttribute("position") as BufferAttribute;
    for (let n = 0; n < TRAIL; n++) {
      const { q, theta1 } = angles(n / (TRAIL - 1));
      place.setXYZ(n, ...aboutAxis(imbalance(this.shape, q), theta1));
    }
    place.needsUpdate = true;
  }
}
