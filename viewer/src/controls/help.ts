// Help text of the viewer.

import { button, element } from "../common/dom";
import { KEY_HELP } from "./keyboard";

const PARAGRAPHS = [
  "The motor turns link 1, the carrier. The carrier supports pinions that mesh with link 2, and satellites with an unbalanced mass"
  + " each. The faster link 1 turns relative to link 2, the faster the unbalanced masses spin. Their inertia pushes link 2"
  + " alternately forward and backward.",
  "The housing freewheel (one-way clutch) transmits the backward pulses to the housing and locks link 2; it is amber while locked."
  + " The output freewheel transmits the forward pulses to the output shaft. The slower the output turns, the stronger the pulses:"
  + " a continuously variable transmission that behaves like a torque converter. A freewheel with an engagement angle rotates"
  + " backward before it locks. The gap between its rollers and the outer race is the remaining angle.",
  "The kernel of the FMU computes all numbers in this page. Change any setting on the right to run the simulation again."
  + " The energy residual is the integration error.",
  "Gears, unbalanced masses and their paths are drawn to scale. Shafts, arms, freewheels and the diameters of gears 2 and 16 are"
  + " schematic. Planar modules are drawn side by side, at most 12 modules and 12 satellites.",
];

/** A button that opens the help. */
export function helpButton(): HTMLElement {
  const dialog = element("dialog", { "aria-label": "Help" },
    element("h2", {}, "What is this?"), ...PARAGRAPHS.map((text) => element("p", {}, text)),
    element("h2", {}, "Keys"),
    element("dl", {}, ...KEY_HELP.flatMap(([keys, what]) => [element("dt", {}, keys), element("dd", {}, what)])));
  const close = button("Close", "Close", () => { dialog.close(); });
  dialog.append(close);
  document.body.append(dialog);
  const open = button("?", "What is this? Keys", () => { dialog.showModal(); });
  return open;
}
