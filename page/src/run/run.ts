// What the page shows: a run, integrated here in slices or recorded elsewhere.

import { withAngles } from "./angles";
import { Refused } from "../kernel/instance";
import { variables } from "../kernel/tables";
import type { Input } from "./signals";
import { type Plan, Stepping } from "./stepping";

export { ready } from "../kernel/memory";
export { type Variable, variables } from "../kernel/tables";
export type { Input, Signal } from "./signals";

/** A run as far as it has come: all columns have the length of time. */
export interface Run {
  /** s */
  time: Float64Array;
  /** By the names of the outputs and locals of the module, in their units; and angles (see withAngles). */
  columns: Record<string, Float64Array>;
  parameters: Record<string, number>;
  complete: boolean;
  /** Why it has ended early, in a sentence. */
  refusal: string | null;
  /** What could not be built of the mechanism, a sentence each. */
  warnings: string[];
}

export interface Request {
  parameters: Record<string, number>;
  inputs: Record<string, Input>;
  /** Communication step and duration, s. */
  step: number;
  duration: number;
}

/** Longest time in a row that an integration takes from the page, ms. */
const SLICE = 6;
const shown = variables.filter((v) => v.causality === "output" || v.causality === "local").map((v) => v.name);

/** Integrate and tell, after every slice, how far it has come; the last call has it complete or refused. */
export function integrate(request: Request, onProgress: (run: Run) => void): { cancel: () => void } {
  const { parameters, inputs, step, duration } = request;
  const plan: Plan = { parameters, inputs, step, steps: Math.round(duration / step), outputs: shown };
  const channel = new MessageChannel();
  let stepping: Stepping | undefined;
  const finish = () => {
    channel.port1.close();
    stepping?.release();
    stepping = undefined;
  };
  channel.port1.onmessage = () => {
    const began = performance.now();
    let refusal: string | null = null;
    let run: Run = { ...empty, parameters };
    try {
      stepping ??= new Stepping(plan);
      while (!stepping.complete && performance.now() - began < SLICE) stepping.advance();
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      refusal = error.message;
    }
    if (stepping) run = soFar(stepping, parameters, refusal);
    else run.refusal = refusal;
    if (run.complete || refusal !== null) finish();
    else channel.port2.postMessage(null);
    onProgress(run);
  };
  channel.port2.postMessage(null);
  return { cancel: finish };
}

const empty: Run = {
  time: new Float64Array(),
  columns: {},
  parameters: {},
  complete: false,
  refusal: null,
  warnings: [],
};

/** What a run has put into its columns until now. */
function soFar(stepping: Stepping, parameters: Record<string, number>, refusal: string | null): Run {
  const length = stepping.done + 1;
  const columns = Object.fromEntries(
    Object.entries(stepping.columns).map(([name, column]) => [name, column.subarray(0, length)]),
  );
  const time = stepping.time.subarray(0, length);
  const { complete, warnings } = stepping;
  return { time, columns: withAngles(columns), parameters, complete, refusal, warnings };
}

/** Integrate at once: arrays of the outputs, the start and then every step. For tests and tinkerers.
 *  @throws Refused with the sentence of the kernel. */
export function simulate(plan: Plan): Record<string, Float64Array> {
  const stepping = new Stepping(plan);
  try {
    while (!stepping.complete) stepping.advance();
  } finally {
    stepping.release();
  }
  return { time: stepping.time, ...stepping.columns };
}
