// The page begins here.

import { integrate, ready, simulate, variables } from "./run/run";

await ready;
Object.assign(window, { inertiaModule: { simulate, integrate, variables } });
