// The bevel mechanism (Karetin): on link 1, modules of a pinion 16 with planets 6 that roll on gear 17.
//
// Pitch cones and unbalanced masses are to scale; shafts, arms and the sizes of gears 2 and 16 are adapted.

import { Group, Matrix4, Mesh, SphereGeometry, Vector3, type BufferGeometry } from "three";
import type { Bevel } from "./geometry";
import { bevelGear, drawnTeeth, toothOffset } from "./gears";
import type { Palette } from "./palette";
import { bar, box, merged, race, spokes } from "./solids";
import type { Mechanism } from "./mechanism";

const TURN = 2 * Math.PI;
// teeth of the large gears are short, so that the planets stay visible
const RING = 0.86;

/** Clearance for planets and unbalanced masses: radius about the pinion axis, height above the central axis. */
function clearance(shape: Bevel, imbalanceRadius: number): { radius: number; top: number; bottom: number } {
  const sine = Math.sin(shape.sigma);
  const cosine = Math.cos(shape.sigma);
  const rim = Math.max(shape.arm, shape.slant * Math.sin(shape.phi)) * 1.08;
  const far = Math.max(shape.axis, shape.slant * Math.cos(shape.phi));
  const swing = Math.hypot(far * sine + rim * Math.abs(cosine), rim) + imbalanceRadius * 0.5;
  const middle = shape.apex - far * cosine;
  const wheel = shape.slant * Math.sin(shape.psi);
  return {
    radius: Math.max(swing, wheel * 1.08),
    top: Math.max(middle, shape.apex) + rim * sine + imbalanceRadius,
    bottom: shape.apex - shape.slant * Math.cos(shape.psi),
  };
}

interface Satellite {
  readonly spin: Group;
  readonly imbalance: Mesh;
}

/** Planet 6 and its unbalanced mass: apex Q in the origin, its axis towards Q is z, the mesh with gear 17 towards x. */
function satellite(shape: Bevel, teeth: number, gap: number, radius: number, palette: Palette): Satellite {
  const spin = new Group();
  const centre = shape.slant * Math.cos(shape.phi);
  const gear = bevelGear(teeth, shape.phi, shape.slant, -1).rotateZ(Math.PI / teeth + gap);
  const web = bar([0, 0, -centre * 0.97], [0, 0, -centre * 0.9], shape.slant * Math.sin(shape.phi) * 0.85);
  spin.add(new Mesh(merged([gear, web]), palette.materials.satellite));
  const ball = new SphereGeometry(radius, 24, 16).translate(shape.arm, 0, -shape.axis);
  const holder = bar([0, 0, -shape.axis], [shape.arm, 0, -shape.axis], radius * 0.3);
  const imbalance = new Mesh(merged([ball, holder]), palette.materials.imbalance);
  spin.add(imbalance);
  return { spin, imbalance };
}

/** Pinion 16 with the arms of its planets, turned by q about z. */
function driveBody(shape: Bevel, wheel: BufferGeometry[], outer: number, bottom: number, thick: number): BufferGeometry {
  const arms: BufferGeometry[] = [];
  const end = shape.axis * 1.06;
  for (let j = 0; j < shape.satellites; j++) {
    const azimuth = shape.gamma + (TURN * j) / shape.satellites;
    const across = end * Math.sin(shape.sigma);
    const tip = [across * Math.cos(azimuth), across * Math.sin(azimuth), shape.apex - end * Math.cos(shape.sigma)] as const;
    arms.push(bar([0, 0, shape.apex], tip, thick * 0.7));
  }
  return merged([...wheel, bar([0, 0, bottom], [0, 0, outer], thick), ...arms]);
}

/** The frame of link 1 for one module: contains gear 17 and the bearing of pinion 16. */
function bracket(shape: Bevel, flange: number, bearing: number, bottom: number, thick: number, teeth: number): BufferGeometry {
  const wheel = bevelGear(teeth, shape.psi, shape.slant, -1).translate(0, 0, shape.apex);
  const half = thick * 0.9;
  const foot = bottom - 2.2 * half;
  return merged([
    wheel,
    ...spokes(3, bottom + half * 0.4, 0, shape.slant * Math.sin(shape.psi) * 0.85, half * 0.8).map((spoke) => spoke.rotateY(-Math.PI / 2)),
    bar([0, 0, foot], [0, 0, bottom + 2 * half], thick * 1.6),
    box([-flange, -half, foot - half], [0, half, foot + half]),
    box([-flange, -half, bearing - half], [0, half, bearing + half]),
    box([-flange - half, -half, foot - half], [-flange + half, half, bearing + half]),
    bar([0, 0, bearing - half], [0, 0, bearing + half], thick * 2),
  ]);
}

