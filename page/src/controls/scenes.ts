// The scenes of this page by the names that links have.

import { readStart, type Scene } from "../run/start";

export const START = readStart();

/** All scenes by name, that of the page first. */
export const SCENES: ReadonlyMap<string, Scene> = new Map(
  [START.scene, ...START.presets].map((scene) => [scene.name, scene]),
);
