// Messages of errors and warnings, identical to those of the FMU.

import { type Variable, tables } from "./tables";

/** Significant digits of a number in a message. */
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

/** Fill a message template with values by name. */
function filled(template: string, valueOf: (name: string) => number): string {
  return template.replace(/\{(\w+)\}/g, (_, name: string) => shown(valueOf(name)));
}

/** The message for a status of the kernel that is not OK. */
export function explained(status: number, valueOf: (name: string) => number): string {
  const message = tables.messages[status];
  if (message === undefined) throw new Error(`internal error: the kernel returned status ${status}`);
  return filled(message, valueOf);
}

/** The messages for a bit sum of warnings of the kernel. */
export function warned(sum: number, valueOf: (name: string) => number): string[] {
  return Object.entries(tables.warnings)
    .filter(([number]) => (sum & Number(number)) !== 0)
    .map(([, message]) => filled(message, valueOf));
}

/** Return true if a variable accepts a value: finite, an integer if required, within its range. */
export function accepts(variable: Variable, value: number): boolean {
  if (!Number.isFinite(value)) return false;
  if (variable.items.length > 0) return variable.items.some((item) => item.number === value);
  if (variable.kind !== "Real" && !Number.isInteger(value)) return false;
  return value >= (variable.min ?? -Infinity) && value <= (variable.max ?? Infinity);
}
