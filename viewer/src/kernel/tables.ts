// The tables of the module in the viewer. The package writes them from its own tables.

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
  /** Allowed values, as after "must be" in an error message. */
  allowed: string;
  /** Items of an enumeration or a Boolean, else none. */
  items: Item[];
  /** Place in its record, in doubles; for an input also the places of its rate and of the flag that the rate is set. */
  place: number;
  ratePlace: number;
  rateGivenPlace: number;
}

export interface Item {
  name: string;
  number: number;
  description: string;
}

/** Messages by status of the kernel; {name} is a placeholder for a value, {step} for the step. */
export type Messages = Record<string, string>;

export interface Tables {
  /** Name of the kernel's entry. */
  symbol: string;
  /** Doubles in the records p, d, u, x, y and w. */
  sizes: number[];
  operations: Record<"START" | "STEP" | "WARN", number>;
  ok: number;
  variables: Variable[];
  messages: Messages;
  warnings: Messages;
  /** Factor from each unit of the same kind, by the unit of the table. */
  units: Record<string, Record<string, number>>;
}

/** Content of a script element of the document. */
export function embedded(id: string): string {
  const text = document.getElementById(id)?.textContent;
  if (!text) throw new Error(`internal error: missing element '${id}'`);
  return text;
}

export const tables = JSON.parse(embedded("tables")) as Tables;
export const variables: readonly Variable[] = tables.variables;
export const byName: ReadonlyMap<string, Variable> = new Map(variables.map((v) => [v.name, v]));
