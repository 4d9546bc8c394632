// The page begins here.

import { App } from "./app";
import { integrate, ready, simulate, variables } from "./run/run";

await ready;
const app = new App();
Object.assign(window, { inertiaModule: { simulate, integrate, variables, state: () => app.state() } });
