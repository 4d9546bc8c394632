// Entry of the viewer. Its functions exist once the kernel is ready.

import { App } from "./app";
import { START } from "./controls/scenes";
import { playable } from "./run/recorded";
import { integrate, ready, simulate, variables } from "./run/run";

const app = new App();
// a link that is opened in the running viewer; the viewer changes its own address without this event
addEventListener("hashchange", () => { location.reload(); });
await ready;
Object.assign(window, {
  inertiaModule: {
    simulate, integrate, playable, variables,
    start: START,
    state: () => app.state(),
    seek: (time: number) => { app.player.set({ time, playing: false, loop: null }); },
  },
});
