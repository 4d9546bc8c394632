// The tables of the module as the page holds them: written by the package from its own, so there is no second list.

/** A variable of the module: an input, a parameter, an output or a local. */
export interface Variable {
  name: string;
  /** Heading of the group that it stands in. */
  group: string;
  kind: "Real" | "Integer" | "Boolean" | "Enumeration";
  causality: "input" | "output" | "local" | "parameter";
  tunable: boolean;
  /** SI unit, "1" or "" without one. */
  unit: string;
  description: string;
  /** Start value, or null where it is calculated. */
  start: number | null;
  min: number | null;
  max: number | null;
  nominal: number | null;
  /** What follows "must be" in a refusal. */
  allowed: string;
  /** Items of an enumeration or a Boolean, else none. */
  items: Item[];
  /** Place in its record, in doubles; of an input also those of its rate and of whether that is given. */
  place: number;
  ratePlace: number;
  rateGivenPlace: number;
}

export interface Item {
  name: string;
  number: number;
  description: string;
}

/** Sentences by the number that the kernel answers; {name} stands for a value, {step} for the step. */
export type Sentences = Record<string, string>;

export interface Tables {
  /** Name of the kernel's entry. */
  symbol: string;
  /** Doubles in the records p, d, u, x, y and w. */
  sizes: number[];
  operations: Record<"START" | "STEP" | "WARN", number>;
  ok: number;
  variables: Variable[];
  messages: Sentences;
  warnings: Sentences;
}

/** The content of a script element of the page. */
export function embedded(id: string): string {
  const text = document.getElementById(id)?.textContent;
  if (!text) throw new Error(`the page must hold an element ${id}, there is none`);
  return text;
}

export const tables = JSON.parse(embedded("tables")) as Tables;
export const variables: readonly Variable[] = tables.variables;
export const byName: ReadonlyMap<string, Variable> = new Map(variables.map((v) => [v.name, v]));
