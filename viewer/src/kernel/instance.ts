// One inertia module: set, start, step, read, as the FMU does.

import { Records } from "./memory";
import { accepts, explained, mustBe, shown, warned } from "./messages";
import { type Variable, byName, tables, variables } from "./tables";

/** Error of the kernel or the table of variables, with its message. */
export class Rejected extends Error {}

/** Place of the record of a variable among p, d, u, x, y and w. */
const RECORD = { parameter: 0, input: 2, output: 4, local: 4 };
const settable = variables.filter((v) => v.causality === "input" || v.causality === "parameter");

export class Instance {
  private readonly records = new Records();
  /** Places of the rates that are set for the next step, and of their flags. */
  private readonly rated: number[] = [];

  /** An instance with the start values of the table. */
  constructor() {
    for (const variable of settable) this.write(variable, variable.start ?? 0);
  }

  /** Set parameters and inputs by name.
   *  @throws Rejected for an unknown name; start and step check the ranges. */
  set(values: Readonly<Record<string, number>>): void {
    for (const [name, value] of Object.entries(values)) {
      const variable = settable.find((found) => found.name === name);
      if (!variable) {
        throw new Rejected(`unknown parameter or input '${name}'; available: ${settable.map((v) => v.name).join(", ")}`);
      }
      this.write(variable, value);
    }
  }

  /** Give an input a constant rate over the coming step, per second. */
  setRate(name: string, rate: number): void {
    const input = found(name);
    const numbers = this.records.view();
    const inputs = this.records.offset(RECORD.input);
    numbers[inputs + input.ratePlace] = rate;
    numbers[inputs + input.rateGivenPlace] = 1;
    this.rated.push(inputs + input.ratePlace, inputs + input.rateGivenPlace);
  }

  /** Check the parameters, alone and together, and take the initial state.
   *  @throws Rejected with one message per bad value. */
  start(): void {
    const bad = settable
      .filter((v) => v.causality === "parameter" && !accepts(v, this.value(v.name)))
      .map((v) => mustBe(v.name, v.allowed, shown(this.value(v.name))));
    if (bad.length > 0) throw new Rejected(bad.join("; "));
    this.call(tables.operations.START, 0);
  }

  /** Advance by a communication step, s.
   *  @throws Rejected for bad inputs or a bad step; the state is as it was. */
  advance(step: number): void {
    this.call(tables.operations.STEP, step);
    if (this.rated.length === 0) return;
    const numbers = this.records.view();
    for (const place of this.rated) numbers[place] = 0;
    this.rated.length = 0;
  }

  /** Warnings about a geometrically infeasible mechanism, one message each. */
  warnings(): string[] {
    return warned(this.records.call(tables.operations.WARN, 0), (name) => this.value(name));
  }

  /** Value of any variable. */
  value(name: string): number {
    return this.records.view()[this.place(name)] ?? NaN;
  }

  /** Where a variable stands in the doubles that numbers gives. */
  place(name: string): number {
    const variable = found(name);
    return this.records.offset(RECORD[variable.causality]) + variable.place;
  }

  /** All doubles of the instance, for reading many of them; not to be kept. */
  numbers(): Float64Array {
    return this.records.view();
  }

  /** End the use of this instance. */
  release(): void {
    this.records.release();
  }

  private call(operation: number, step: number): void {
    const status = this.records.call(operation, step);
    if (status === tables.ok) return;
    throw new Rejected(explained(status, (name) => (name === "step" ? step : this.filling(name))));
  }

  /** Value for a name in a message: a variable, or the rate of an input. */
  private filling(name: string): number {
    if (byName.has(name)) return this.value(name);
    const input = found(name.replace(/_rate$/, ""));
    return this.records.view()[this.records.offset(RECORD.input) + input.ratePlace] ?? NaN;
  }

  private write(variable: Variable, value: number): void {
    this.records.view()[this.place(variable.name)] = value;
  }
}

function found(name: string): Variable {
  const variable = byName.get(name);
  if (!variable) throw new Rejected(`unknown variable '${name}'`);
  return variable;
}
