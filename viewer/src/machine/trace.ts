// Path of the unbalanced mass: Karetin's curve in the frame of link 1, or the recent path in the fixed frame.

import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial } from "three";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { PARTS } from "../common/colours";
import { aboutAxis, imbalance, period, type Geometry } from "./geometry";
import type { Mechanism } from "./mechanism";

export type TraceFrame = "link1" | "fixed" | "off";

const POINTS_A_TURN = 240;
const MOST_POINTS = 12000;
const TRAIL = 900;
const MOST_LINES = 24;

/** A line of n points that are updated in every frame. */
function movingLine(points: number): Line<BufferGeometry, LineBasicMaterial> {
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(new Float32Array(3 * points), 3));
  const found = new Line(shape, new LineBasicMaterial({ color: PARTS.trace }));
  found.frustumCulled = false;
  return found;
}

/** A line material of this width, in CSS pixels. */
function drawn(linewidth: number, opacity: number): LineMaterial {
  return new LineMaterial({ color: PARTS.trace, linewidth, transparent: true, opacity });
}

/** All traces of a mechanism. `closed` belongs into the frame of link 1, `trail` into the fixed frame. */
export class Trace {
  readonly closed = new Group();
  readonly trail = movingLine(TRAIL);

  constructor(private readonly shape: Geometry, { shift, front }: Pick<Mechanism, "shift" | "front">) {
    this.closed.position.x = this.trail.position.x = front;
    const span = period(shape);
    const points = Math.min(Math.ceil((span / (2 * Math.PI)) * POINTS_A_TURN), MOST_POINTS) + 1;
    const satellites = shape.layout === "planar" ? shape.satellites : 1;
    const geometry = new LineGeometry();
    geometry.setPositions(
      Array.from({ length: points }, (_, n) => imbalance(shape, (span * n) / (points - 1))).flat());
    const [first, other] = [drawn(1.6, 0.9), drawn(1.2, 0.45)];
    const lines = Math.min(shape.modules * satellites, MOST_LINES);
    for (let n = 0; n < lines; n++) {
      const line = new Line2(geometry, n === 0 ? first : other);
      const module = Math.floor(n / satellites);
      line.rotation.x = 2 * Math.PI * (module / shape.modules + (n % satellites) / satellites);
      line.position.x = module * shift;
      this.closed.add(line);
    }
    this.show("link1");
  }

  show(frame: TraceFrame): void {
    this.closed.visible = frame === "link1";
    this.trail.visible = frame === "fixed";
  }

  /** Update the trail of the reference mass along angles (q, theta1), oldest first. */
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
