// What the curves show of a run.

import type { Run } from "../run/run";

export interface Series {
  readonly label: string;
  readonly colour: string;
  readonly of: (run: Run) => Float64Array;
}

export interface Panel {
  readonly id: string;
  readonly title: string;
  readonly unit: string;
  readonly series: readonly Series[];
}

// dark enough on white and light enough on black: 3 : 1 at least on both
const BLUE = "#3a86c8";
const GREEN = "#229a6f";
const PURPLE = "#b565a0";
const ORANGE = "#c77f12";
const RED = "#d0532b";
const GREY = "#858d96";

function column(label: string, name: string, colour: string): Series {
  return { label, colour, of: (run) => run.columns[name] ?? new Float64Array(run.time.length) };
}

/** Length of a vector of three columns. */
function magnitude(label: string, name: string, colour: string): Series {
  return {
    label, colour,
    of: (run) => {
      const [x, y, z] = ["x", "y", "z"].map((axis) => run.columns[`${name}_${axis}`] ?? new Float64Array(run.time.length));
      return run.time.map((_, n) => Math.hypot(x?.[n] ?? 0, y?.[n] ?? 0, z?.[n] ?? 0));
    },
  };
}

/** Steps that a mean over a turn of link 1 takes, at least one. */
function stepsOfTurn(run: Run): number {
  const angle = Math.abs((run.columns.theta1?.at(-1) ?? 0) - (run.columns.theta1?.[0] ?? 0));
  const steps = run.time.length - 1;
  return angle > 0 ? Math.max(1, Math.min(steps, Math.round((2 * Math.PI * steps) / angle))) : 1;
}

/** Rate of an energy, its mean over about a turn of link 1: a power. */
function power(label: string, name: string, colour: string): Series {
  return {
    label, colour,
    of: (run) => {
      const energy = run.columns[name] ?? new Float64Array(run.time.length);
      const half = Math.ceil(stepsOfTurn(run) / 2);
      const last = run.time.length - 1;
      return energy.map((_, n) => {
        const [from, to] = [Math.max(0, n - half), Math.min(last, n + half)];
        const span = (run.time[to] ?? 0) - (run.time[from] ?? 0);
        return span > 0 ? ((energy[to] ?? 0) - (energy[from] ?? 0)) / span : 0;
      });
    },
  };
}

export const PANELS: readonly Panel[] = [
  {
    id: "speeds", title: "Speeds", unit: "rad/s",
    series: [
      column("ω1 input", "input_speed", BLUE),
      column("ω2 link 2", "omega2", GREEN),
      column("output", "omega_out", PURPLE),
    ],
  },
  {
    id: "torques", title: "Torques", unit: "N·m",
    series: [
      column("M1 input", "input_torque", BLUE),
      column("M2 mesh", "mesh_torque", GREEN),
      column("Tc output freewheel", "output_torque", PURPLE),
      column("Th housing freewheel", "housing_torque", GREY),
    ],
  },
  {
    id: "power", title: "Power, mean of a turn", unit: "W",
    series: [
      power("in", "energy_in", BLUE),
      power("out to the load", "energy_out", PURPLE),
      power("stored", "energy_stored", GREEN),
      power("lost", "energy_lost", RED),
    ],
  },
  {
    id: "losses", title: "Losses, mean of a turn", unit: "W",
    series: [
      power("meshes", "energy_lost_mesh", ORANGE),
      power("journals", "energy_lost_journal", BLUE),
      power("freewheels", "energy_lost_freewheel", PURPLE),
      power("viscous friction", "energy_lost_viscous", GREEN),
      power("elastic shaft", "energy_lost_shaft", GREY),
    ],
  },
  {
    id: "forces", title: "Forces", unit: "N",
    series: [
      column("on a satellite's bearing", "satellite_force", RED),
      magnitude("on the mount", "shaking_force", GREY),
    ],
  },
];
