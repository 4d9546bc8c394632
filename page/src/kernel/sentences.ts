// The sentences of refusals and warnings, letter for letter those of the FMU.

import { type Variable, tables } from "./tables";

/** Significant digits of a number in a sentence. */
const DIGITS = 16;

/** A number as C's "%.16g" writes it. */
export function shown(value: number): string {
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  const [mantissa = "", exponent = "0"] = value.toExponential(DIGITS - 1).split("e");
  const power = Number(exponent);
  if (power >= -4 && power < DIGITS) return signed(value, withoutZeros(value.toFixed(DIGITS - 1 - power)));
  const size = String(Math.abs(power)).padStart(2, "0");
  return `${withoutZeros(mantissa)}e${power < 0 ? "-" : "+"}${size}`;
}

function signed(value: number, text: string): string {
  return Object.is(value, -0) ? `-${text}` : text;
}

function withoutZeros(text: string): string {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** The message for a bad value: "tolerance must be between 0 and 1 (got 7)". */
export function mustBe(name: string, allowed: string, value: string): string {
  return `${name} must be ${allowed} (got ${value})`;
}

/** A sentence of the tables with values in the places of their names. */
function filled(sentence: string, valueOf: (name: string) => number): string {
  return sentence.replace(/\{(\w+)\}/g, (_, name: string) => shown(valueOf(name)));
}

/** The sentence for a status of the kernel, not OK. */
export function explained(status: number, valueOf: (name: string) => number): string {
  const sentence = tables.messages[status];
  if (sentence === undefined) throw new Error(`internal error: the kernel returned status ${status}`);
  return filled(sentence, valueOf);
}

/** The sentences for a sum of warnings of the kernel. */
export function warned(sum: number, valueOf: (name: string) => number): string[] {
  return Object.entries(tables.warnings)
    .filter(([number]) => (sum & Number(number)) !== 0)
    .map(([, sentence]) => filled(sentence, valueOf));
}

/** Whether a variable may have a value: finite, whole where it has to be, within its range. */
export function accepts(variable: Variable, value: number): boolean {
  if (!Number.isFinite(value)) return false;
  if (variable.items.length > 0) return variable.items.some((item) => item.number === value);
  if (variable.kind !== "Real" && !Number.isInteger(value)) return false;
  return value >= (variable.min ?? -Infinity) && value <= (variable.max ?? Infinity);
}
