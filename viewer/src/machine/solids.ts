// Plain bodies of shafts and arms, about the central axis or another axis, merged to few meshes.

import { BoxGeometry, BufferGeometry, CylinderGeometry, LatheGeometry, Quaternion, Vector2, Vector3 } from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import type { Vector } from "./geometry";

/** A round bar from one point to another. */
export function bar(from: Vector, to: Vector, radius: number, sides = 40): BufferGeometry {
  const start = new Vector3(...from);
  const along = new Vector3(...to).sub(start);
  const solid = new CylinderGeometry(radius, radius, along.length(), sides);
  solid.applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.clone().normalize()));
  return solid.translate(start.x + along.x / 2, start.y + along.y / 2, start.z + along.z / 2);
}

/** A box between two opposite corners. */
export function box(low: Vector, high: Vector): BufferGeometry {
  const size = [high[0] - low[0], high[1] - low[1], high[2] - low[2]] as const;
  return new BoxGeometry(...size).translate(low[0] + size[0] / 2, low[1] + size[1] / 2, low[2] + size[2] / 2);
}

/** A ring about the central axis Ox from x = from to x = to. */
export function race(from: number, to: number, inner: number, outer: number): BufferGeometry {
  const profile = [[inner, from], [outer, from], [outer, to], [inner, to], [inner, from]] as const;
  const solid = new LatheGeometry(profile.map(([radius, height]) => new Vector2(radius, height)), 48);
  // a lathe turns about y: y becomes x
  return solid.rotateZ(-Math.PI / 2);
}

/** Spokes of a wheel about Ox, which show its rotation and the parts downstream. */
export function spokes(count: number, at: number, inner: number, outer: number, thick: number): BufferGeometry[] {
  return Array.from({ length: count }, (_, n) => {
    const [y, z] = [Math.cos((2 * Math.PI * n) / count), Math.sin((2 * Math.PI * n) / count)];
    return bar([at, inner * y, inner * z], [at, outer * y, outer * z], thick, 20);
  });
}

/** Merge bodies: fewer draw calls. */
export function merged(parts: BufferGeometry[]): BufferGeometry {
  const plain = parts.map((part) => {
    const flat = part.index ? part.toNonIndexed() : part;
    for (const name of Object.keys(flat.attributes)) if (name !== "position") flat.deleteAttribute(name);
    return flat;
  });
  const whole = mergeGeometries(plain);
  for (const part of parts) part.dispose();
  return whole;
}
