// Switches of the freewheels and pulses in a run.

import { geometry } from "../machine/geometry";
import type { Run } from "../run/run";
import { indexAt, lengthOf } from "../run/sample";

/** Contact modes of the table: locked, free, driving, locked and driving. */
export function holding(mode: number): { housing: boolean; output: boolean } {
  return { housing: mode === 0 || mode === 3, output: mode === 2 || mode === 3 };
}

/** The run with the take-up angle remaining of each freewheel as columns, 0 to 1 of its engagement angle. It follows the angle
 *  by which a freewheel overruns from point to point, and is 0 while it is locked. */
export function plays(run: Run): Run {
  const at = (name: string, n: number): number => run.columns[name]?.[n] ?? 0;
  const { k } = geometry(run.parameters);
  const link2 = (n: number): number => at("theta1", n) - at("q", n) / k;
  const hub = (n: number): number => at("theta_out", n) + at("shaft_twist", n);
  const playOf = (which: "housing" | "output", overrun: (n: number) => number): Float64Array => {
    const angle = run.parameters[`${which}_engagement_angle`] ?? 0;
    const play = new Float64Array(run.time.length);
    for (let n = 1; angle > 0 && n < play.length; n++) {
      const now = (play[n - 1] ?? 0) + (overrun(n) - overrun(n - 1)) / angle;
      play[n] = holding(at("contact_mode", n))[which] ? 0 : Math.min(Math.max(now, 0), 1);
    }
    return play;
  };
  return { ...run, columns: { housing: playOf("housing", link2), output: playOf("output", (n) => hub(n) - link2(n)) } };
}

/** Times at which a freewheel locks or releases, s: the first points after it. */
export function switches(run: Run): number[] {
  const modes = run.columns.contact_mode ?? new Float64Array();
  return Array.from(run.time).filter((_, n) => n > 0 && modes[n] !== modes[n - 1]);
}

/** The next switch after a time, or the last one before it; null where there is none. */
export function nextSwitch(run: Run, at: number, forwards: boolean): number | null {
  const margin = 1e-9 * (1 + lengthOf(run));
  const found = switches(run);
  const next = forwards ? found.find((time) => time > at + margin) : found.findLast((time) => time < at - margin);
  return next ?? null;
}

/** The middle of the next interval in which a freewheel is locked, s; the time itself where there is none. */
export function nextLocked(run: Run, which: "housing" | "output", at: number): number {
  const modes = run.columns.contact_mode ?? new Float64Array();
  const isLocked = (n: number): boolean => holding(modes[n] ?? NaN)[which];
  let from = indexAt(run.time, at);
  while (from < run.time.length && !isLocked(from)) from++;
  let to = from;
  while (to < run.time.length && isLocked(to)) to++;
  return run.time[Math.floor((from + to - 1) / 2)] ?? at;
}

/** Start and end of the pulse around a time: from one engagement of the output freewheel to the next, else one revolution of the pinion shaft. */
export function pulseAround(run: Run, at: number): [number, number] {
  const modes = run.columns.contact_mode ?? new Float64Array();
  const begins = Array.from(run.time).filter(
    (_, n) => n > 0 && holding(modes[n] ?? 0).output && !holding(modes[n - 1] ?? 0).output);
  const from = begins.findLast((time) => time <= at);
  const to = begins.find((time) => time > at);
  if (from !== undefined && to !== undefined) return [from, to];
  return turnAround(run, at);
}

/** Start and end of the pinion-shaft revolution around a time, within the run. */
function turnAround(run: Run, at: number): [number, number] {
  const angles = run.columns.q ?? new Float64Array();
  const now = indexAt(run.time, at);
  const turn = (n: number): number => Math.floor((angles[n] ?? 0) / (2 * Math.PI));
  let from = now;
  while (from > 0 && turn(from - 1) === turn(now)) from--;
  let to = now;
  while (to < run.time.length - 1 && turn(to) === turn(now)) to++;
  return [run.time[from] ?? 0, run.time[to] ?? 0];
}
