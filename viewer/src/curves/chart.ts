// The converter chart: periodic steady state of the rigid module; a large inertia keeps its output shaft at a speed ratio.

import { geometry, period } from "../machine/geometry";
import { simulate, type Run } from "../run/run";
import { lengthOf, valueAt } from "../run/sample";

/** Means of steady pulses at one speed ratio, N.m. */
export interface ChartPoint {
  readonly ratio: number;
  readonly input: number;
  readonly output: number;
  /** Output power over input power, %, from the losses because the stored energy oscillates. */
  readonly efficiency: number;
}

const STEPS_A_TURN = 32;
/** Maximum number of pinion-shaft revolutions of a point. */
const MOST_TURNS = 40;
/** Inertia that no pulse moves, kg.m2. */
const HELD = 1e5;

/**
 * One point of the chart: means over whole periods of the pinion shaft, after one transient period.
 *
 * @param ratio below 1, where link 2 turns with link 1
 * @throws Rejected with the message of the kernel.
 */
export function chartPoint(parameters: Readonly<Record<string, number>>, speed: number, ratio: number): ChartPoint {
  const shape = geometry(parameters);
  const span = 2 * Math.PI * Math.min(Math.max(period(shape) / (2 * Math.PI), 10), MOST_TURNS);
  // the pinion shaft turns at least as fast as with link 2 at the output speed
  const slowest = shape.k * Math.abs(speed) * (1 - ratio);
  const step = (2 * Math.PI) / slowest / STEPS_A_TURN;
  const held = {
    ...parameters, fidelity: 2, drive: 0, input_hold: 0, tolerance: Math.max(parameters.tolerance ?? 0, 1e-7),
    output_inertia: HELD, omega_out_start: ratio * speed, omega2_start: 0, max_step: 0,
  };
  const found = simulate({
    parameters: held, inputs: { omega1: speed, load_torque: 0, drive_torque: 0 },
    step, steps: Math.ceil((2.2 * span) / slowest / step),
    outputs: ["energy_in", "energy_lost", "output_torque_mean", "drive_angle", "drive_turns"],
  });
  const column = (name: string): Float64Array => found[name] ?? new Float64Array();
  const q = column("drive_angle").map((angle, n) => angle + 2 * Math.PI * (column("drive_turns")[n] ?? NaN));
  const from = q.findIndex((angle) => Math.abs(angle - (q[0] ?? 0)) >= span);
  const turned = Math.abs((q.at(-1) ?? NaN) - (q[from] ?? NaN));
  const target = (q[from] ?? NaN) + Math.sign((q.at(-1) ?? NaN) - (q[from] ?? NaN)) * span * Math.floor(turned / span);
  const torqueTime = runningSum(column("output_torque_mean"), step);
  const gain = (values: Float64Array): number => valueWhere(q, target, values) - (values[from] ?? NaN);
  const time = gain(column("time"));
  const output = gain(torqueTime) / time;
  const input = gain(column("energy_in"));
  return {
    ratio, output,
    input: input / time / speed,
    efficiency: output * ratio > 0 && input > 0 ? 100 * (1 - gain(column("energy_lost")) / input) : 0,
  };
}

/** Integral over time of a step mean, N.m.s. */
function runningSum(means: Float64Array, step: number): Float64Array {
  let sum = 0;
  return means.map((mean, n) => (sum += n === 0 ? 0 : mean * step));
}

/** Value of a column where an angle, which only grows or only falls, reaches a target. */
function valueWhere(angles: Float64Array, target: number, values: Float64Array): number {
  const falling = (angles.at(-1) ?? 0) < (angles[0] ?? 0);
  const after = angles.findIndex((angle) => (falling ? angle <= target : angle >= target));
  if (after < 1) return NaN;
  const [from = NaN, to = NaN] = [angles[after - 1], angles[after]];
  const [first = NaN, last = NaN] = [values[after - 1], values[after]];
  return first + ((last - first) * (target - from)) / (to - from);
}

/** Ratios of the chart, from stall to just below lock-up. */
export function chartRatios(): number[] {
  return Array.from({ length: 25 }, (_, n) => n / 25);
}

/** Where a run is in the chart at a time: means over about three turns of link 1 before it. */
export function operatingPoint(run: Run, time: number): { ratio: number; torque: number } {
  const speed = valueAt(run, "input_speed", time);
  const span = Math.min((6 * Math.PI) / Math.max(Math.abs(speed), 1e-9), lengthOf(run));
  const [from, to] = time < span ? [0, span] : [time - span, time];
  const torques = run.columns.output_torque_mean ?? new Float64Array();
  let sum = 0;
  let count = 0;
  run.time.forEach((at, n) => {
    if (at <= from || at > to) return;
    sum += torques[n] ?? 0;
    count++;
  });
  return { ratio: valueAt(run, "omega_out", time) / speed, torque: count > 0 ? sum / count : NaN };
}
