// The viewer: settings, run, clock, animation and curves.

import { byId } from "./common/dom";
import { setSpeedUnit } from "./common/units";
import { fromHash, SHOWN, toHash } from "./controls/link";
import { nextLocked, nextSwitch, pulseAround } from "./controls/pulses";
import { calmSpeed, Player } from "./controls/player";
import { SCENES } from "./controls/scenes";
import { Session } from "./controls/session";
import { currentValue, requestOf, Store, withChange, type Settings } from "./controls/settings";
import type { TourStep } from "./controls/tour";
import { Curves } from "./curves/curves";
import type { Shown } from "./machine/view";
import { variables, type Run } from "./run/run";
import { indexAt, lengthOf } from "./run/sample";
import type { Scene } from "./run/start";
import { Panels } from "./panels";
import { Picture } from "./picture";

const SETTABLE = new Set([
  ...variables.filter((v) => v.causality === "input" || v.causality === "parameter").map((v) => v.name), "duration", "step",
]);

/** Scene of the guided tour, if the page has it. */
const TOUR_SCENE = "reference";

/** Interval between updates of names, curves and numbers while frames are slow, ms. */
const SLOW_UPDATE_INTERVAL = 125;

/** Speed at which a pulse takes four seconds on the wall. */
function pulseSpeed([from, to]: [number, number]): number {
  return Number(((to - from) / 4).toPrecision(1)) || 1;
}

/** The viewer. */
export class App {
  readonly store: Store<Settings>;
  readonly player: Player;
  run: Run | null = null;
  error = "";
  busy = false;
  private readonly session: Session;
  private readonly picture: Picture;
  private readonly curves: Curves;
  private readonly panels: Panels;
  private wanted = true;
  private asked = false;
  private linking = 0;
  private awake = false;
  /** Step of the tour whose run is not complete. */
  private step: TourStep | null = null;
  private last = Infinity;
  /** Time of the last update of names, curves and numbers, ms. */
  private lastUpdate = 0;

  constructor() {
    const linked = fromHash(location.hash, [...SCENES.keys()], SETTABLE);
    this.store = new Store(linked.settings);
    setSpeedUnit(linked.settings.speedUnit);
    this.player = new Player(() => { this.changed(); });
    this.picture = new Picture(() => { this.want(); });
    this.curves = new Curves(byId("curves"), (time) => { this.player.set({ time, loop: null }); });
    this.panels = new Panels(this, this.curves, this.picture);
    this.session = new Session({
      run: (run) => { this.show(run); },
      say: (error, warnings) => {
        this.error = [error, linked.unknown.length > 0 ? `unknown settings in the link: ${linked.unknown.join(", ")}` : ""]
          .filter((text) => text !== "").join("; ");
        this.panels.say(this.error, [...this.picture.remarks, ...warnings]);
      },
      busy: (busy) => { this.busy = busy; },
    });
    this.store.watch(() => { this.settled(); });
    this.picture.show(linked.settings.shown);
    this.panels.settings();
    this.player.clock.time = linked.time;
    this.player.clock.speed = linked.speed ?? calmSpeed(currentValue(this.scene, linked.settings.changed, "omega1"));
    this.player.clock.playing = linked.time === 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.picture.still(requestOf(this.scene, linked.settings.changed).parameters);
    void this.session.ask(this.scene, linked.settings.changed);
    this.want();
  }

  get scene(): Scene {
    const found = SCENES.get(this.store.get().scene);
    if (!found) throw new Error(`unknown scene '${this.store.get().scene}'`);
    return found;
  }

  value(name: string): number {
    return currentValue(this.scene, this.store.get().changed, name);
  }

  /** Set a variable, duration or step. */
  set(name: string, value: number): void {
    this.store.set({ changed: withChange(this.scene, this.store.get().changed, name, value) });
  }

  /** Take a scene as it is. */
  choose(scene: string): void {
    this.store.set({ scene, changed: {} });
    this.player.set({ time: 0, loop: null, speed: calmSpeed(this.value("omega1")) });
    this.picture.home();
  }

  /** Show a step of the tour: scene R1, then its view and time once the run is complete. */
  follow(step: TourStep): void {
    this.step = step;
    this.player.set({ playing: false, loop: null });
    this.store.set({
      scene: SCENES.has(TOUR_SCENE) ? TOUR_SCENE : this.scene.name, changed: {}, shown: { ...SHOWN, ...step.shown },
    });
  }

