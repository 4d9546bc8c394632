// What the page says about itself.

import { button, element } from "../common/dom";
import { KEY_HELP } from "./keyboard";

const PARAGRAPHS = [
  "Link 1, the carrier, is turned by the motor. It carries drive wheels that mesh with link 2; on them run satellites with an"
  + " imbalance each. The faster link 1 turns relative to link 2, the faster the imbalances swing, and their inertia pushes link 2"
  + " forwards and backwards in turn.",
  "The housing freewheel takes the backward pushes: it holds link 2 (amber while it holds). The output freewheel passes the forward"
  + " pushes on to the output shaft. So the output is driven by pulses of torque, the stronger the slower it turns: a stepless"
  + " transmission that works like a torque converter. A freewheel with an engagement angle turns back before it holds: its rollers"
  + " stand off the outer race by the play that is left.",
  "All numbers are computed in this page by the kernel of the inertia module, the same that is in the FMU. Change anything on the"
  + " right: the run is integrated anew. Energy that the audit misses is the error of the integration.",
  "Gears, imbalances and their paths are drawn where they are. Shafts, arms, freewheels and the size of wheels 2 and 16 are drawn"
  + " to suit; planar modules stand side by side, and of more than 12 modules or satellites 12 are drawn.",
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
