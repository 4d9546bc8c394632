// Elements of the document, one line each.

type Child = Node | string;

/** An element with attributes and children. */
export function element<Name extends keyof HTMLElementTagNameMap>(
  name: Name, attributes: Readonly<Record<string, string>> = {}, ...children: Child[]
): HTMLElementTagNameMap[Name] {
  const found = document.createElement(name);
  for (const [key, text] of Object.entries(attributes)) found.setAttribute(key, text);
  found.append(...children);
  return found;
}

/** Set the text of an element if it differs. */
export function setText(of: HTMLElement, text: string): void {
  if (of.textContent !== text) of.textContent = text;
}

/** The element with this id. */
export function byId(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (!found) throw new Error(`internal error: missing element '${id}'`);
  return found;
}

/** A button with a word or a sign, and its action as accessible name. */
export function button(sign: string, name: string, press: () => void): HTMLButtonElement {
  const word = /[a-z]/i.test(sign);
  const found = element("button", { type: "button", title: name, ...(!word && { "aria-label": name }) }, sign);
  found.addEventListener("click", press);
  return found;
}

/** Options of a choice as a select element. */
export function choice(
  name: string, options: readonly (readonly [string, string])[], chosen: string, choose: (value: string) => void,
): HTMLSelectElement {
  const found = element("select", { "aria-label": name });
  for (const [value, text] of options) found.append(element("option", { value }, text));
  found.value = chosen;
  found.addEventListener("change", () => { choose(found.value); });
  return found;
}

export interface Tick {
  readonly root: HTMLElement;
  /** Set the tick without notification. */
  show: (ticked: boolean) => void;
}

/** A box to be ticked, with its text. */
export function tick(text: string, change: (ticked: boolean) => void): Tick {
  const input = element("input", { type: "checkbox" });
  input.addEventListener("change", () => { change(input.checked); });
  return { root: element("label", { class: "tick" }, input, text), show: (ticked) => { input.checked = ticked; } };
}
