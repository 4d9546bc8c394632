// Initial data of the viewer, written by the package.

import { embedded } from "../kernel/tables";
import type { Recorded } from "./recorded";
import type { Input } from "./signals";

/** A scene in the form that the viewer simulates. */
export interface Scene {
  /** Short, of letters and hyphens: stands in links. */
  name: string;
  title: string;
  description: string;
  /** Parameters that differ from the start values of the table. */
  parameters: Record<string, number>;
  inputs: Record<string, Input>;
  /** Communication step and duration, s. */
  step: number;
  duration: number;
  /** Names that the scene wants to see. */
  outputs: string[];
  /** True if the viewer simulates the scene exactly; otherwise inputs that depend on the motion are constant at their means. */
  exact: boolean;
}

export interface Start {
  scene: Scene;
  /** The recorded run of the scene (see playable), shown until something is changed. */
  run: Recorded | null;
  presets: Scene[];
}

/** The start of this page. */
export function readStart(): Start {
  return { ...(JSON.parse(embedded("start")) as Start), presets: JSON.parse(embedded("presets")) as Scene[] };
}
