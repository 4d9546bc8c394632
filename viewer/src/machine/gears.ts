// Gears: bevel gears on their pitch cones, spur gears on their pitch circles.

import { BufferGeometry, Float32BufferAttribute } from "three";
import type { Vector } from "./geometry";

/** Position of a point of the ring: height over the pitch line in modules, azimuth, and end of the tooth. */
type Place = (height: number, azimuth: number, end: 0 | 1) => Vector;

// one tooth of trapezoidal profile, centred on azimuth 0: part of the pitch, height in modules
const PROFILE: readonly (readonly [number, number])[] = [
  [-0.36, -1.1], [-0.15, 0.9], [0.15, 0.9], [0.36, -1.1],
];

function ring(teeth: number, place: Place, bore: Place): BufferGeometry {
  const corners: number[] = [];
  const index: number[] = [];
  for (let tooth = 0; tooth < teeth; tooth++) {
    for (const [part, height] of PROFILE) {
      const azimuth = ((tooth + part) * 2 * Math.PI) / teeth;
      corners.push(...place(height, azimuth, 0), ...place(height, azimuth, 1));
      corners.push(...bore(0, azimuth, 0), ...bore(0, azimuth, 1));
    }
  }
  const points = teeth * PROFILE.length;
  for (let point = 0; point < points; point++) {
    const here = 4 * point;
    const next = 4 * ((point + 1) % points);
    // tooth surface, both faces, bore: the corners are tooth 0, tooth 1, bore 0, bore 1
    for (const [first, second] of [[0, 1], [2, 0], [1, 3], [3, 2]] as const) {
      index.push(here + first, next + first, next + second, here + first, next + second, here + second);
    }
  }
  const found = new BufferGeometry();
  found.setAttribute("position", new Float32BufferAttribute(corners, 3));
  found.setIndex(index);
  return found;
}

/**
 * A bevel gear: pitch cone with its apex in the origin, around z.
 *
 * @param halfAngle of the pitch cone, rad
 * @param slant length of the pitch cone, m
 * @param side +1: the gear is on the side of positive z, -1: of negative z
 * @param inner inner end of the teeth, as a fraction of the cone
 */
export function bevelGear(teeth: number, halfAngle: number, slant: number, side: 1 | -1, inner = 0.74): BufferGeometry {
  const height = (2 * Math.sin(halfAngle)) / teeth;
  const body = Math.min(3 * height, 0.22);
  const at = (distance: number, angle: number, azimuth: number): Vector => [
    distance * Math.sin(angle) * Math.cos(azimuth),
    distance * Math.sin(angle) * Math.sin(azimuth),
    side * distance * Math.cos(angle),
  ];
  // mirrored, the ends change places, so that the surfaces still face outward
  const far = side === -1 ? 0 : 1;
  return ring(
    teeth,
    (over, azimuth, end) => at(end === far ? slant : inner * slant, halfAngle + over * height, azimuth),
    (_, azimuth, end) => at(end === far ? slant : inner * slant, Math.max(0.02, halfAngle - body), azimuth),
  );
}

/** A spur gear around x, in the middle of its width, its first tooth towards +z. */
export function spurGear(teeth: number, radius: number, width: number, bore: number): BufferGeometry {
  const height = (2 * radius) / teeth;
  const at = (distance: number, azimuth: number, end: 0 | 1): Vector => [
    (end - 0.5) * width,
    -distance * Math.sin(azimuth),
    distance * Math.cos(azimuth),
  ];
  return ring(
    teeth,
    (over, azimuth, end) => at(radius + over * height, azimuth, end),
    (_, azimuth, end) => at(bore, azimuth, end),
  );
}

/** Drawn numbers of teeth of a pair: limited to visible teeth. */
export function drawnTeeth(first: number, second: number): [number, number] {
  const scale = Math.max(12 / Math.min(first, second), 1) * Math.min(1, 80 / Math.max(first, second));
  return [Math.max(4, Math.round(first * scale)), Math.max(4, Math.round(second * scale))];
}

/** Distance of the nearest tooth from an azimuth, in pitches, -1/2 to 1/2. */
export function toothOffset(teeth: number, azimuth: number): number {
  const pitches = (azimuth * teeth) / (2 * Math.PI);
  return Math.round(pitches) - pitches;
}
