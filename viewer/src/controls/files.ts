// Downloads: the run as CSV, the scene as TOML.

import { variables, type Input, type Run } from "../run/run";
import type { Scene } from "../run/start";
import { currentValue, requestOf, sceneValue, type Settings } from "./settings";

/** Offer a text as a file. */
export function download(name: string, text: string, type: string): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  URL.revokeObjectURL(address);
}

const unitOf = new Map(variables.map((v) => [v.name, v.unit]));

/** The whole run: a heading with units, a line for each point, all digits. */
export function csv(run: Run): string {
  const names = Object.keys(run.columns).filter((name) => unitOf.has(name));
  const heading = ["time [s]", ...names.map((name) => {
    const unit = unitOf.get(name) ?? "";
    return unit === "" || unit === "1" ? name : `${name} [${unit}]`;
  })];
  const lines = Array.from(run.time, (time, n) => [time, ...names.map((name) => run.columns[name]?.[n] ?? NaN)].join(","));
  return `${[heading.join(","), ...lines].join("\n")}\n`;
}

function written(name: string, value: number): string {
  const items = variables.find((v) => v.name === name)?.items ?? [];
  const item = items.find(({ number }) => number === value)?.name;
  if (item === undefined) return String(value);
  return item === "true" || item === "false" ? item : JSON.stringify(item);
}

/** An input as keys of its table: constant, or straight lines between points. */
function driveKeys(name: string, input: Input): string[] {
  const torque = name === "drive_torque";
  if (typeof input === "number") return [`kind = "${torque ? "torque" : "constant"}"`, `${name} = ${input}`];
  return [
    `kind = "${torque ? "torque_table" : "table"}"`,
    `time = [${input.times.join(", ")}]`, `${name} = [${input.values.join(", ")}]`,
  ];
}

function loadKeys(load: Input): string[] {
  if (typeof load === "number") return [`torque = ${load}`];
  return [`torque_over_time = { time = [${load.times.join(", ")}], torque = [${load.values.join(", ")}] }`];
}

/** A scene file of the displayed settings, for `inertia-module run`. Numbers are in SI units. */
export function toml(scene: Scene, changed: Settings["changed"]): string {
  const { inputs, step, duration } = requestOf(scene, changed);
  const byTorque = currentValue(scene, changed, "drive") === 1;
  const mechanism = variables
    .filter((v) => v.causality === "parameter" && v.name !== "tolerance" && v.name !== "drive")
    .map((v) => ({ name: v.name, value: currentValue(scene, changed, v.name), start: v.start }))
    .filter(({ value, start }) => value !== start)
    .map(({ name, value }) => `${name} = ${written(name, value)}`);
  const drive = byTorque
    ? [...driveKeys("drive_torque", inputs.drive_torque ?? 0), `omega1 = ${currentValue(scene, changed, "omega1")}`]
    : driveKeys("omega1", inputs.omega1 ?? 0);
  return [
    `title = ${JSON.stringify(Object.keys(changed).length > 0 ? `${scene.title}, changed` : scene.title)}`, "",
    "[mechanism]", ...mechanism, "",
    "[drive]", ...drive, "",
    "[load]", 'kind = "torque"', ...loadKeys(inputs.load_torque ?? sceneValue(scene, "load_torque")), "",
    "[accuracy]", `tolerance = ${currentValue(scene, changed, "tolerance")}`, "",
    "[run]", `stop_time = ${duration}`, `communication_step = ${step}`,
    `outputs = ${JSON.stringify(scene.outputs)}`, "",
  ].join("\n");
}
