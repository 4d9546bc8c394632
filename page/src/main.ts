// The page begins here.

import { App } from "./app";
import { integrate, ready, simulate, variables } from "./run/run";
import { playable } from "./run/recorded";
import { readStart } from "./run/start";

await ready;
const app = new App();
Object.assign(window, {
  inertiaModule: { simulate, integrate, playable, variables, start: readStart(), state: () => app.state() },
});
