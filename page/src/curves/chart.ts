// The converter chart: steady pulses of the rigid module, its output shaft held at a speed ratio by a large inertia.

import { simulate, type Run } from "../run/run";
import { lengthOf, valueAt } from "../run/sample";

/** Means of steady pulses at one speed ratio, N.m. */
export interface ChartPoint {
  readonly ratio: number;
  readonly input: number;
  readonly output: number;
  /** Power out over power in, %; of what is not lost where power swings. */
  readonly efficiency: number;
}

const TURNS = 60;
const STEPS_A_TURN = 24;
/** Inertia that no pulse moves, kg.m2. */
const HELD = 1e9;

/**
 * One point of the chart.
 *
 * The speed ratio has to be below 1: above it the freewheel overruns, and link 2 turns with link 1.
 *
 * @throws Refused with the sentence of the kernel.
 */
export function chartPoint(parameters: Readonly<Record<string, number>>, speed: number, ratio: number): ChartPoint {
  const turn = (2 * Math.PI) / Math.abs(speed);
  const held = {
    ...parameters, fidelity: 2, method: 0, drive: 0, input_hold: 0, tolerance: Math.max(parameters.tolerance ?? 0, 1e-7),
    output_inertia: HELD, omega_out_start: ratio * speed, omega2_start: 0, max_step: 0,
  };
  const found = simulate({
    parameters: held, inputs: { omega1: speed, load_torque: 0, drive_torque: 0 },
    step: turn / STEPS_A_TURN, steps: 2 * TURNS * STEPS_A_TURN,
    outputs: ["energy_in", "energy_lost", "output_torque_mean"],
  });
  // the first half lets the pulses settle
  const settled = TURNS * STEPS_A_TURN;
  const gain = (name: string): number => (found[name]?.at(-1) ?? NaN) - (found[name]?.[settled] ?? NaN);
  const torques = found.output_torque_mean?.subarray(settled + 1) ?? new Float64Array();
  const output = torques.reduce((sum, torque) => sum + torque, 0) / torques.length;
  const given = gain("energy_in");
  const useful = output * ratio > 0 && given > 0;
  return {
    ratio, output,
    input: given / (TURNS * turn * speed),
    efficiency: useful ? 100 * (1 - gain("energy_lost") / given) : 0,
  };
}

/** Ratios of the chart, from stall to just below lock-up. */
export function chartRatios(): number[] {
  return [...Array.from({ length: 24 }, (_, n) => n / 25), 0.98];
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
