// One variable: its name, a field for any number with its unit, and a slider.

import type { Variable } from "../run/run";
import { element } from "../common/dom";
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

/** A number with a slider, both in the unit of the reader. */
function numberField(variable: Variable, change: (value: number) => void): Field {
  const id = `set-${variable.name}`;
  const { text: unit, factor } = readUnit(variable.unit);
  const { powers, ...reach } = reachOf(variable);
  const [from, to] = [reach.from * factor, reach.to * factor];
  const whole = variable.kind === "Integer";
  const number = element("input", {
    id, name: variable.name, type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false",
    "aria-description": variable.description,
  });
  const slider = element("input", {
    type: "range", min: "0", max: String(whole ? to - from : STEPS), step: "1",
    "aria-label": `${labelOf(variable.name, variable.description)}${unit ? `, ${unit}` : ""}`,
  });
  const atPart = (part: number): number => {
    if (whole) return from + part;
    // a digit more than the steps of the slider need, so that none leads back to where it began
    const value = powers ? from * (to / from) ** (part / STEPS) : from + ((to - from) * part) / STEPS;
    return Number(value.toPrecision(4));
  };
  const partOf = (value: number): number => {
    if (whole) return value - from;
    return STEPS * (powers ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from));
  };
  const show = (si: number): void => {
    const value = si * factor;
    number.value = String(Number(value.toPrecision(7)));
    slider.value = String(partOf(value));
    slider.setAttribute("aria-valuetext", `${number.value} ${unit}`);
  };
  slider.addEventListener("input", () => {
    const value = atPart(Number(slider.value));
    number.value = String(value);
    slider.setAttribute("aria-valuetext", `${number.value} ${unit}`);
    change(value / factor);
  });
  number.addEventListener("change", () => {
    const value = Number(number.value.trim().replace(",", ".").replace("−", "-"));
    // text that is not a number goes to the kernel as NaN, which rejects it with its message
    slider.value = String(partOf(value));
    change(number.value.trim() === "" ? NaN : value / factor);
  });
  const root = element("div", { class: "field", title: variable.description },
    element("label", { for: id }, labelOf(variable.name, variable.description)),
    element("span", { class: "number" }, number, element("span", { class: "unit" }, unit)), slider);
  return { root, show };
}

/** The field of a variable. */
export function fieldOf(variable: Variable, change: (value: number) => void): Field {
  return variable.items.length > 0 ? listField(variable, change) : numberField(variable, change);
}
