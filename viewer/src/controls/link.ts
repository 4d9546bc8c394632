// The state of the viewer in its address, for links.

import { SPEED_UNITS } from "../common/units";
import type { TraceFrame } from "../machine/trace";
import type { Shown } from "../machine/view";
import type { Settings } from "./settings";

export interface Linked {
  settings: Settings;
  /** s */
  time: number;
  speed: number | null;
}

export const SHOWN: Shown = {
  follow: false, cut: true, labels: true, trace: "link1", acceleration: true, force: false, torques: false,
};
const SWITCHES = ["follow", "cut", "labels", "acceleration", "force", "torques"] as const;
const TRACES: readonly TraceFrame[] = ["link1", "fixed", "off"];

/** The part of the address behind #. Names are those of the table; switches are 0 or 1. */
export function toHash({ settings, time, speed }: Linked): string {
  const parts = new URLSearchParams({ scene: settings.scene });
  for (const [name, value] of Object.entries(settings.changed)) parts.set(name, String(value));
  for (const name of SWITCHES) {
    if (settings.shown[name] !== SHOWN[name]) parts.set(`show-${name}`, settings.shown[name] ? "1" : "0");
  }
  if (settings.speedUnit !== "rad/s") parts.set("speed-unit", settings.speedUnit);
  if (settings.shown.trace !== SHOWN.trace) parts.set("show-trace", settings.shown.trace);
  if (time > 0) parts.set("t", String(Number(time.toPrecision(9))));
  if (speed !== null) parts.set("speed", String(Number(speed.toPrecision(4))));
  return `#${parts.toString()}`;
}

/** Read the state from an address. Unknown names and invalid numbers are listed and ignored. */
export function fromHash(
  hash: string, scenes: readonly string[], names: ReadonlySet<string>,
): Linked & { unknown: string[] } {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const settings: Settings = { scene: scenes[0] ?? "", changed: {}, shown: { ...SHOWN }, speedUnit: "rad/s" };
  const found = { settings, time: 0, speed: null as number | null, unknown: [] as string[] };
  for (const [key, text] of parts) {
    const number = text === "" ? NaN : Number(text);
    const shown = SWITCHES.find((name) => key === `show-${name}`);
    const trace = TRACES.find((frame) => key === "show-trace" && text === frame);
    const unit = SPEED_UNITS.find((name) => key === "speed-unit" && text === name);
    if (key === "scene" && scenes.includes(text)) settings.scene = text;
    else if (shown) settings.shown[shown] = text === "1";
    else if (trace) settings.shown.trace = trace;
    else if (unit) settings.speedUnit = unit;
    else if (Number.isFinite(number) && key === "t") found.time = number;
    else if (Number.isFinite(number) && number > 0 && key === "speed") found.speed = number;
    else if (Number.isFinite(number) && names.has(key)) settings.changed[key] = number;
    else found.unknown.push(`${key}=${text}`);
  }
  return found;
}
