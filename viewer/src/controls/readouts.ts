// Current values and the energy balance.

import type { Run } from "../run/run";
import { isCoarse, largest, nearest, shownName, valueAt } from "../run/sample";
import { element, setText } from "../common/dom";
import { holding } from "./pulses";
import { numberText, readUnit, steadyText } from "../common/units";

/** The first fidelity that has pulses. */
const RIGID = 2;

interface Row {
  readonly name: string;
  readonly part: string;
  readonly unit: string;
  readonly text: (run: Run, time: number) => string;
}

function signal(name: string, part: string, column: string, unit: string): Row {
  return {
    name, part, unit,
    text: (run, time) => {
      const shown = shownName(run, column);
      const { factor } = readUnit(unit);
      return steadyText(factor * valueAt(run, shown, time), factor * largest(run, [shown]));
    },
  };
}

/** State of a freewheel: locked, overrunning or rotating backward, from the overrunning speed, rad/s. */
function freewheel(name: string, which: "housing" | "output", overrun: (run: Run, time: number) => number): Row {
  return {
    name, part: which, unit: "",
    text: (run, time) => {
      if (holding(nearest(run, "contact_mode", time))[which]) return "locked";
      return overrun(run, time) < -1e-9 ? "rotates backward" : "overruns";
    },
  };
}

/** Engagement frequency of a freewheel over the last second or since the start. */
function engagements(run: Run, which: string, time: number): string {
  if ((run.parameters.fidelity ?? 0) < RIGID) return "–";
  const [name, span] = [`${which}_engagements`, Math.min(time, 1)];
  return steadyText((valueAt(run, name, time) - valueAt(run, name, time - span)) / span, 100);
}

const NOW: readonly Row[] = [
  signal("speed of link 1, ω1", "link1", "input_speed", "rad/s"),
  signal("speed of link 2, ω2", "link2", "omega2", "rad/s"),
  signal("output speed, ω3", "output", "omega_out", "rad/s"),
  {
    name: "speed ratio, ω3/ω1", part: "", unit: "",
    text: (run, time) => steadyText(valueAt(run, "omega_out", time) / valueAt(run, "input_speed", time), 1),
  },
  signal("input torque, M1", "link1", "input_torque", "N·m"),
  signal("mesh torque, M2", "link2", "mesh_torque", "N·m"),
  signal("output torque, Tc", "output", "output_torque", "N·m"),
  freewheel("housing freewheel", "housing", (run, time) => valueAt(run, "omega2", time)),
  freewheel("output freewheel", "output", (run, time) => valueAt(run, "omega_hub", time) - valueAt(run, "omega2", time)),
  {
    name: "engagements per second", part: "", unit: "1/s",
    text: (run, time) => `${engagements(run, "housing", time)}/${engagements(run, "output", time)}`,
  },
  signal("unbalanced mass, acceleration", "imbalance", "imbalance_acceleration", "m/s²"),
];

const ENERGY: readonly Row[] = [
  ["input work", "energy_in"], ["output work", "energy_out"], ["losses", "energy_lost"],
].map(([name = "", column = ""]) => signal(name, "", column, "J"));

const AUDIT: readonly Row[] = [
  ...ENERGY,
  {
    name: "change in stored energy", part: "", unit: "J",
    text: (run, time) => steadyText(
      valueAt(run, "energy_stored", time) - (run.columns.energy_stored?.[0] ?? NaN), largest(run, ["energy_stored"])),
  },
  { name: "residual (integration error)", part: "", unit: "J", text: (run, time) => numberText(valueAt(run, "energy_residual", time), 3) },
];

/** Parts without rows of their own, and the part whose rows apply. */
const OF_ROWS: Readonly<Record<string, string>> = { drive: "link1", satellite: "imbalance" };

/** A table of values at a time. */
class Instruments {
  readonly root: HTMLTableElement;
  private readonly cells: { cell: HTMLElement; unitCell: HTMLElement; unit: string; text: Row["text"] }[];
  private readonly rows: { row: HTMLElement; part: string }[] = [];
  private readonly caption: HTMLElement;

  constructor(private readonly title: string, rows: readonly Row[], private readonly coarse = "") {
    const body = element("tbody");
    this.cells = rows.map(({ name, part, unit, text }) => {
      const cell = element("td");
      const head = element("th", { scope: "row" }, element("i", { class: `dot part-${part || "none"}` }), name);
      const unitCell = element("td", { class: "unit" });
      const row = element("tr", {}, head, cell, unitCell);
      body.append(row);
      this.rows.push({ row, part });
      return { cell, unitCell, unit, text };
    });
    this.caption = element("caption", {}, title);
    this.root = element("table", { class: "instruments" }, this.caption, body);
  }

  /** Mark the rows of a part; null: none. */
  relate(part: string | null): void {
    for (const { row, part: own } of this.rows) row.classList.toggle("related", part !== null && own === (OF_ROWS[part] ?? part));
  }

  show(run: Run, time: number): void {
    this.caption.textContent = this.title + (isCoarse(run) ? this.coarse : "");
    for (const { cell, unitCell, unit, text } of this.cells) {
      setText(unitCell, readUnit(unit).text);
      const now = text(run, time);
      setText(cell, now);
      cell.classList.toggle("holds", now === "locked");
    }
  }
}

export const instruments = (): Instruments => new Instruments("Now", NOW, ", step-averaged torques");
export const audit = (): Instruments => new Instruments("Energy balance", AUDIT);
