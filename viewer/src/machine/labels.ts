// Labels of the parts over the view.

import { Vector3, type Camera, type Object3D } from "three";

interface Label {
  readonly element: HTMLElement;
  readonly on: Object3D;
  readonly at: Vector3;
}

/** Labels follow points of objects. */
export class Labels {
  private labels: Label[] = [];
  private readonly point = new Vector3();

  constructor(private readonly host: HTMLElement) {
    // screen readers find the names in the table of values
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
    this.labels.push({ element, on, at });
    return element;
  }

  /** Move each label to the projection of its point, fully inside the view. */
  place(camera: Camera, width: number, height: number): void {
    if (this.host.hidden) return;
    for (const { element, on, at } of this.labels) {
      this.point.copy(at).applyMatrix4(on.matrixWorld).project(camera);
      const x = `${((0.5 + this.point.x / 2) * width).toFixed(1)}px`;
      const y = `${((0.5 - this.point.y / 2) * height).toFixed(1)}px`;
      // 50 % and 100 % are of the label itself: half its width, its height
      element.style.transform = `translate(clamp(50%, ${x}, ${width}px - 50%), clamp(100%, ${y}, ${height}px)) translate(-50%, -100%)`;
      element.hidden = !isShown(on);
    }
  }
}

/** Return true if an object and all its parents are visible. */
function isShown(thing: Object3D): boolean {
  return thing.visible && (thing.parent === null || isShown(thing.parent));
}
