// Light or dark: as the system has it, until the reader switches.

const system = matchMedia("(prefers-color-scheme: dark)");
let chosen: boolean | null = null;

function apply(): void {
  document.documentElement.dataset.theme = (chosen ?? system.matches) ? "dark" : "light";
}

/** The other one. */
export function switchTheme(): void {
  chosen = !(chosen ?? system.matches);
  apply();
  document.dispatchEvent(new Event("themechange"));
}

/** Take the colours of the system, and call whoever draws in them when they change. */
export function followTheme(changed: () => void): void {
  apply();
  system.addEventListener("change", () => { apply(); changed(); });
  document.addEventListener("themechange", changed);
}
