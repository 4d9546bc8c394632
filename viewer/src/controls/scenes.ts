// The scenes of this page by the names that links have.

import { readStart, type Scene, type Start } from "../run/start";

export const START: Start = readStart();

/** All scenes by name, the scene of the file first; it replaces a preset of the same name. */
export const SCENES: ReadonlyMap<string, Scene> = new Map(
  [START.scene, ...START.presets.filter(({ name }) => name !== START.scene.name)].map((scene) => [scene.name, scene]),
);
