// Path of the unbalanced mass: Karetin's curve in the frame of link 1, or the recent path in the fixed frame.

import {
  BufferAttribute, BufferGeometry, Curve, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, TubeGeometry, Vector3,
} from "three";
import { PARTS } from "../common/colours";
import { aboutAxis, imbalance, period, type Geometry } from "./geometry";
import type { Mechanism } from "./mechanism";

export type TraceFrame = "link1" | "fixed" | "off";

const SEGMENTS_PER_TURN = 72;
const MAX_SEGMENTS = 4000;
/** Radius of the path, as a fraction of the reach. */
const THICKNESS = 0.006;
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

/** The path of the unbalanced mass in the frame of link 1 over a period. */
class Path extends Curve<Vector3> {
  constructor(private readonly shape: Geometry, private readonly span: number) {
    super();
  }

  override getPoint(part: number, target = new Vector3()): Vector3 {
    return target.set(...imbalance(this.shape, this.span * part));
  }

  override getPointAt(part: number, target?: Vector3): Vector3 {
    return this.getPoint(part, target);
  }
}

/** Return a material of the path. */
function pathMaterial(opacity: number): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: PARTS.trace, transparent: true, opacity });
}

/** All traces of a mechanism. `closed` belongs into the frame of link 1, `trail` into the fixed frame. */
export class Trace {
  readonly closed = new Group();
  readonly trail = movingLine(TRAIL);

  constructor(private readonly shape: Geometry, { shift, front, reach }: Pick<Mechanism, "shift" | "front" | "reach">) {
    this.closed.position.x = this.trail.position.x = front;
    const span = period(shape);
    const segments = Math.min(Math.ceil((span / (2 * Math.PI)) * SEGMENTS_PER_TURN), MAX_SEGMENTS);
    const satellites = shape.layout === "planar" ? shape.satellites : 1;
    // a wire: the wide lines of three are instances, which a processor draws one by one
    const wire = new TubeGeometry(new Path(shape, span), segments, THICKNESS * reach, 4, true);
    const [first, other] = [pathMaterial(0.9), pathMaterial(0.45)];
    const lines = Math.min(shape.modules * satellites, MOST_LINES);
    for (let n = 0; n < lines; n++) {
      const line = new Mesh(wire, n === 0 ? first : other);
      const module = Math.floor(n / satellites);
      line.rotation.x = 2 * Math.PI * (module / shape.modules + (n % satellites) / satellites);
      line.position.x = module * shift;
      line.raycast = () => undefined;
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