/** The bevel mechanism in the frame of link 1. */
export function bevelMechanism(shape: Bevel, imbalanceRadius: number, drawn: number, palette: Palette): Mechanism {
  const link1 = new Group();
  const link2 = new Group();
  const needs = clearance(shape, imbalanceRadius);
  const thick = Math.min(needs.radius, needs.top) * 0.09;
  const bearing = needs.top + 2 * thick;
  const { z2, z16, z17, z6 } = shape.teeth;
  // gear 2 is beyond the planets, gear 16 outside the bearing of the pinion shaft
  const unit = Math.max((bearing + 2 * thick) / z2, (needs.radius * 1.12) / z16);
  const radius2 = unit * z2;
  const radius16 = unit * z16;
  const slant = Math.hypot(radius2, radius16);
  const [teeth2, teeth16] = drawnTeeth(z2, z16);
  const [teeth17, teeth6] = drawnTeeth(z17, z6);
  const flange = needs.radius * 1.12 + thick;

  const wheel2 = bevelGear(teeth2, Math.atan2(radius2, radius16), slant, 1, RING).rotateZ(Math.PI / teeth2);
  // its axis z becomes Ox, its azimuth 0 the axis of module 0
  wheel2.applyMatrix4(new Matrix4().makeBasis(new Vector3(0, 0, 1), new Vector3(0, -1, 0), new Vector3(1, 0, 0)));
  const at2 = radius16 * 0.96;
  const hub2 = race(at2 - 2 * thick, at2 + 2 * thick, 0, thick * 2.2);
  link2.add(new Mesh(merged([wheel2, hub2, ...spokes(6, at2, 0, radius2 * 0.9, thick * 0.7)]), palette.materials.link2));

  // half the angle about Ox that gears 16, with their teeth, and 17 of a module fill
  const half = Math.max(Math.atan(radius16 / radius2 / 0.95), Math.atan2(shape.slant * Math.sin(shape.psi), needs.bottom));
  const fitting = Math.max(1, Math.floor(Math.PI / half + 1e-9));
  const satellites: Satellite[] = [];
  const drives: Group[] = [];
  for (let i = 0; i < drawn; i++) {
    const turned = (TURN * i) / shape.modules;
    const module = new Group();
    module.rotation.x = turned;
    module.add(new Mesh(bracket(shape, flange, bearing, needs.bottom, thick, teeth17), palette.materials.link1));
    const drive = new Group();
    // teeth of gear 16 into the gaps of gear 2; planets keep their place on the pinion shaft
    const mesh16 = -toothOffset(teeth2, turned) * (TURN / teeth16);
    const wheel16 = bevelGear(teeth16, Math.atan2(radius16, radius2), slant, 1, RING).rotateZ(mesh16);
    const web = spokes(4, radius2 * 0.96, 0, radius16 * 0.9, thick * 0.6).map((spoke) => spoke.rotateY(-Math.PI / 2));
    const body = driveBody(shape, [wheel16, ...web], radius2, needs.bottom - 2 * thick, thick);
    drive.add(new Mesh(body, palette.materials.drive));
    for (let j = 0; j < shape.satellites; j++) {
      const azimuth = shape.gamma + (TURN * j) / shape.satellites;
      const place = new Group();
      const cosine = Math.cos(shape.sigma);
      const sine = Math.sin(shape.sigma);
      const basis = new Matrix4().makeBasis(
        new Vector3(-cosine, 0, -sine), new Vector3(0, -1, 0), new Vector3(-sine, 0, cosine));
      place.applyMatrix4(new Matrix4().makeRotationZ(azimuth).multiply(basis).setPosition(0, 0, shape.apex));
      // the gear, not its unbalanced mass, is turned until its gaps meet the teeth of gear 17
      const gap = -toothOffset(teeth17, azimuth) * (TURN / teeth6) - shape.epsilon;
      const found = satellite(shape, teeth6, gap, imbalanceRadius, palette);
      satellites.push(found);
      place.add(found.spin);
      drive.add(place);
    }
    drives.push(drive);
    module.add(drive);
    link1.add(module);
  }
  link1.add(new Mesh(race(-flange - thick, -flange + thick, 0, thick * 4), palette.materials.link1));
  const first = satellites[0];
  const frontModule = link1.children[0];
  if (!first || !frontModule) throw new Error("a mechanism must have a satellite");
  return {
    link1, link2,
    from: -flange, to: radius16, reach: Math.max(slant, Math.hypot(needs.radius, bearing)), thick,
    shift: 0, front: 0, imbalance: first.imbalance, imbalanceAt: new Vector3(shape.arm, 0, -shape.axis),
    remarks: shape.modules > fitting
      ? [`${shape.modules} modules do not fit around the central axis, at most ${fitting}: their gears pass through each other in the picture.`] : [],
    names: [
      { text: `drive gear ${z16}, on the pinion shaft`, part: "drive", on: frontModule, at: new Vector3(0, -radius16 * 0.94, radius2), side: "above" },
      { text: `gear ${z17}, fixed to link 1`, part: "link1", on: frontModule, at: new Vector3(0, -shape.slant * Math.sin(shape.psi), needs.bottom), side: "below" },
      { text: `satellite ${z6}`, part: "satellite", on: first.spin, at: new Vector3(0, 0, -shape.slant * Math.cos(shape.phi)), side: "above" },
      { text: `gear ${z2}, link 2`, part: "link2", on: link2, at: new Vector3(at2, 0, 0), side: "below" },
    ],
    turn(q) {
      link2.rotation.x = -q / shape.k;
      for (const drive of drives) drive.rotation.z = q;
      for (const { spin } of satellites) spin.rotation.z = shape.s * q + shape.epsilon;
    },
  };
}
