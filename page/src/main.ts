// The page begins here. What can be called is there once the kernel is.

import { App } from "./app";
import { START } from "./controls/scenes";
import { playable } from "./run/recorded";
import { integrate, ready, simulate, variables } from "./run/run";

const app = new App();
await ready;
Object.assign(window, {
  inertiaModule: { simulate, integrate, playable, variables, start: START, state: () => app.state() },
});
