// A run that was recorded elsewhere.

import { unpacked } from "../kernel/packed";
import type { Run } from "./run";
import { withAngles } from "./angles";

/** A run as the package packs it: columns of single precision one after another. */
export interface Recorded {
  names: string[];
  /** Units of the columns that have one. */
  units: Record<string, string>;
  /** Time between rows, s. */
  step: number;
  rows: number;
  /** Every n-th row of the run is recorded. */
  every: number;
  numbers: string;
  warnings: string[];
}

export async function playable(recorded: Recorded, parameters: Record<string, number>): Promise<Run> {
  const { names, rows, step, warnings } = recorded;
  const numbers = new Float32Array(await unpacked(recorded.numbers));
  const columns = Object.fromEntries(
    names.map((name, n) => [name, Float64Array.from(numbers.subarray(n * rows, (n + 1) * rows))]),
  );
  const time = Float64Array.from({ length: rows }, (_, n) => n * step);
  return { time, columns: withAngles(columns), parameters, complete: true, error: null, warnings };
}
