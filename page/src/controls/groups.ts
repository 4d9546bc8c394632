// Which variables stand together, and how far their sliders reach. What is in no group stands in the last one.

import { variables, type Variable } from "../run/run";

export interface Group {
  readonly title: string;
  readonly names: readonly string[];
  readonly open?: boolean;
  /** Whether the group has a meaning with these values. */
  readonly counts?: (value: (name: string) => number) => boolean;
}

const LISTED: readonly Group[] = [
  { title: "Drive and load", names: ["drive", "omega1", "drive_torque", "load_torque"], open: true },
  { title: "Layout", names: ["layout", "modules", "satellites"], open: true },
  {
    title: "Planar gears", names: ["sun_radius", "satellite_radius", "eccentricity"], open: true,
    counts: (value) => value("layout") === 1,
  },
  {
    title: "Bevel gears", counts: (value) => value("layout") === 0,
    names: ["wheel_radius", "shaft_angle", "z2", "z16", "z17", "z6", "a", "b", "c", "epsilon", "gamma"],
  },
  {
    title: "Masses and inertias", open: true,
    names: ["imbalance_mass", "output_inertia", "link2_inertia", "input_inertia", "drive_inertia", "satellite_inertia",
      "satellite_transverse_inertia", "gravity"],
  },
  {
    title: "Elastic output shaft", counts: (value) => value("fidelity") === 3, open: true,
    names: ["driven_inertia", "shaft_stiffness", "shaft_damping", "driven_friction", "balancer"],
  },
  {
    title: "Losses",
    names: ["mesh_efficiency", "satellite_mesh_efficiency", "journal_friction", "housing_drag", "housing_drag_viscous",
      "output_drag", "output_drag_viscous", "input_friction", "drive_friction", "link2_friction", "output_friction"],
  },
  {
    title: "Freewheels",
    names: ["housing_freewheel", "output_freewheel", "housing_stiffness", "housing_damping", "freewheel_stiffness", "freewheel_damping"],
  },
  { title: "Model and accuracy", names: ["fidelity", "kinematic_ratio", "method", "tolerance", "max_step", "input_hold"], open: true },
  { title: "Start", names: ["omega2_start", "omega_out_start", "drive_angle_start"] },
];

const settable = variables.filter((v) => v.causality === "input" || v.causality === "parameter");
const listed = new Set(LISTED.flatMap((group) => group.names));
const others = settable.filter((v) => !listed.has(v.name)).map((v) => v.name);

/** All groups; none of the variables that can be set is left out. */
export const GROUPS: readonly Group[] = others.length > 0 ? [...LISTED, { title: "Other", names: others }] : LISTED;

/** How far a slider reaches where the start value, 0 or far from the middle, does not say it, in the unit of the table. */
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

/** What the slider of a variable reaches; the field beside it takes any number. */
export function reachOf(variable: Variable): Reach {
  const powers = POWERS[variable.name];
  if (powers) return { from: powers[0], to: powers[1], powers: true };
  const start = variable.start ?? 0;
  const [from, to] = REACH[variable.name] ?? [Math.max(variable.min ?? 0, 0), 3 * start || 1];
  return { from: Math.max(from, variable.min ?? from), to, powers: false };
}
