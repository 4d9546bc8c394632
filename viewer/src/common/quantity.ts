// Numbers with a unit, as scene files accept them.

import { tables } from "../kernel/tables";

const NUMBER = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*)$/i;

/** Number of units in a message. */
const EXAMPLES = 5;

/** A unit without differences in writing: "N·m" and "N.m" are equal, also "kg m²" and "kg.m2". */
function plainUnit(text: string): string {
  return text.trim().replace(/[·*\s]+/g, ".").replaceAll("²", "2").replaceAll("⁻¹", "-1");
}

/** Convert a text such as "3000 rpm" to the unit of the table.
 *  @param factor of the displayed unit, which counts without a unit in the text: displayed number / number of the table
 *  @throws Error with the reason */
export function parseQuantity(text: string, unit: string, factor: number): number {
  const match = NUMBER.exec(text.trim().replace("−", "-").replace(/^([-+]?\d*),(\d+)/, "$1.$2"));
  if (!match) throw new Error("not a number with a unit");
  const [, digits = "", own = ""] = match;
  if (own === "") return Number(digits) / factor;
  const units = tables.units[unit] ?? {};
  const found = Object.entries(units).find(([name]) => plainUnit(name) === plainUnit(own));
  if (!found) {
    const names = Object.keys(units).slice(0, EXAMPLES).join(", ");
    throw new Error(names === "" ? `unknown unit '${own}'; the variable has no unit` : `unknown unit '${own}'; examples: ${names}`);
  }
  return Number(digits) * found[1];
}