  showAlso(change: Partial<Shown>): void {
    this.store.set({ shown: { ...this.store.get().shown, ...change } });
  }

  toggle(): void {
    const { playing, time, loop } = this.player.clock;
    const ended = this.run !== null && loop === null && time >= lengthOf(this.run);
    this.player.set({ playing: !playing, ...(ended && { time: 0 }) });
  }

  /** To the next or last switching event of a freewheel. */
  toSwitch(forwards: boolean): void {
    const time = this.run && nextSwitch(this.run, this.player.clock.time, forwards);
    if (time !== null) this.player.set({ time, playing: false, loop: null });
  }

  /** To the next or last point of the run. */
  toPoint(forwards: boolean): void {
    if (!this.run) return;
    const { time } = this.run;
    const index = indexAt(time, this.player.clock.time);
    const before = (time[index] ?? 0) < this.player.clock.time ? index : index - 1;
    this.player.set({ time: time[forwards ? index + 1 : Math.max(before, 0)] ?? lengthOf(this.run), playing: false, loop: null });
  }

  /** Repeat the pulse around the clock, or no longer. */
  pulse(): void {
    if (!this.run) return;
    const { loop, time } = this.player.clock;
    if (loop) { this.player.set({ loop: null }); return; }
    const around = pulseAround(this.run, time);
    this.player.set({ loop: around, time: around[0], playing: true, speed: pulseSpeed(around) });
  }

  hash(): string {
    const { time, speed } = this.player.clock;
    return toHash({ settings: this.store.get(), time, speed });
  }

  /** All that is shown, for tests and tinkerers. */
  state(): object {
    return {
      ...this.player.clock, settings: this.store.get(), run: this.run, error: this.error, busy: this.busy || this.asked,
      hash: this.hash(), imbalance: this.picture.imbalance(), play: this.picture.play,
      chart: this.curves.chartPoints(), pixelRatio: this.picture.pixelRatio,
    };
  }

  /** A new run, or more of one. */
  private show(run: Run): void {
    this.run = run;
    this.player.reach(lengthOf(run), run.complete || run.error !== null);
    this.picture.run(run);
    this.curves.show(run);
    if (run.complete && this.step) this.take(run, this.step);
    this.want();
  }

  /** Set view and time of a step of the tour. */
  private take(run: Run, { view, time, locked, repeats }: TourStep): void {
    this.step = null;
    this.picture.look(view);
    const at = locked ? nextLocked(run, locked, time * lengthOf(run)) : time * lengthOf(run);
    const loop = repeats ? pulseAround(run, at) : null;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches || time === 1;
    const speed = loop ? pulseSpeed(loop) : calmSpeed(this.value("omega1"));
    this.player.set({ time: at, loop, speed, playing: !isStill });
  }

  private settled(): void {
    if (setSpeedUnit(this.store.get().speedUnit)) this.curves.rebuild();
    this.picture.show(this.store.get().shown);
    this.panels.settings();
    // sliders move many times in a frame
    this.asked = true;
    this.changed();
  }

  private changed(): void {
    this.want();
    if (this.linking !== 0) return;
    this.linking = window.setTimeout(() => {
      this.linking = 0;
      if (!this.player.clock.playing) history.replaceState(null, "", this.hash());
    }, 300);
  }

  private want(): void {
    this.wanted = true;
    this.wake();
  }

  /** Ask for a frame: at rest there are none. */
  private wake(): void {
    if (this.awake) return;
    this.awake = true;
    requestAnimationFrame((now) => {
      this.awake = false;
      this.tick(now);
      if (this.player.clock.playing || (this.wanted && this.run)) this.wake();
      else this.last = Infinity;
    });
  }

  private tick(now: number): void {
    const passed = Math.max(0, (now - this.last) / 1000);
    this.last = now;
    if (this.asked) {
      this.asked = false;
      void this.session.ask(this.scene, this.store.get().changed);
    }
    this.player.advance(passed);
    if (!this.wanted || !this.run) return;
    const { clock } = this.player;
    const isDue = !clock.playing || !this.picture.isSlow || now - this.lastUpdate >= SLOW_UPDATE_INTERVAL;
    this.wanted = this.picture.draw(this.run, clock.time, clock.playing ? passed : Infinity, isDue);
    if (!isDue) return;
    this.lastUpdate = now;
    this.curves.stand(clock.time, clock.playing);
    this.panels.stand(this.run, clock.time, clock.playing);
  }
}
