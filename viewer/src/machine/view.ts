// The 3-D view: mechanism, lights and camera.

import {
  DirectionalLight, Group, HemisphereLight, Mesh, type MeshLambertMaterial, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { PARTS } from "../common/colours";
import { Annotations } from "./annotations";
import type { Geometry, Parameters } from "./geometry";
import { Labels } from "./labels";
import { buildMechanism, discard, type Mechanism } from "./mechanism";
import { Palette, type Part } from "./palette";
import { isSoftware, Resolution } from "./resolution";
import { buildShafts, standOff, type Shafts } from "./shafts";
import { Trace, type TraceFrame } from "./trace";

/** Visible items besides the mechanism. */
export interface Shown {
  follow: boolean;
  cut: boolean;
  labels: boolean;
  trace: TraceFrame;
  acceleration: boolean;
  force: boolean;
  torques: boolean;
}

/** Angles (rad), contact mode and signals at one time. */
export interface Instant {
  readonly q: number;
  readonly theta1: number;
  readonly thetaOut: number;
  readonly twist: number;
  /** Locked fraction of each freewheel, 0 to 1. */
  readonly holds: { readonly housing: number; readonly output: number };
  /** Take-up angle remaining of each freewheel, as a fraction of its engagement angle. */
  readonly play: { readonly housing: number; readonly output: number };
  readonly column: (name: string) => number;
  /** Angles of the recent past, part 0 the oldest, 1 now. */
  readonly past: (part: number) => { q: number; theta1: number };
}

/** Directions from which the mechanism can be seen; home depends on the layout. */
export const VIEWS = ["home", "front", "along the shaft", "isometric"] as const;
export type ViewName = (typeof VIEWS)[number];
const DIRECTIONS: Readonly<Record<Exclude<ViewName, "home">, readonly [number, number, number]>> = {
  front: [0, -1, 0.02], "along the shaft": [-1, -0.02, 0.02], isometric: [-1, -1, 0.8],
};
/** Largest elevation of the camera, rad. */
const STEEPEST = 1.5;
/** Pixels per CSS pixel at rest without antialiasing by the graphics card. */
const SUPERSAMPLED = 2;

interface Built {
  readonly mechanism: Mechanism;
  readonly shape: Geometry;
  readonly shafts: Shafts;
  readonly trace: Trace;
  readonly annotations: Annotations;
}

/** A view of the mechanism on a canvas. Nothing is drawn until `draw` is called. */
export class View {
  readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(26, 1, 0.001, 1000);
  private readonly world = new Group();
  private readonly palette = new Palette();
  private readonly labels: Labels;
  private readonly steel = this.palette.materials.steel.color.clone();
  private readonly amber = this.palette.materials.holds.color.clone();
  private built: Built | null = null;
  private shown: Shown | null = null;
  private size = { width: 1, height: 1 };
  /** Pixels per CSS pixel at full resolution. */
  private fullRatio = 1;
  private readonly isSoftware = isSoftware();
  private readonly resolution = new Resolution();
  private readonly raycaster = new Raycaster();

  constructor(canvas: HTMLCanvasElement, labelHost: HTMLElement) {
    // a processor computes four samples per pixel too slowly: there pictures at rest are supersampled instead
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.isSoftware, alpha: true });
    this.renderer.localClippingEnabled = true;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.labels = new Labels(labelHost);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(-0.6, -1, 1.6);
    const fill = new DirectionalLight(0xffffff, 0.7);
    fill.position.set(1.2, -0.6, 0.2);
    this.scene.add(new HemisphereLight(0xffffff, 0x8d95a0, 1.5), sun, fill, this.world);
  }

  /** Build the mechanism again for these parameters; the camera stays unless `look`. */
  build(parameters: Parameters, look: boolean): void {
    if (this.built) {
      for (const thing of [...this.world.children]) discard(thing);
      this.labels.clear();
    }
    const { mechanism, shape } = buildMechanism(parameters, this.palette);
    const shafts = buildShafts(parameters, mechanism, this.palette);
    const trace = new Trace(shape, mechanism);
    const annotations = new Annotations(mechanism, shafts, shape, this.labels);
    mechanism.link1.add(trace.closed);
    this.world.add(mechanism.link1, mechanism.link2, shafts.hub, shafts.driven, shafts.mount, trace.trail, annotations.group);
    // a mechanism of any size fills the view
    this.world.scale.setScalar(1 / mechanism.reach);
    this.built = { mechanism, shape, shafts, trace, annotations };
    if (look) this.look("home");
    if (this.shown) this.show(this.shown);
  }

  /** Move the camera so that it sees the whole mechanism, from one of the directions. */
  look(from: ViewName): void {
    if (!this.built) return;
    const { mechanism, shafts, shape } = this.built;
    const [input, end] = [shafts.stations.input / mechanism.reach, shafts.stations.end / mechanism.reach];
    // planar gears show their faces along the axis
    const home = [shape.layout === "planar" ? -0.75 : -0.42, -1, 0.36] as const;
    const away = new Vector3(...(from === "home" ? home : DIRECTIONS[from])).normalize();
    const right = new Vector3().crossVectors(this.camera.up, away).normalize();
    const up = new Vector3().crossVectors(away, right);
    const corners = [input - 0.15, end + 0.1].flatMap((x) =>
      [[-0.5, -1.2], [0.5, -1.2], [-0.7, 0.7], [0.7, 0.7]].map(([y = 0, z = 0]) => new Vector3(x, y, z)));
    const target = new Vector3();
    for (const axis of [right, up, away]) {
      const along = corners.map((corner) => corner.dot(axis));
      target.addScaledVector(axis, (Math.min(...along) + Math.max(...along)) / 2);
    }
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    const distance = Math.max(...corners.map((point) => {
      const corner = point.clone().sub(target);
      // above and below there is space for rows of names
      const across = Math.max(Math.abs(corner.dot(right)) / this.camera.aspect / 0.97, Math.abs(corner.dot(up)) / 0.84);
      return across / slope + corner.dot(away);
    }));
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(away, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** Turn the camera about the mechanism: to the right and upward, rad. */
  turn(right: number, upward: number): void {
    const from = this.camera.position.clone().sub(this.controls.target);
    const distance = from.length();
    const azimuth = Math.atan2(from.y, from.x) + right;
    const elevation = Math.min(Math.max(Math.asin(from.z / distance) + upward, -STEEPEST), STEEPEST);
    from.set(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation));
    this.camera.position.copy(this.controls.target).addScaledVector(from, distance);
    this.controls.update();
  }

  /** Change the distance of the camera by a factor. */
  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  /** Return the part at a point of the view, or null; coordinates from -1 to 1, to the right and upward. */
  partAt(x: number, y: number): Part | null {
    const { built } = this;
    if (!built) return null;
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
    const { mechanism, shafts } = built;
    const hits = this.raycaster.intersectObjects([mechanism.link1, mechanism.link2, shafts.hub, shafts.driven, shafts.mount], true);
    for (const { object, point } of hits) {
      if (!(object instanceof Mesh)) continue;
      const mesh = object as Mesh;
      if (mesh === shafts.rollers.housing) return "housing";
      if (mesh === shafts.rollers.output) return "output";
      const part = this.palette.partOf(mesh.material);
      if (part && !this.palette.isCutAway(part, point)) return part;
    }
    return null;
  }

  highlight(part: Part | null): void {
    this.palette.highlight(part);
  }

  /** Space for other things over the view at its upper and lower edge, px. */
  setMargins(above: number, below: number): void {
    this.labels.margins = { above, below };
  }

  /** Remarks on the picture. */
  get remarks(): readonly string[] {
    return this.built?.mechanism.remarks ?? [];
  }

  /** Pixels per CSS pixel of the last picture. */
  get pixelRatio(): number {
    return this.renderer.getPixelRatio();
  }

  /** Return true while frames are slow. */
  get isSlow(): boolean {
    return this.resolution.isLow;
  }

  show(shown: Shown): void {
    this.shown = { ...shown };
    this.labels.visible = shown.labels;
    // the quarter in front of and above the central axis is cut away
    this.palette.cut(shown.cut ? [new Plane(new Vector3(0, 1, 0), 0), new Plane(new Vector3(0, 0, -1), 0)] : null);
    this.built?.trace.show(shown.trace);
    this.built?.annotations.show(shown);
  }

  /** Values of the longest arrows: m/s2, N, N.m. */
  scale(acceleration: number, force: number, torque: number): void {
    this.built?.annotations.scale(acceleration, force, torque);
  }

  resize(width: number, height: number, ratio: number): void {
    this.size = { width, height };
    this.fullRatio = ratio;
    this.labels.resize();
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Draw the mechanism at one time, and move its names if `isDue`. */
  draw(now: Instant, isMoving: boolean, isDue: boolean): void {
    const { built, shown } = this;
    if (!built || !shown) return;
    const { mechanism, shafts, trace, annotations } = built;
    this.world.rotation.x = shown.follow ? -now.theta1 : 0;
    mechanism.turn(now.q);
    mechanism.link1.rotation.x = now.theta1;
    mechanism.link2.rotation.x += now.theta1;
    shafts.hub.rotation.x = now.thetaOut + now.twist;
    shafts.driven.rotation.x = now.thetaOut;
    shafts.marks.forEach((mark, n) => {
      mark.rotation.x = now.thetaOut + now.twist * (1 - n / shafts.marks.length);
    });
    for (const name of ["housing", "output"] as const) {
      this.tint(shafts.rollers[name].material, now.holds[name]);
      standOff(shafts.rollers[name], now.play[name]);
    }
    trace.follow(now.past);
    annotations.place(now, isDue);
    const fraction = this.resolution.at(performance.now() / 1000, isMoving);
    const ratio = this.isSoftware && !isMoving ? Math.max(this.fullRatio, SUPERSAMPLED) : this.fullRatio * fraction;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.renderer.render(this.scene, this.camera);
    if (isDue) this.labels.place(this.camera, this.size.width, this.size.height);
  }

  /** Position of the reference mass (planet 0, module 0) and start of its arrow, m in the fixed frame. */
  imbalance(): { drawn: number[]; arrow: number[] } | null {
    const { built } = this;
    if (!built) return null;
    this.world.updateMatrixWorld(true);
    const place = built.mechanism.imbalance.localToWorld(built.mechanism.imbalanceAt.clone());
    return { drawn: this.world.worldToLocal(place).toArray(), arrow: built.annotations.imbalance.toArray() };
  }

  private tint(material: MeshLambertMaterial, part: number): void {
    material.color.lerpColors(this.steel, this.amber, part);
    material.emissive.set(PARTS.holds).multiplyScalar(0.35 * part);
  }
}
