// The guided tour: five steps that explain the mechanism, each with its view, curves and time.

import { button, element } from "../common/dom";
import type { Shown, ViewName } from "../machine/view";

export interface TourStep {
  readonly title: string;
  readonly text: string;
  readonly view: ViewName;
  readonly shown: Partial<Shown>;
  /** Panels of curves over time, and the third panel. */
  readonly curves: readonly [string, string];
  readonly third: "phase" | "chart";
  /** Revolutions of link 1 in the curves; 0: the whole run. */
  readonly turns: number;
  /** Time as a fraction of the run; with a freewheel the next time at which it is locked. */
  readonly time: number;
  readonly locked?: "housing" | "output";
  /** Repeat the pulse at this time. */
  readonly repeats: boolean;
}

export const TOUR: readonly TourStep[] = [
  {
    title: "Slip spins the satellites",
    text: "The motor turns link 1. Link 2 turns more slowly. This difference in speed, the slip, rolls the satellites and spins their unbalanced masses.",
    view: "home", shown: { trace: "link1", acceleration: false }, curves: ["speeds", "torques"], third: "phase", turns: 2, time: 0.1, repeats: false,
  },
  {
    title: "Their force swings",
    text: "Each unbalanced mass follows the red path. Its acceleration (arrow) changes direction, so the torque M2 on link 2 swings: forward, then backward.",
    view: "isometric", shown: { trace: "link1", acceleration: true }, curves: ["torques", "speeds"], third: "phase", turns: 2, time: 0.5, repeats: true,
  },
  {
    title: "The housing freewheel takes the backward half",
    text: "In the backward half the housing freewheel locks (amber). The torque Th acts on the housing, and link 2 stands still: ω2 = 0.",
    view: "front", shown: { torques: true, acceleration: false }, curves: ["torques", "speeds"], third: "phase", turns: 2, time: 0.5, locked: "housing", repeats: true,
  },
  {
    title: "The output freewheel passes the forward half",
    text: "In the forward half link 2 accelerates to the output speed. The output freewheel locks (amber) and transmits the torque Tc to the output shaft.",
    view: "front", shown: { torques: true, acceleration: false }, curves: ["torques", "speeds"], third: "phase", turns: 2, time: 0.5, locked: "output", repeats: true,
  },
  {
    title: "The torque falls with the speed ratio",
    text: "The faster the output turns, the smaller the slip and the weaker the pulses. The mean output torque falls with the speed ratio, as in a torque converter. No control is necessary.",
    view: "home", shown: {}, curves: ["speeds", "torques"], third: "chart", turns: 0, time: 1, repeats: false,
  },
];

/** The panel of the tour, hidden until it starts. */
export class Tour {
  private readonly heading = element("h2");
  private readonly text = element("p");
  private readonly back = button("Back", "Previous step of the tour", () => { this.go(this.place - 1); });
  private readonly next = button("Next", "Next step of the tour", () => { this.go(this.place + 1); });
  private place = 0;

  constructor(private readonly root: HTMLElement, private readonly take: (step: TourStep) => void) {
    root.append(
      element("div", { "aria-live": "polite" }, this.heading, this.text),
      element("div", { class: "tools" }, this.back, this.next, button("End tour", "End the tour", () => { this.end(); })));
    root.addEventListener("keydown", (event) => { if (event.key === "Escape") this.end(); });
  }

  start(): void {
    this.root.hidden = false;
    this.go(0);
    this.next.focus();
  }

  private go(place: number): void {
    const step = TOUR[place];
    if (!step) { this.end(); return; }
    this.place = place;
    this.heading.textContent = `${place + 1} of ${TOUR.length}: ${step.title}`;
    this.text.textContent = step.text;
    this.back.disabled = place === 0;
    this.next.textContent = place === TOUR.length - 1 ? "Finish" : "Next";
    this.take(step);
  }

  private end(): void {
    this.root.hidden = true;
  }
}
