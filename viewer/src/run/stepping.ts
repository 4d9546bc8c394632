// A run step by step: a module, its inputs over time, and its recorded columns.

import { Instance } from "../kernel/instance";
import { type Input, type Signal, inputAt } from "./signals";

export interface Plan {
  parameters: Readonly<Record<string, number>>;
  inputs: Readonly<Record<string, Input>>;
  /** Communication step, s, and how many of them. */
  step: number;
  steps: number;
  outputs: readonly string[];
}

/** A run that has started and can continue step by step. */
export class Stepping {
  readonly time: Float64Array;
  readonly columns: Record<string, Float64Array> = {};
  readonly warnings: string[];
  done = 0;
  private readonly instance = new Instance();
  private readonly targets: [number, Float64Array][];
  private readonly signals: [string, Signal][] = [];

  /** @throws Rejected if the module rejects the parameters. */
  constructor(private readonly plan: Plan) {
    this.time = new Float64Array(plan.steps + 1);
    this.targets = plan.outputs.map((name) => {
      const column = new Float64Array(plan.steps + 1);
      this.columns[name] = column;
      return [this.instance.place(name), column];
    });
    try {
      this.instance.set(plan.parameters);
      for (const [name, input] of Object.entries(plan.inputs)) {
        if (typeof input === "number") this.instance.set({ [name]: input });
        else this.signals.push([name, input]);
      }
      this.setSignals();
      this.instance.start();
    } catch (error) {
      this.instance.release();
      throw error;
    }
    this.warnings = this.instance.warnings();
    this.keep();
  }

  get complete(): boolean {
    return this.done >= this.plan.steps;
  }

  /** Take one communication step.
   *  @throws Rejected if the module rejects the step. */
  advance(): void {
    this.setSignals();
    this.instance.advance(this.plan.step);
    this.done += 1;
    this.keep();
  }

  release(): void {
    this.instance.release();
  }

  private setSignals(): void {
    const time = this.done * this.plan.step;
    for (const [name, signal] of this.signals) {
      const { value, rate } = inputAt(signal, time);
      this.instance.set({ [name]: value });
      this.instance.setRate(name, rate);
    }
  }

  private keep(): void {
    const numbers = this.instance.numbers();
    this.time[this.done] = this.done * this.plan.step;
    for (const [place, column] of this.targets) column[this.done] = numbers[place] ?? NaN;
  }
}
