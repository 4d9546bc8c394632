// Settings, in groups.

import { variables, type Variable } from "../run/run";
import { element } from "../common/dom";
import { fieldOf, type Field } from "./field";
import { GROUPS, type Group } from "./groups";

/** Length and step of the run stand with the variables of the table. */
const TIMES: readonly Variable[] = [
  ["duration", "duration of the run"], ["step", "communication step: time between points of the run"],
].map(([name = "", description = ""]) => ({
  name, group: "Run", description, kind: "Real", causality: "input", tunable: false, unit: "s",
  start: name === "step" ? 0.0005 : 1, min: 0, max: null, nominal: null, allowed: "", items: [], place: -1, ratePlace: -1, rateGivenPlace: -1,
}));

const RUN: Group = { title: "Run", names: ["duration", "step"] };

/** The fields of all variables. */
export class Sliders {
  readonly root = element("div", { class: "sliders" });
  private readonly fields = new Map<string, Field>();
  private readonly groups: { details: HTMLElement; counts: (value: (name: string) => number) => boolean }[] = [];

  constructor(change: (name: string, value: number) => void) {
    const all = new Map([...variables, ...TIMES].map((v) => [v.name, v]));
    for (const group of [...GROUPS, RUN]) {
      const details = element("details", {}, element("summary", {}, group.title));
      details.open = group.open ?? false;
      for (const name of group.names) {
        const variable = all.get(name);
        if (!variable) throw new Error(`there is no variable ${name} for the group ${group.title}`);
        const field = fieldOf(variable, (value) => { change(name, value); });
        this.fields.set(name, field);
        details.append(field.root);
      }
      this.root.append(details);
      this.groups.push({ details, counts: group.counts ?? (() => true) });
    }
  }

  /** Mark the fields of a part. */
  relate(names: readonly string[]): void {
    for (const [name, field] of this.fields) field.root.classList.toggle("related", names.includes(name));
  }

  /** Show the current values, mark changed ones, hide settings without effect. */
  show(value: (name: string) => number, changed: (name: string) => boolean): void {
    for (const [name, field] of this.fields) {
      field.show(value(name));
      field.root.classList.toggle("changed", changed(name));
    }
    for (const { details, counts } of this.groups) details.hidden = !counts(value);
    const byTorque = value("drive") === 1;
    this.fields.get("drive_torque")?.root.toggleAttribute("hidden", !byTorque);
    this.fields.get("kinematic_ratio")?.root.toggleAttribute("hidden", value("fidelity") !== 0);
  }
}
