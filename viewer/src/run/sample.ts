// Values of a run between its points.

import type { Run } from "./run";

/** Index of the last point that is not after a time, at least 0. */
export function indexAt(time: Float64Array, at: number): number {
  let low = 0;
  let high = time.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((time[middle] ?? Infinity) <= at) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Length of a run as far as it has come, s. */
export function lengthOf(run: Run): number {
  return run.time.at(-1) ?? 0;
}

/** Value of a column at a time: straight between points; NaN where there is no such column. */
export function valueAt(run: Run, name: string, at: number): number {
  const column = run.columns[name];
  if (!column || run.time.length === 0) return NaN;
  const index = indexAt(run.time, at);
  const first = column[index] ?? NaN;
  const last = column[index + 1];
  const from = run.time[index] ?? 0;
  const to = run.time[index + 1];
  if (last === undefined || to === undefined || to <= from) return first;
  return first + ((last - first) * Math.min(Math.max(at - from, 0), to - from)) / (to - from);
}

/** Value of a column at the point nearest to a time: of modes, which have nothing between. */
export function nearest(run: Run, name: string, at: number): number {
  const index = indexAt(run.time, at);
  const from = run.time[index] ?? 0;
  const to = run.time[index + 1] ?? Infinity;
  return run.columns[name]?.[at - from > to - at ? index + 1 : index] ?? NaN;
}

/** Minimum number of points per pinion-shaft revolution for a line between torques. */
const FEWEST = 8;
const AVERAGED = 1;
const coarse = new WeakMap<Float64Array, boolean>();

/** Return true if the points of a run are too far apart to draw pulsating signals as curves. */
export function isCoarse(run: Run): boolean {
  const { q } = run.columns;
  if (!q || run.parameters.fidelity === AVERAGED) return false;
  const known = coarse.get(q);
  if (known !== undefined) return known;
  const farthest = q.reduce((most, angle, n) => Math.max(most, Math.abs(angle - (q[n - 1] ?? angle))), 0);
  coarse.set(q, farthest > (2 * Math.PI) / FEWEST);
  return farthest > (2 * Math.PI) / FEWEST;
}

/** The column to show for one: of a coarse run its mean over each step, where there is one. */
export function shownName(run: Run, name: string): string {
  const mean = `${name}_mean`;
  return mean in run.columns && isCoarse(run) ? mean : name;
}

const found = new WeakMap<Float64Array, number>();

/** Largest magnitude in some columns, 0 without them. */
export function largest(run: Run, names: readonly string[]): number {
  return names.reduce((most, name) => Math.max(most, largestOf(run.columns[name] ?? new Float64Array())), 0);
}

function largestOf(column: Float64Array): number {
  const known = found.get(column);
  if (known !== undefined) return known;
  const most = column.reduce((so, value) => Math.max(so, Math.abs(value)), 0);
  found.set(column, most);
  return most;
}
