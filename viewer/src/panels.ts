// Everything around the animation: tools, playback bar, tables, sliders, messages, shortcuts.

import type { App } from "./app";
import { button, byId, choice, element, tick } from "./common/dom";
import { SPEED_UNITS, type SpeedUnit } from "./common/units";
import { csv, download, toml } from "./controls/files";
import { FIELDS_OF } from "./controls/groups";
import { helpButton } from "./controls/help";
import { listen } from "./controls/keyboard";
import { PlayBar } from "./controls/playbar";
import { audit, instruments } from "./controls/readouts";
import { SCENES } from "./controls/scenes";
import { Sliders } from "./controls/sliders";
import { followTheme, switchTheme } from "./controls/theme";
import { Tour } from "./controls/tour";
import type { Curves } from "./curves/curves";
import type { TraceFrame } from "./machine/trace";
import { VIEWS, type Shown } from "./machine/view";
import type { Picture } from "./picture";
import type { Run } from "./run/run";
import { lengthOf } from "./run/sample";

const SWITCHES: readonly (readonly [keyof Shown, string])[] = [
  ["labels", "part names"], ["cut", "cut-away"], ["follow", "follow carrier"],
  ["acceleration", "acceleration"], ["force", "shaking force"], ["torques", "torques"],
];
const TRACES: readonly (readonly [TraceFrame, string])[] = [
  ["link1", "path: relative to the carrier"], ["fixed", "path: fixed frame"], ["off", "no path"],
];

/** Factor of the distance and angle (rad) of one step of the camera. */
const ZOOM = 1.15;
const TURN = Math.PI / 24;

export class Panels {
  private readonly bar: PlayBar;
  private readonly now = instruments();
  private readonly audit = audit();
  private readonly sliders: Sliders;
  private readonly message = byId("message");
  private readonly scenes: HTMLSelectElement;
  private readonly reset: HTMLButtonElement;
  private readonly showBoxes: (shown: Shown) => void;
  private readonly tour: Tour;
  private readonly speedUnit: HTMLSelectElement;
  private updated = 0;

  constructor(private readonly app: App, curves: Curves, picture: Picture) {
    this.scenes = choice("Scene", [...SCENES].map(([name, { title }]) => [name, title]), app.store.get().scene, (name) => { app.choose(name); });
    this.reset = button("Reset", "Reset all settings of the scene", () => { app.store.set({ changed: {} }); });
    byId("scene").append(this.scenes, this.reset);
    this.speedUnit = choice("Unit of rotational speeds", SPEED_UNITS.map((unit) => [unit, unit]), app.store.get().speedUnit, (unit) => {
      app.store.set({ speedUnit: unit as SpeedUnit });
    });
    this.tools();
    this.showBoxes = this.boxes();
    this.bar = new PlayBar(app.player, {
      toggle: () => { app.toggle(); },
      step: (forwards) => { app.toSwitch(forwards); },
      pulse: () => { app.pulse(); },
      window: (turns) => { curves.zoom(Number(turns)); app.player.set({}); },
    });
    byId("play").append(this.bar.root);
    this.sliders = new Sliders((name, value) => { app.set(name, value); });
    byId("side").append(
      element("div", { class: "tables" }, this.now.root, this.audit.root),
      element("h2", {}, "Settings"), this.sliders.root);
    followTheme(() => { curves.rebuild(); });
    this.tour = new Tour(byId("tour"), (step) => {
      curves.choose(step.curves, step.third);
      this.bar.window(step.turns);
      app.follow(step);
    });
    this.keys(picture);
    byId("views").append(
      ...VIEWS.map((from) => button(from === "home" ? "all" : from, `View: ${from === "home" ? "whole mechanism" : from}`, () => { picture.look(from); })),
      button("+", "Zoom in", () => { picture.zoom(1 / ZOOM); }), button("−", "Zoom out", () => { picture.zoom(ZOOM); }));
    picture.pointed = (part) => {
      this.now.relate(part);
      this.sliders.relate(part === null ? [] : FIELDS_OF[part] ?? []);
    };
  }

