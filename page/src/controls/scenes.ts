// The scenes of this page by the names that links have.

import { readStart, type Scene, type Start } from "../run/start";

export const START: Start = readStart();

/** All scenes by name, that of the page first; it stands for a preset of its name. */
export const SCENES: ReadonlyMap<string, Scene> = new Map(
  [START.scene, ...START.presets.filter(({ name }) => name !== START.scene.name)].map((scene) => [scene.name, scene]),
);
