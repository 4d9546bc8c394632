// One variable: its name, a field for any number with a unit, and a slider.

import type { Variable } from "../run/run";
import { element } from "../common/dom";
import { parseQuantity } from "../common/quantity";
import { accepts, mustBe, shown } from "../kernel/messages";
import { reachOf } from "./groups";
import { labelOf, readUnit, spoken } from "../common/units";

const STEPS = 400;

export interface Field {
  readonly root: HTMLElement;
  /** Show a value without notification. */
  show(value: number): void;
}

/** A choice from a list: enumerations and switches. */
function listField(variable: Variable, change: (value: number) => void): Field {
  const id = `set-${variable.name}`;
  const select = element("select", { id, name: variable.name });
  for (const { name, number, description } of variable.items) {
    select.append(element("option", { value: String(number), title: description }, spoken(name)));
  }
  select.addEventListener("change", () => { change(Number(select.value)); });
  const root = element("div", { class: "field", title: variable.description },
    element("label", { for: id }, labelOf(variable.name, variable.description)), select);
  return { root, show: (value) => { select.value = String(value); } };
}

/** Position of a value on the slider, and the reverse, both in the unit of the table. */
function scaleOf(variable: Variable): { last: number; partOf: (si: number) => number; atPart: (part: number, factor: number) => number } {
  const { from, to, powers } = reachOf(variable);
  if (variable.kind === "Integer") return { last: to - from, partOf: (si) => si - from, atPart: (part) => from + part };
  return {
    last: STEPS,
    partOf: (si) => STEPS * (powers ? Math.log(si / from) / Math.log(to / from) : (si - from) / (to - from)),
    // a digit more than the steps of the slider need, so that each step changes the value
    atPart: (part, factor) => {
      const si = powers ? from * (to / from) ** (part / STEPS) : from + ((to - from) * part) / STEPS;
      return Number((si * factor).toPrecision(4)) / factor;
    },
  };
}

/** The reason why the table does not allow a value; empty if it does. */
function reasonAgainst(variable: Variable, si: number): string {
  if (variable.allowed === "" || accepts(variable, si)) return "";
  return mustBe(variable.name, variable.allowed, shown(si));
}

/** A number with a slider, both in the displayed unit. The number accepts other units: "3000 rpm". */
function numberField(variable: Variable, change: (value: number) => void): Field {
  const id = `set-${variable.name}`;
  const label = labelOf(variable.name, variable.description);
  const { last, partOf, atPart } = scaleOf(variable);
  const reason = element("p", { id: `${id}-reason`, class: "reason", role: "alert" });
  const unitCell = element("span", { class: "unit" });
  const number = element("input", {
    id, name: variable.name, type: "text", inputmode: "text", autocomplete: "off", spellcheck: "false",
    "aria-description": variable.description, "aria-errormessage": reason.id,
  });
  const slider = element("input", { type: "range", min: "0", max: String(last), step: "1" });
  let value = NaN;
  let isText = false;
  const mark = (text: string): void => {
    reason.textContent = text;
    number.setAttribute("aria-invalid", String(text !== ""));
  };
  const write = (si: number): void => {
    const { text: unit, factor } = readUnit(variable.unit);
    value = si;
    isText = false;
    number.value = String(Number((si * factor).toPrecision(7)));
    unitCell.textContent = unit;
    slider.value = String(partOf(si));
    slider.setAttribute("aria-label", `${label}${unit ? `, ${unit}` : ""}`);
    slider.setAttribute("aria-valuetext", `${number.value} ${unit}`);
    mark(reasonAgainst(variable, si));
  };
  slider.addEventListener("input", () => {
    const si = atPart(Number(slider.value), readUnit(variable.unit).factor);
    write(si);
    change(si);
  });
  number.addEventListener("change", () => {
    try {
      const si = parseQuantity(number.value, variable.unit, readUnit(variable.unit).factor);
      write(si);
      change(si);
    } catch (error) {
      // the text stays, and the last valid value stays in effect
      isText = true;
      mark(`'${number.value}': ${(error as Error).message}`);
    }
  });
  number.addEventListener("keydown", (event) => { if (event.key === "Escape") write(value); });
  const root = element("div", { class: "field", title: variable.description },
    element("label", { for: id }, label), element("span", { class: "number" }, number, unitCell), reason, slider);
  return { root, show: (si) => { if (!isText || si !== value) write(si); } };
}

/** The field of a variable. */
export function fieldOf(variable: Variable, change: (value: number) => void): Field {
  return variable.items.length > 0 ? listField(variable, change) : numberField(variable, change);
}