  /** Show the settings. */
  settings(): void {
    const { app } = this;
    const { scene, changed, shown, speedUnit } = app.store.get();
    this.scenes.value = scene;
    this.reset.disabled = Object.keys(changed).length === 0;
    this.sliders.show((name) => app.value(name), (name) => name in changed);
    const story = app.scene.description.replaceAll("\n", " ");
    byId("story").textContent = story;
    this.scenes.title = story;
    this.showBoxes(shown);
    this.speedUnit.value = speedUnit;
  }

  say(error: string, warnings: readonly string[]): void {
    this.message.textContent = error === "" ? warnings.join("; ") : error;
    this.message.classList.toggle("error", error !== "");
  }

  stand(run: Run, time: number, playing: boolean): void {
    this.bar.show(lengthOf(run));
    const now = performance.now();
    if (playing && now - this.updated < 100) return;
    this.updated = now;
    this.now.show(run, time);
    this.audit.show(run, time);
  }

  private tools(): void {
    const { app } = this;
    const name = (): string => app.scene.name;
    const share = button("Copy link", "Copy a link to this view", () => {
      history.replaceState(null, "", app.hash());
      void navigator.clipboard.writeText(location.href).then(() => { this.say("", ["link copied"]); });
    });
    byId("tools").append(
      this.speedUnit,
      button("CSV", "Download the run as CSV", () => { if (app.run) download(`${name()}.csv`, csv(app.run), "text/csv"); }),
      button("TOML", "Download the scene as TOML", () => {
        download(`${name()}.toml`, toml(app.scene, app.store.get().changed), "application/toml");
      }),
      share, button("Tour", "Guided tour in five steps", () => { this.tour.start(); }), button("◐", "Light or dark theme", switchTheme), helpButton());
  }

  /** Check boxes and list of the visible items; the returned function sets them. */
  private boxes(): (shown: Shown) => void {
    const { app } = this;
    const ticks = SWITCHES.map(([name, text]) => ({ name, box: tick(text, (on) => { app.showAlso({ [name]: on }); }) }));
    const path = choice("Path of the unbalanced mass", TRACES, "link1", (frame) => { app.showAlso({ trace: frame as TraceFrame }); });
    byId("shown").append(...ticks.map(({ box }) => box.root), path);
    return (shown) => {
      for (const { name, box } of ticks) box.show(shown[name] === true);
      path.value = shown.trace;
    };
  }

  private keys(picture: Picture): void {
    const { app } = this;
    const flip = (name: "follow" | "cut" | "torques"): void => { app.showAlso({ [name]: !app.store.get().shown[name] }); };
    const faster = (factor: number): void => { app.player.set({ speed: app.player.clock.speed * factor }); };
    listen({
      " ": () => { app.toggle(); },
      ArrowLeft: () => { app.toPoint(false); },
      ArrowRight: () => { app.toPoint(true); },
      ",": () => { app.toSwitch(false); },
      ".": () => { app.toSwitch(true); },
      l: () => { app.pulse(); },
      "+": () => { faster(2); },
      "=": () => { faster(2); },
      "-": () => { faster(0.5); },
      Home: () => { app.player.set({ time: 0, loop: null }); },
      End: () => { app.player.set({ time: Infinity, loop: null, playing: false }); },
      f: () => { flip("follow"); },
      c: () => { flip("cut"); },
      t: () => { flip("torques"); },
      v: () => { picture.look("home"); },
      1: () => { picture.look("front"); },
      2: () => { picture.look("along the shaft"); },
      3: () => { picture.look("isometric"); },
      i: () => { picture.zoom(1 / ZOOM); },
      o: () => { picture.zoom(ZOOM); },
      "Shift+ArrowLeft": () => { picture.turn(-TURN, 0); },
      "Shift+ArrowRight": () => { picture.turn(TURN, 0); },
      "Shift+ArrowUp": () => { picture.turn(0, TURN); },
      "Shift+ArrowDown": () => { picture.turn(0, -TURN); },
    });
  }
}
