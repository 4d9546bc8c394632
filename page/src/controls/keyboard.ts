// Keys of the page. Fields and lists keep theirs.

export type Keys = Readonly<Record<string, () => void>>;

/** What the keys do, for the help of the page. */
export const KEY_HELP: readonly (readonly [string, string])[] = [
  ["Space", "play or pause"],
  ["← →", "a point of the run back or on"],
  [", .", "to the last or next switch of a freewheel"],
  ["L", "repeat one pulse"],
  ["− +", "slower, faster"],
  ["Home End", "to the beginning, to the end"],
  ["F", "follow the carrier"],
  ["C", "cut-away"],
  ["T", "torques"],
  ["V", "see all of the machine"],
];

function takesKeys(target: EventTarget | null, key: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.matches("input[type=text], select, textarea")) return true;
  // sliders move by arrows, buttons and boxes answer the space bar
  if (target.matches("input[type=range]")) return key !== " " && key.length > 1;
  return target.matches("button, summary, input[type=checkbox], a") && (key === " " || key === "Enter");
}

/** Listen to keys by their names (KeyboardEvent.key, letters small). */
export function listen(keys: Keys): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || takesKeys(event.target, event.key)) return;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
