// Settings of the user: a scene and the changes to it.

import type { SpeedUnit } from "../common/units";
import type { Shown } from "../machine/view";
import { variables, type Request } from "../run/run";
import type { Scene } from "../run/start";

export interface Settings {
  /** Name of the scene. */
  scene: string;
  /** Values that differ from those of the scene, by name; duration and step (s) among them. */
  changed: Record<string, number>;
  shown: Shown;
  /** Unit of rotational speeds in the whole page. */
  speedUnit: SpeedUnit;
}

/** Settings of the user and their listeners. */
export class Store<Value extends object> {
  private readonly listeners: ((value: Value) => void)[] = [];

  constructor(private value: Value) {}

  get(): Value {
    return this.value;
  }

  set(change: Partial<Value>): void {
    this.value = { ...this.value, ...change };
    for (const listener of this.listeners) listener(this.value);
  }

  watch(listener: (value: Value) => void): void {
    this.listeners.push(listener);
  }
}

const starts: Readonly<Record<string, number>> = Object.fromEntries(
  variables.filter((v) => v.causality === "parameter").map((v) => [v.name, v.start ?? 0]),
);
const inputNames = variables.filter((v) => v.causality === "input").map((v) => v.name);

/** The value that a scene gives to a parameter, an input, duration or step; of an input over time its last. */
export function sceneValue(scene: Scene, name: string): number {
  if (name === "duration") return scene.duration;
  if (name === "step") return scene.step;
  const input = scene.inputs[name];
  if (input !== undefined) return typeof input === "number" ? input : input.values.at(-1) ?? 0;
  return scene.parameters[name] ?? variables.find((v) => v.name === name)?.start ?? 0;
}

/** Relative difference below which fields, which have seven digits, show the same number. */
const SAME_RTOL = 5e-7;

/** The changes with a further one; a value equal to that of the scene is no change. */
export function withChange(scene: Scene, changed: Settings["changed"], name: string, value: number): Settings["changed"] {
  const original = sceneValue(scene, name);
  const isConstant = typeof (scene.inputs[name] ?? 0) === "number";
  if (!isConstant || Math.abs(value - original) > SAME_RTOL * Math.abs(original)) return { ...changed, [name]: value };
  return Object.fromEntries(Object.entries(changed).filter(([other]) => other !== name));
}

/** The value that counts: the changed one, else that of the scene. */
export function currentValue(scene: Scene, changed: Settings["changed"], name: string): number {
  return changed[name] ?? sceneValue(scene, name);
}

/** The run that a scene with changes asks for: all parameters, all inputs. */
export function requestOf(scene: Scene, changed: Settings["changed"]): Request {
  const parameters = { ...starts, ...scene.parameters };
  for (const name of Object.keys(starts)) parameters[name] = changed[name] ?? parameters[name] ?? 0;
  const inputs = Object.fromEntries(
    inputNames.map((name) => [name, changed[name] ?? scene.inputs[name] ?? sceneValue(scene, name)]),
  );
  return { parameters, inputs, duration: currentValue(scene, changed, "duration"), step: currentValue(scene, changed, "step") };
}
