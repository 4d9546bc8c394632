// Keyboard shortcuts of the viewer. Input fields and lists keep their own keys.

export type Keys = Readonly<Record<string, () => void>>;

/** Shortcuts and their actions, for the help dialog. */
export const KEY_HELP: readonly (readonly [string, string])[] = [
  ["Space", "play or pause"],
  ["← →", "previous or next point of the run"],
  [", .", "previous or next freewheel switching event"],
  ["L", "repeat one pulse"],
  ["− +", "slower, faster"],
  ["Home End", "start or end of the run"],
  ["F", "follow the carrier"],
  ["C", "cut-away"],
  ["T", "torques"],
  ["V", "show the whole mechanism"],
  ["1 2 3", "view from the front, along the shaft, isometric"],
  ["Shift + arrows", "turn the view"],
  ["I O", "zoom in, zoom out"],
  ["Escape", "in a field: restore the last value"],
];

function takesKeys(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.matches("input[type=text], select, textarea")) return true;
  // arrow keys move sliders, the space bar activates buttons and check boxes
  if (target.matches("input[type=range]")) return key !== " " && key.length > 1;
  return target.matches("button, summary, input[type=checkbox], a") && (key === " " || key === "Enter");
}

/** Listen to keys by name (KeyboardEvent.key, lower-case letters). */
export function listen(keys: Keys): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || takesKeys(event.target, event.key)) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const act = keys[event.shiftKey && key.startsWith("Arrow") ? `Shift+${key}` : key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
