// The page begins here.

import { integrate, ready, simulate, variables } from "./run/run";
import { playable } from "./run/recorded";
import { readStart } from "./run/start";

await ready;
Object.assign(window, { inertiaModule: { simulate, integrate, playable, variables, start: readStart() } });
