// The displayed run, simulated here in slices or recorded elsewhere.

import { withAngles } from "./angles";
import { Rejected } from "../kernel/instance";
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
  /** Message of the error that ended it early. */
  error: string | null;
  /** Warnings about a geometrically infeasible mechanism, one message each. */
  warnings: string[];
}

export interface Request {
  parameters: Record<string, number>;
  inputs: Record<string, Input>;
  /** Communication step and duration, s. */
  step: number;
  duration: number;
}

/** Maximum time of a slice of the simulation, ms. */
const SLICE = 6;
const shown = variables.filter((v) => v.causality === "output" || v.causality === "local").map((v) => v.name);

/** Simulate in slices and report the run after each one; the last report is complete or has an error. */
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
    let message: string | null = null;
    let run: Run = { ...empty, parameters };
    try {
      stepping ??= new Stepping(plan);
      while (!stepping.complete && performance.now() - began < SLICE) stepping.advance();
    } catch (error) {
      if (!(error instanceof Rejected)) throw error;
      message = error.message;
    }
    if (stepping) run = soFar(stepping, parameters, message);
    else run.error = message;
    if (run.complete || message !== null) finish();
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
  error: null,
  warnings: [],
};

/** The run so far. */
function soFar(stepping: Stepping, parameters: Record<string, number>, error: string | null): Run {
  const length = stepping.done + 1;
  const columns = Object.fromEntries(
    Object.entries(stepping.columns).map(([name, column]) => [name, column.subarray(0, length)]),
  );
  const time = stepping.time.subarray(0, length);
  const { complete, warnings } = stepping;
  return { time, columns: withAngles(columns), parameters, complete, error, warnings };
}

/** Integrate at once: arrays of the outputs, the start and then every step. For tests and tinkerers.
 *  @throws Rejected with the message of the kernel. */
export function simulate(plan: Plan): Record<string, Float64Array> {
  const stepping = new Stepping(plan);
  try {
    while (!stepping.complete) stepping.advance();
  } finally {
    stepping.release();
  }
  return { time: stepping.time, ...stepping.columns };
}
