// Names of the parts, written over the picture.

import { Vector3, type Camera, type Object3D } from "three";

interface Label {
  readonly element: HTMLElement;
  readonly on: Object3D;
  readonly at: Vector3;
  readonly half: number;
}

/** Labels hang on points of things and follow them. */
export class Labels {
  private labels: Label[] = [];
  private readonly point = new Vector3();

  constructor(private readonly host: HTMLElement) {
    // a reader of the screen has the names in the table of values
    host.setAttribute("aria-hidden", "true");
  }

  set visible(shown: boolean) {
    this.host.hidden = !shown;
  }

  clear(): void {
    this.labels = [];
    this.host.replaceChildren();
  }

  add(text: string, part: string, on: Object3D, at: Vector3): HTMLElement {
    const element = document.createElement("span");
    element.className = `label part-${part}`;
    element.textContent = text;
    this.host.append(element);
    this.labels.push({ element, on, at, half: element.offsetWidth / 2 });
    return element;
  }

  /** Put every label where its point is seen. */
  place(camera: Camera, width: number, height: number): void {
    if (this.host.hidden) return;
    for (const { element, on, at, half } of this.labels) {
      this.point.copy(at).applyMatrix4(on.matrixWorld).project(camera);
      const x = Math.min(Math.max((0.5 + this.point.x / 2) * width, half), width - half);
      const y = (0.5 - this.point.y / 2) * height;
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
      element.hidden = !isShown(on);
    }
  }
}

/** Whether a thing and all that it belongs to are shown. */
function isShown(thing: Object3D): boolean {
  return thing.visible && (thing.parent === null || isShown(thing.parent));
}
