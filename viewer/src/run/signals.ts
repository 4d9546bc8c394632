// Inputs over time: a number, or straight lines between points.

/** Straight lines between points: times (s, not falling) and values; two equal times are a jump. */
export interface Signal {
  times: number[];
  values: number[];
}

export type Input = number | Signal;

/** Value and rate of a signal at a time, just after it; constant before the first and after the last point. */
export function inputAt({ times, values }: Signal, time: number): { value: number; rate: number } {
  const after = times.findIndex((at) => at > time);
  if (after === 0) return { value: values[0] ?? NaN, rate: 0 };
  if (after === -1) return { value: values.at(-1) ?? NaN, rate: 0 };
  const [from = NaN, to = NaN] = [times[after - 1], times[after]];
  const [first = NaN, last = NaN] = [values[after - 1], values[after]];
  const rate = (last - first) / (to - from);
  return { value: first + rate * (time - from), rate };
}
