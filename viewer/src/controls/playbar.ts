// Play, pause, scrub, slow motion, steps.

import type { Player } from "./player";
import { button, choice, element } from "../common/dom";
import { steadyText } from "../common/units";

export interface PlayActions {
  toggle: () => void;
  step: (forwards: boolean) => void;
  pulse: () => void;
  window: (choice: string) => void;
}

const PARTS = 10000;
const SPEEDS = [0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];

/** Playback speed as text. */
function speedText(speed: number): string {
  return speed < 1 ? `slow motion 1/${Math.round(1 / speed)}` : speed === 1 ? "real time" : `${speed} × real time`;
}

/** The nearest selectable speed. */
function nearestSpeed(speed: number): number {
  return SPEEDS.reduce((best, other) => Math.abs(Math.log(other / speed)) < Math.abs(Math.log(best / speed)) ? other : best);
}

/** The playback bar below the animation. */
export class PlayBar {
  readonly root: HTMLElement;
  private readonly play: HTMLButtonElement;
  private readonly pulse: HTMLButtonElement;
  private readonly scrub = element("input", {
    type: "range", min: "0", max: String(PARTS), step: "1", value: "0", class: "scrub", "aria-label": "time",
  });
  private readonly time = element("output", { class: "time", "aria-live": "off" });
  private readonly speed: HTMLSelectElement;
  private readonly range: HTMLSelectElement;
  private length = 1;

  constructor(private readonly player: Player, private readonly actions: PlayActions) {
    this.play = button("▶", "Play", actions.toggle);
    this.play.classList.add("play");
    this.pulse = button("↻ one pulse", "Repeat one pulse, slowly", actions.pulse);
    this.speed = choice("Playback speed", SPEEDS.map((speed) => [String(speed), speedText(speed)]), "0.05", (text) => {
      player.set({ speed: Number(text) });
    });
    this.scrub.addEventListener("input", () => {
      player.set({ time: (Number(this.scrub.value) / PARTS) * this.length, loop: null });
    });
    this.range = choice("Time range of the curves", [["0", "curves: whole run"], ["10", "curves: 10 revolutions"], ["2", "curves: 2 revolutions"]], "0", actions.window);
    this.root = element("div", { class: "playbar", role: "group", "aria-label": "Playback" },
      this.play,
      button("⇤", "Previous freewheel switching event", () => { actions.step(false); }),
      button("⇥", "Next freewheel switching event", () => { actions.step(true); }),
      this.pulse, this.scrub, this.time, this.speed,
      this.range);
  }

  /** Select the time range of the curves in revolutions of link 1; 0: the whole run. */
  window(turns: number): void {
    this.range.value = String(turns);
    this.actions.window(this.range.value);
  }

  show(length: number): void {
    const { time, playing, speed, loop } = this.player.clock;
    this.length = length || 1;
    const sign = playing ? "❚❚" : "▶";
    if (this.play.textContent !== sign) {
      this.play.textContent = sign;
      this.play.setAttribute("aria-label", playing ? "Pause" : "Play");
      this.play.title = playing ? "Pause (space)" : "Play (space)";
    }
    this.pulse.setAttribute("aria-pressed", String(loop !== null));
    this.scrub.value = String(Math.round((time / this.length) * PARTS));
    const text = `${steadyText(time * 1000, length * 1000)} ms`;
    this.time.textContent = text;
    this.scrub.setAttribute("aria-valuetext", text);
    const chosen = String(nearestSpeed(speed));
    if (this.speed.value !== chosen) this.speed.value = chosen;
  }
}
