// Shafts, freewheels, flywheel and mount: parts on the central axis besides the mechanism.

import { Group, Mesh, Vector3, type BufferGeometry, type MeshLambertMaterial } from "three";
import { value, type Parameters } from "./geometry";
import type { Mechanism } from "./mechanism";
import type { PartName } from "./labels";
import type { Palette } from "./palette";
import { bar, box, merged, race, spokes } from "./solids";

const TURN = 2 * Math.PI;

/** Places along the central axis, m. */
export interface Stations {
  readonly input: number;
  readonly link2: number;
  readonly housing: number;
  readonly freewheel: number;
  readonly output: number;
  /** Centre of the flywheel, or of the hub of an elastic shaft, and of the driven inertia. */
  readonly flywheel: number;
  readonly driven: number;
  readonly end: number;
}

type Rollers = Mesh<BufferGeometry, MeshLambertMaterial>;

export interface Shafts {
  readonly stations: Stations;
  /** Rotates with the output shaft upstream of an elastic shaft. */
  readonly hub: Group;
  /** Rotates with the driven inertia. */
  readonly driven: Group;
  /** Stationary. */
  readonly mount: Group;
  /** Of both freewheels, each with its own material, which is coloured while it is locked. */
  readonly rollers: { readonly housing: Rollers; readonly output: Rollers };
  /** Names of the parts. */
  readonly names: readonly PartName[];
  /** Marks along the elastic shaft, from hub to driven inertia. */
  readonly marks: Mesh[];
}

/** A flywheel with spokes, which make its rotation visible. */
function wheel(at: number, radius: number, width: number, shaft: number): BufferGeometry {
  return merged([
    race(at - width / 2, at + width / 2, radius * 0.82, radius),
    race(at - width / 2, at + width / 2, 0, shaft * 1.8),
    ...spokes(5, at, 0, radius * 0.85, width * 0.28),
  ]);
}

/** The rollers between the races of a freewheel. */
function rollers(from: number, to: number, radius: number, size: number): BufferGeometry {
  const parts = Array.from({ length: 12 }, (_, n) => {
    const [y, z] = [radius * Math.cos((TURN * n) / 12), radius * Math.sin((TURN * n) / 12)];
    return bar([from, y, z], [to, y, z], size, 14);
  });
  return merged(parts);
}

/** Move rollers off the outer race by the remaining take-up angle, 0 to 1. */
export function standOff(rollers: Rollers, play: number): void {
  rollers.scale.set(1, 1 - 0.12 * play, 1 - 0.12 * play);
}

/** A foot from a bearing down to the base. */
function foot(at: number, width: number, radius: number, base: number): BufferGeometry {
  return box([at - width / 2, -radius * 0.55, base], [at + width / 2, radius * 0.55, -radius * 0.8]);
}

/** Radius of a flywheel drawn for its inertia, m. */
function wheelRadius(inertia: number, reach: number): number {
  return reach * 0.62 * Math.min(Math.max((inertia / 0.5) ** 0.2, 0.45), 1.4);
}

