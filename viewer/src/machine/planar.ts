// The planar mechanism (Lysenko): planets on pins of link 1 roll on the sun gear, link 2.
//
// The equations have all modules in one plane. They are drawn side by side; otherwise their planets would collide.

import { Group, Mesh, Vector3, type BufferGeometry } from "three";
import { drawnTeeth, spurGear, toothOffset } from "./gears";
import type { Planar } from "./geometry";
import type { Mechanism } from "./mechanism";
import type { Palette } from "./palette";
import { bar, merged, race } from "./solids";

const TURN = 2 * Math.PI;

/** Link 1 of one module: a hub, and for each planet an arm with its pin. */
function spider(shape: Planar, at: number, width: number, thick: number): BufferGeometry {
  const distance = shape.sun + shape.satellite;
  const plate = at - width * 0.95;
  const parts = [race(plate - thick, plate + thick, 0, thick * 2.4)];
  for (let j = 0; j < shape.satellites; j++) {
    const angle = (TURN * j) / shape.satellites;
    const y = -distance * Math.sin(angle);
    const z = distance * Math.cos(angle);
    parts.push(bar([plate, 0, 0], [plate, y, z], thick), bar([plate - thick, y, z], [at + width * 0.7, y, z], thick * 0.9));
    parts.push(bar([plate - thick, y, z], [plate + thick, y, z], thick * 1.6));
  }
  return merged(parts);
}

/** The planar mechanism in the frame of link 1. */
export function planarMechanism(shape: Planar, imbalanceRadius: number, drawn: number, palette: Palette): Mechanism {
  const link1 = new Group();
  const link2 = new Group();
  const distance = shape.sun + shape.satellite;
  const width = shape.satellite * 0.55;
  const thick = Math.min(shape.satellite, shape.sun) * 0.16;
  const step = width * 2.6;
  const unit = Math.max(1, Math.round((24 * shape.sun) / shape.satellite));
  const [teethSun, teeth] = drawnTeeth(unit, 24);
  const radius = Math.min(imbalanceRadius, shape.satellite * 0.3);
  const spins: Group[] = [];
  const slugs: Mesh[] = [];
  const suns: BufferGeometry[] = [];
  for (let i = 0; i < drawn; i++) {
    const at = i * step;
    const module = new Group();
    module.rotation.x = (TURN * i) / shape.modules;
    module.add(new Mesh(spider(shape, at, width, thick), palette.materials.link1));
    suns.push(spurGear(teethSun, shape.sun, width, shape.sun * 0.72).rotateX(Math.PI / teethSun).translate(at, 0, 0));
    suns.push(race(at - width * 0.25, at + width * 0.25, 0, shape.sun * 0.75));
    for (let j = 0; j < shape.satellites; j++) {
      const angle = (TURN * j) / shape.satellites;
      const arm = new Group();
      arm.rotation.x = angle;
      const spin = new Group();
      spin.position.set(at, 0, distance);
      // a tooth of the planet points to a gap of the sun gear; the offset of the sun gear has the opposite sign
      const contact = angle + (TURN * i) / shape.modules;
      const gap = Math.PI - toothOffset(teethSun, contact) * (TURN / teeth);
      const gear = spurGear(teeth, shape.satellite, width, shape.satellite * 0.8).rotateX(gap);
      const web = race(-width * 0.2, width * 0.2, thick, shape.satellite * 0.82);
      const hub = race(-width * 0.5, width * 0.5, thick, thick * 2);
      spin.add(new Mesh(merged([gear, web, hub]), palette.materials.satellite));
      const slug = bar([-width * 0.62, 0, -shape.arm], [width * 0.62, 0, -shape.arm], radius);
      const imbalance = new Mesh(slug, palette.materials.imbalance);
      slugs.push(imbalance);
      spin.add(imbalance);
      spins.push(spin);
      arm.add(spin);
      module.add(arm);
    }
    link1.add(module);
  }
  link2.add(new Mesh(merged(suns), palette.materials.link2));
  const last = (drawn - 1) * step;
  const reach = distance + Math.max(shape.satellite * 1.1, shape.arm + radius);
  const [first, frontSpin] = [slugs[0], spins[0]];
  if (!first || !frontSpin) throw new Error("a mechanism must have a satellite");
  return {
    link1, link2, from: -width * 0.95, to: last + width * 0.3, reach, thick, shift: step, front: -width * 0.68,
    imbalance: first, imbalanceAt: new Vector3(0, 0, -shape.arm),
    remarks: drawn > 1 ? ["The modules act in one plane; the picture shows them side by side."] : [],
    names: [
      { text: "satellite", part: "satellite", on: frontSpin, at: new Vector3(0, 0, 0), side: "above" },
      { text: "sun gear, link 2", part: "link2", on: link2, at: new Vector3(0, 0, -shape.sun * 0.85), side: "below" },
    ],
    turn(q) {
      link2.rotation.x = -q / shape.k;
      for (const spin of spins) spin.rotation.x = q;
    },
  };
}
