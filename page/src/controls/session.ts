// The run that is shown: of the scene as it is set, integrated anew after every change; a refusal keeps the last good one.

import { integrate, type Run } from "../run/run";
import type { Scene } from "../run/start";
import { requestOf, type Settings } from "./settings";

export interface News {
  /** A run to show, as far as it has come. */
  run: (run: Run) => void;
  /** Sentences about what was asked for: empty if all is well. */
  say: (refusal: string, warnings: readonly string[]) => void;
  /** Whether an integration is under way. */
  busy: (busy: boolean) => void;
}

/** A run that takes longer than this is shown as it grows, ms. */
const PATIENCE = 150;
/** More points than this are not kept. */
const MOST_STEPS = 60_000;

export class Session {
  private running: { cancel: () => void } | null = null;
  private asked = 0;

  constructor(private readonly news: News) {}

  /** Integrate a scene with what has been changed in it. */
  ask(scene: Scene, changed: Settings["changed"]): void {
    this.running?.cancel();
    const request = requestOf(scene, changed);
    const { step, duration } = request;
    const steps = Math.round(duration / step);
    if (!(steps >= 1 && steps <= MOST_STEPS)) {
      const least = Number((duration / MOST_STEPS).toPrecision(3));
      this.news.say(`a run of the page must have between 1 and ${MOST_STEPS} steps: duration is ${duration} s, step ${step} s`
        + (steps > MOST_STEPS ? `, at least ${least} s` : ""), []);
      return;
    }
    const began = performance.now();
    const mine = ++this.asked;
    let shown = false;
    this.news.busy(true);
    this.running = integrate(request, (run) => {
      if (mine !== this.asked) return;
      const ended = run.complete || run.refusal !== null;
      const useful = run.time.length > 1;
      if (useful && (ended || shown || performance.now() - began > PATIENCE)) {
        shown = true;
        this.news.run(run);
      }
      if (!ended) return;
      this.news.busy(false);
      this.news.say(run.refusal ?? "", run.warnings);
    });
  }
}
