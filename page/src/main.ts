// The page begins here. What can be called is there once the kernel is.

import { App } from "./app";
import { integrate, ready, simulate, variables } from "./run/run";

const app = new App();
await ready;
Object.assign(window, { inertiaModule: { simulate, integrate, variables, state: () => app.state() } });
