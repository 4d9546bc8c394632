// Signals of the curves.

import { CURVES } from "../common/colours";
import { variables, type Run } from "../run/run";
import { isCoarse } from "../run/sample";

/** How a coarsely sampled run shows a pulsating signal: step mean, step maximum, or instantaneous values as dots. */
const INSTEAD = { mean: "mean", peak: "maximum", dots: "instantaneous" } as const;

export interface Series {
  readonly label: string;
  readonly colour: string;
  readonly coarse?: keyof typeof INSTEAD;
  readonly of: (run: Run) => Float64Array;
}

export interface Panel {
  readonly id: string;
  readonly title: string;
  readonly unit: string;
  readonly series: readonly Series[];
}

/** Label of a series in the legend. */
export function labelOf({ label, coarse }: Series, run: Run): string {
  return coarse && isCoarse(run) ? `${label}, ${INSTEAD[coarse]}` : label;
}

function column(label: string, name: string, colour: string, coarse?: Series["coarse"]): Series {
  const instead = coarse === "mean" || coarse === "peak" ? `${name}_${coarse}` : name;
  return {
    label, colour, ...(coarse && { coarse }),
    of: (run) => run.columns[isCoarse(run) ? instead : name] ?? new Float64Array(run.time.length),
  };
}

/** Length of a vector of three columns. */
function magnitude(label: string, name: string, colour: string): Series {
  return {
    label, colour, coarse: "dots",
    of: (run) => {
      const [x, y, z] = ["x", "y", "z"].map((axis) => run.columns[`${name}_${axis}`] ?? new Float64Array(run.time.length));
      return run.time.map((_, n) => Math.hypot(x?.[n] ?? 0, y?.[n] ?? 0, z?.[n] ?? 0));
    },
  };
}

/** Number of points over which a power is averaged: an eighth of the run, at most 1 s, as in the figures of scenes. */
function pointsOfMean(run: Run): number {
  const points = run.time.length - 1;
  const length = run.time.at(-1) ?? 0;
  return Math.max(1, Math.round(points * Math.min(1 / 8, length > 0 ? 1 / length : 1)));
}

/** Rate of an energy, its running mean: a power. The mean is taken twice, so that pulses do not beat with its length. */
function power(label: string, name: string, colour: string): Series {
  return {
    label, colour,
    of: (run) => {
      const energy = run.columns[name] ?? new Float64Array(run.time.length);
      const half = Math.ceil(pointsOfMean(run) / 4);
      return runningMean(rate(run.time, energy, half), half);
    },
  };
}

/** Slope of values over up to n points on both sides. */
function rate(time: Float64Array, values: Float64Array, half: number): Float64Array {
  const last = time.length - 1;
  return values.map((_, n) => {
    const [from, to] = [Math.max(0, n - half), Math.min(last, n + half)];
    const span = (time[to] ?? 0) - (time[from] ?? 0);
    return span > 0 ? ((values[to] ?? 0) - (values[from] ?? 0)) / span : 0;
  });
}

/** Mean over up to n values on both sides. */
function runningMean(values: Float64Array, half: number): Float64Array {
  const sums = new Float64Array(values.length + 1);
  values.forEach((value, n) => { sums[n + 1] = (sums[n] ?? 0) + value; });
  return values.map((_, n) => {
    const [from, to] = [Math.max(0, n - half), Math.min(values.length, n + half + 1)];
    return ((sums[to] ?? 0) - (sums[from] ?? 0)) / (to - from);
  });
}

/** Prefix of the variables of the loss breakdown. */
const LOSS_PREFIX = "energy_lost_";
const LOSSES = variables.map(({ name }) => name).filter((name) => name.startsWith(LOSS_PREFIX));
const COLOURS = Object.values(CURVES);

export const PANELS: readonly Panel[] = [
  {
    id: "speeds", title: "Speeds", unit: "rad/s",
    series: [
      column("ω1 input", "input_speed", CURVES.blue),
      column("ω2 link 2", "omega2", CURVES.green, "dots"),
      column("ω3 output", "omega_out", CURVES.purple),
    ],
  },
  {
    id: "torques", title: "Torques", unit: "N·m",
    series: [
      column("M1 input", "input_torque", CURVES.blue, "mean"),
      column("M2 mesh", "mesh_torque", CURVES.green, "mean"),
      column("Tc output freewheel", "output_torque", CURVES.purple, "mean"),
      column("Th housing freewheel", "housing_torque", CURVES.grey, "mean"),
    ],
  },
  {
    id: "power", title: "Power, running mean", unit: "W",
    series: [
      power("input", "energy_in", CURVES.blue),
      power("output", "energy_out", CURVES.purple),
      power("stored", "energy_stored", CURVES.green),
      power("losses", "energy_lost", CURVES.red),
    ],
  },
  {
    id: "losses", title: "Losses, running mean", unit: "W",
    series: LOSSES.map((name, n) => power(name.slice(LOSS_PREFIX.length), name, COLOURS[n % COLOURS.length] ?? CURVES.grey)),
  },
  {
    id: "forces", title: "Forces", unit: "N",
    series: [
      column("satellite bearing", "satellite_force", CURVES.red, "peak"),
      magnitude("mounting", "shaking_force", CURVES.grey),
    ],
  },
];
