// Which variables stand together, as in the table of variables, and how far their sliders reach.

import { variables, type Variable } from "../run/run";

type Value = (name: string) => number;

export interface Group {
  readonly title: string;
  readonly names: readonly string[];
  readonly open?: boolean;
  /** Return true if the group has an effect with these values. */
  readonly counts?: (value: Value) => boolean;
}

const OPEN = ["Inputs at the flanges", "Layout", "Planar layout", "Masses, inertias and gravity", "Elastic output", "Model and solver"];

const COUNTS: Readonly<Record<string, (value: Value) => boolean>> = {
  "Planar layout": (value) => value("layout") === 1,
  "Bevel layout": (value) => value("layout") === 0,
  "Elastic output": (value) => value("fidelity") === 3,
};

// (`method` has one value that is not deprecated)
const settable = variables.filter((v) => (v.causality === "input" || v.causality === "parameter") && v.name !== "method");
const titles = [...new Set(settable.map((v) => v.group))];
for (const title of [...OPEN, ...Object.keys(COUNTS)]) {
  if (!titles.includes(title)) throw new Error(`there is no group ${title}`);
}

/** All groups of settings, in the order of the table. */
export const GROUPS: readonly Group[] = titles.map((title) => ({
  title,
  names: settable.filter((v) => v.group === title).map((v) => v.name),
  open: OPEN.includes(title),
  counts: COUNTS[title] ?? (() => true),
}));

/** Maximum of a slider without start or nominal value, in the unit of the table. */
const REACH: Readonly<Record<string, readonly [number, number]>> = {
  omega1: [0, 400], drive_torque: [-20, 100], load_torque: [-20, 100], modules: [1, 6], satellites: [1, 6],
  a: [0, 2], b: [0.2, 2], c: [0, 4], epsilon: [-Math.PI, Math.PI], gamma: [-Math.PI, Math.PI], shaft_angle: [0.3, 2.8],
  z2: [8, 60], z16: [8, 60], z17: [8, 60], z6: [8, 60],
  input_inertia: [0, 1], drive_inertia: [0, 0.01], satellite_inertia: [0, 0.005], satellite_transverse_inertia: [0, 0.005],
  gravity: [0, 20], driven_friction: [0, 1], balancer: [0, 2], journal_friction: [0, 0.002], housing_drag: [0, 5],
  housing_drag_viscous: [0, 0.05], output_drag: [0, 5], output_drag_viscous: [0, 0.05], input_friction: [0, 0.1],
  drive_friction: [0, 0.05], link2_friction: [0, 0.1], output_friction: [0, 0.5], mesh_efficiency: [0.8, 1],
  satellite_mesh_efficiency: [0.8, 1], shaft_damping: [0, 5], housing_stiffness: [0, 1e5], freewheel_stiffness: [0, 1e5],
  housing_damping: [0, 50], freewheel_damping: [0, 50], max_step: [0, 0.001], kinematic_ratio: [0, 1.2],
  housing_engagement_angle: [0, Math.PI / 60], output_engagement_angle: [0, Math.PI / 60],
  omega2_start: [0, 200], omega_out_start: [0, 200], drive_angle_start: [-Math.PI, Math.PI],
};

/** Those whose slider goes by powers of ten, from and to. */
const POWERS: Readonly<Record<string, readonly [number, number]>> = {
  tolerance: [1e-12, 1e-2], shaft_stiffness: [10, 1e6], output_inertia: [0.01, 100], driven_inertia: [0.01, 100],
  link2_inertia: [1e-4, 1],
};

export interface Reach {
  readonly from: number;
  readonly to: number;
  readonly powers: boolean;
}

/** Range of the slider of a variable; the field next to it accepts any number. */
export function reachOf(variable: Variable): Reach {
  const powers = POWERS[variable.name];
  if (powers) return { from: powers[0], to: powers[1], powers: true };
  const start = variable.start ?? 0;
  const [from, to] = REACH[variable.name] ?? [Math.max(variable.min ?? 0, 0), 3 * start || (variable.nominal ?? 1)];
  return { from: Math.max(from, variable.min ?? from), to, powers: false };
}

/** Settings of each drawn part. */
export const FIELDS_OF: Readonly<Record<string, readonly string[]>> = {
  link1: ["omega1", "drive_torque", "input_inertia", "input_friction", "modules", "z17", "wheel_radius"],
  drive: ["drive_inertia", "drive_friction", "z16", "shaft_angle"],
  satellite: ["satellites", "satellite_inertia", "satellite_transverse_inertia", "satellite_radius", "z6", "b", "c"],
  imbalance: ["imbalance_mass", "a", "eccentricity", "epsilon", "gamma", "balancer"],
  link2: ["link2_inertia", "link2_friction", "z2", "sun_radius", "omega2_start"],
  output: ["load_torque", "output_inertia", "output_freewheel", "output_engagement_angle", "output_drag", "omega_out_start"],
  housing: ["housing_freewheel", "housing_engagement_angle", "housing_drag"],
};
for (const name of Object.values(FIELDS_OF).flat()) {
  if (!settable.some((v) => v.name === name)) throw new Error(`there is no setting ${name}`);
}
