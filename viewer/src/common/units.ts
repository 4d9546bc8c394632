// Numbers and units as they are read.

const SUPERSCRIPTS: readonly (readonly [RegExp, string])[] = [[/\./g, "·"], [/2\b/g, "²"]];

/** A unit of the table as it is printed: "kg.m2" is kg·m². */
export function unitText(unit: string): string {
  if (unit === "1") return "";
  return SUPERSCRIPTS.reduce((text, [from, to]) => text.replace(from, to), unit);
}

/** Units of rotational speed that the page offers. */
export const SPEED_UNITS = ["rad/s", "rpm"] as const;
export type SpeedUnit = (typeof SPEED_UNITS)[number];

let speedUnit: SpeedUnit = "rad/s";

/** Set the unit of rotational speeds in the whole page; return true if it changes. */
export function setSpeedUnit(unit: SpeedUnit): boolean {
  const changes = unit !== speedUnit;
  speedUnit = unit;
  return changes;
}

/** Displayed unit of a quantity, and its conversion factor from the table: angles in degrees, speeds as selected. */
export function readUnit(unit: string): { text: string; factor: number } {
  if (unit === "rad") return { text: "deg", factor: 180 / Math.PI };
  if (unit === "rad/s" && speedUnit === "rpm") return { text: "rpm", factor: 30 / Math.PI };
  return { text: unitText(unit), factor: 1 };
}

/** A number in four digits, with a true minus. */
export function numberText(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6)
    ? value.toExponential(digits - 2)
    : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}

/** A number with a fixed number of decimals, so that the text does not move. */
export function steadyText(value: number, largest: number): string {
  if (!Number.isFinite(value)) return "–";
  if (largest < 1e-9) return "0";
  const decimals = Math.min(Math.max(3 - Math.floor(Math.log10(Math.max(largest, 1e-9))), 0), 6);
  return value.toFixed(decimals).replace("-", "−");
}

/** A name of the table in words: "imbalance_mass" is imbalance mass. */
export function spoken(name: string): string {
  return name.replaceAll("_", " ");
}

const GREEK: readonly (readonly [RegExp, string])[] = [[/omega/g, "ω"], [/epsilon/g, "ε"], [/gamma/g, "γ"], [/ out\b/g, "3"]];

/** Label of a field: its name; for a symbol also its description from the table. */
export function labelOf(name: string, description: string): string {
  const text = GREEK.reduce((so, [from, to]) => so.replace(from, to), spoken(name));
  if (text.replace(/\d|start/g, "").trim().length > 2) return text;
  return `${text}, ${description.replace(/[,(].*/, "").trim()}`;
}
