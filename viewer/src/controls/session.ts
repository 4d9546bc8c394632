// The displayed run: simulated again after every change; after an error the last valid run stays.

import { playable } from "../run/recorded";
import { integrate, ready, type Request, type Run } from "../run/run";
import type { Scene } from "../run/start";
import { START } from "./scenes";
import { requestOf, type Settings } from "./settings";

export interface News {
  /** A run to show, as far as it has come. */
  run: (run: Run) => void;
  /** Error message and warnings; empty without errors. */
  say: (error: string, warnings: readonly string[]) => void;
  /** Called with true while a simulation runs. */
  busy: (busy: boolean) => void;
}

/** A run that takes longer than this is shown as it grows, ms. */
const PATIENCE = 150;
/** More points than this are not kept. */
const MOST_STEPS = 60_000;

const CONSTANT = "Loads and sources that depend on the motion are constant in this viewer.";

function recordedNote(every: number): string {
  const which = every === 1 ? "" : `, every ${every}th point`;
  return `Recorded run${which}. Change any setting to simulate in the browser.`;
}

export class Session {
  private running: { cancel: () => void } | null = null;
  private asked = 0;

  constructor(private readonly news: News) {}

  /** Show the run of a scene with its changes: simulated here, or recorded if available. */
  async ask(scene: Scene, changed: Settings["changed"]): Promise<void> {
    this.running?.cancel();
    const mine = ++this.asked;
    const request = requestOf(scene, changed);
    this.news.busy(true);
    if (START.run && scene.name === START.scene.name && Object.keys(changed).length === 0) {
      const run = await playable(START.run, request.parameters);
      if (mine === this.asked) this.end(run, [recordedNote(START.run.every), ...run.warnings]);
      return;
    }
    await ready;
    if (mine === this.asked) this.integrate(request, scene.exact ? [] : [CONSTANT]);
  }

  private integrate(request: Request, notes: readonly string[]): void {
    const bad = tooLong(request);
    if (bad !== "") {
      this.news.busy(false);
      this.news.say(bad, []);
      return;
    }
    const began = performance.now();
    const mine = this.asked;
    let shown = false;
    this.running = integrate(request, (run) => {
      if (mine !== this.asked) return;
      if (run.complete || run.error !== null) this.end(run, [...notes, ...run.warnings]);
      else if (run.time.length > 1 && (shown || performance.now() - began > PATIENCE)) {
        shown = true;
        this.news.run(run);
      }
    });
  }

  private end(run: Run, notes: readonly string[]): void {
    if (run.time.length > 1) this.news.run(run);
    this.news.busy(false);
    this.news.say(run.error ?? "", notes);
  }
}

/** The message for a run with too many or no steps, otherwise an empty text. */
function tooLong({ step, duration }: Request): string {
  const steps = Math.round(duration / step);
  if (steps >= 1 && steps <= MOST_STEPS) return "";
  const least = Number((duration / MOST_STEPS).toPrecision(3));
  const advice = steps > MOST_STEPS ? `; step must be at least ${least} s` : "";
  return `a run must have between 1 and ${MOST_STEPS} steps (got duration ${duration} s, step ${step} s)${advice}`;
}