/** Build the parts downstream and upstream of a mechanism; those that rotate with links 1 and 2 join their groups. */
export function buildShafts(parameters: Parameters, mechanism: Mechanism, palette: Palette): Shafts {
  const { reach, from, to } = mechanism;
  const elastic = value(parameters, "fidelity") === 3;
  const radius = reach * 0.07;
  const outer = reach * 0.3;
  const width = reach * 0.2;
  const stations: Stations = {
    input: from - reach * 0.55,
    link2: to + reach * 0.12,
    housing: to + reach * 0.36,
    freewheel: to + reach * 0.74,
    output: to + reach * 1.0,
    flywheel: to + reach * 1.22,
    driven: to + reach * 2.1,
    end: to + reach * (elastic ? 2.45 : 1.55),
  };
  const material = palette.materials;
  const hub = new Group();
  const driven = new Group();
  const mount = new Group();
  const base = -reach * 1.16;

  // link 1: a shaft with a bolted coupling
  const bolts = rollers(stations.input - reach * 0.08, stations.input + reach * 0.05, reach * 0.13, reach * 0.022);
  mechanism.link1.add(new Mesh(merged([
    bar([stations.input, 0, 0], [from, 0, 0], radius),
    race(stations.input - reach * 0.06, stations.input, 0, reach * 0.18), bolts,
  ]), material.link1));

  // link 2: a shaft with the inner races
  const inner = outer * 0.55;
  const races = [bar([to - reach * 0.1, 0, 0], [stations.freewheel + width / 2, 0, 0], radius)];
  const roller = outer * 0.12;
  const around = (at: number): Rollers =>
    new Mesh(rollers(at - width * 0.55, at + width * 0.55, inner + roller, roller), material.steel.clone());
  const rolling = { housing: around(stations.housing), output: around(stations.freewheel) };
  for (const [name, at, there] of [
    ["housing", stations.housing, value(parameters, "housing_freewheel")],
    ["output", stations.freewheel, value(parameters, "output_freewheel")],
  ] as const) {
    if (there === 0) continue;
    // the bore clears the shaft, so that a cut shows one surface
    races.push(race(at - width / 2, at + width / 2, radius * 1.02, inner));
    mechanism.link2.add(rolling[name]);
  }
  mechanism.link2.add(new Mesh(merged(races), material.link2));

  // output: the outer race, its shaft and the flywheel
  const hubEnd = elastic ? stations.flywheel : stations.end;
  const cup = stations.freewheel + width * 0.75;
  hub.add(new Mesh(merged([
    race(stations.freewheel - width / 2, cup, inner + 2 * roller, outer),
    race(cup - width * 0.12, cup, 0, outer),
    bar([cup, 0, 0], [hubEnd, 0, 0], radius),
    wheel(stations.flywheel, wheelRadius(value(parameters, "output_inertia"), reach), width * 0.8, radius),
  ]), material.output));
  const marks: Mesh[] = [];
  if (elastic) {
    const slim = radius * 0.55;
    const span = stations.driven - stations.flywheel;
    for (let n = 0; n < 24; n++) {
      const start = stations.flywheel + (span * n) / 24;
      const piece = merged([
        bar([start, 0, 0], [start + span / 24, 0, 0], slim, 16),
        box([start, -slim * 0.35, slim * 0.8], [start + span / 24, slim * 0.35, slim * 1.5]),
      ]);
      const mark = new Mesh(piece, material.output);
      marks.push(mark);
      mount.add(mark);
    }
    driven.add(new Mesh(merged([
      wheel(stations.driven, wheelRadius(value(parameters, "driven_inertia"), reach), width * 0.8, radius),
      bar([stations.driven, 0, 0], [stations.end, 0, 0], radius),
    ]), material.output));
  }

  // the mount: outer race of the housing freewheel, bearings, base
  const bearings = [from - reach * 0.3, stations.end - reach * 0.06];
  const solids = [
    box([stations.input - reach * 0.15, -reach * 0.5, base - reach * 0.05], [stations.end + reach * 0.1, reach * 0.5, base]),
    race(stations.housing - width / 2, stations.housing + width / 2, inner + 2 * roller, outer * 1.12),
    foot(stations.housing, width, outer * 1.12, base),
  ];
  for (const at of bearings) {
    solids.push(race(at - width * 0.25, at + width * 0.25, radius * 1.1, radius * 2.2), foot(at, width * 0.5, radius * 2.2, base));
  }
  mount.add(new Mesh(merged(solids), material.housing));
  const name = (text: string, part: string, at: number, height: number, side: "above" | "below"): PartName =>
    ({ text, part, on: mount, at: new Vector3(at, 0, height), side });
  const names = [
    name("housing freewheel", "housing", stations.housing, outer * 0.95, "above"),
    name("output freewheel", "output", stations.freewheel, -outer * 0.9, "below"),
    name(elastic ? "hub of the elastic shaft" : "output flywheel", "output", stations.flywheel, wheelRadius(value(parameters, "output_inertia"), reach) * 0.9, "above"),
    name("output shaft", "output", stations.end, 0, "below"),
    name("housing", "housing", stations.housing, base * 0.7, "below"),
    ...(elastic ? [name("driven flywheel", "output", stations.driven, wheelRadius(value(parameters, "driven_inertia"), reach) * 0.9, "above")] : []),
  ];
  return { stations, hub, driven, mount, rollers: rolling, marks, names };
}
