// Positions of the unbalanced masses by the formulas of docs/explanation/mechanics.md.
//
// Lengths in m, angles in rad. Frame of link 1: x along the central axis, z along the axis of pinion 16 of module 0.

export type Parameters = Readonly<Record<string, number>>;
export type Vector = readonly [number, number, number];

/** Lengths and angles of a bevel module. `slant` is L, `apex` OQ, `axis` QA and `arm` AD. */
export interface Bevel {
  readonly layout: "bevel";
  readonly s: number;
  readonly k: number;
  readonly sigma: number;
  readonly phi: number;
  readonly psi: number;
  readonly slant: number;
  readonly apex: number;
  readonly axis: number;
  readonly arm: number;
  readonly gamma: number;
  readonly epsilon: number;
  readonly teeth: { readonly z2: number; readonly z16: number; readonly z17: number; readonly z6: number };
  readonly modules: number;
  readonly satellites: number;
}

/** Lengths of a planar module: R0, r and l. */
export interface Planar {
  readonly layout: "planar";
  readonly k: number;
  readonly sun: number;
  readonly satellite: number;
  readonly arm: number;
  readonly modules: number;
  readonly satellites: number;
}

export type Geometry = Bevel | Planar;

/** A value by its name; an unknown name is an internal error. */
export function value(parameters: Parameters, name: string): number {
  const found = parameters[name];
  if (found === undefined) throw new Error(`there is no parameter ${name}`);
  return found;
}

/** The geometry that follows from the parameters of the module. */
export function geometry(parameters: Parameters): Geometry {
  const of = (name: string): number => value(parameters, name);
  const count = { modules: of("modules"), satellites: of("satellites") };
  if (of("layout") === 1) {
    const sun = of("sun_radius");
    const satellite = of("satellite_radius");
    return { layout: "planar", k: sun / satellite, sun, satellite, arm: of("eccentricity"), ...count };
  }
  const teeth = { z2: of("z2"), z16: of("z16"), z17: of("z17"), z6: of("z6") };
  const s = teeth.z17 / teeth.z6;
  const sigma = of("shaft_angle");
  const phi = Math.atan2(Math.sin(sigma), s + Math.cos(sigma));
  const psi = sigma - phi;
  const slant = of("wheel_radius") / Math.sin(psi);
  return {
    layout: "bevel", s, k: teeth.z2 / teeth.z16, sigma, phi, psi, slant,
    apex: of("c") * slant * Math.cos(psi),
    axis: of("b") * slant * Math.cos(phi),
    arm: of("a") * slant * Math.sin(phi),
    gamma: of("gamma"), epsilon: of("epsilon"), teeth, ...count,
  };
}

/** A vector turned by an angle about the central axis Ox. */
export function aboutAxis([x, y, z]: Vector, angle: number): Vector {
  const sine = Math.sin(angle);
  const cosine = Math.cos(angle);
  return [x, y * cosine - z * sine, y * sine + z * cosine];
}

/** Unbalanced mass of a planet of module 0 at the pinion-shaft angle q, in the frame of link 1. */
export function imbalance(shape: Geometry, q: number, satellite = 0): Vector {
  const turned = (2 * Math.PI * satellite) / shape.satellites;
  if (shape.layout === "planar") {
    const distance = shape.sun + shape.satellite;
    return aboutAxis([0, shape.arm * Math.sin(q), distance - shape.arm * Math.cos(q)], turned);
  }
  const angleA = q + shape.gamma + turned;
  const angleB = shape.s * q + shape.epsilon;
  const sine = Math.sin(shape.sigma);
  const cosine = Math.cos(shape.sigma);
  const radial = shape.axis * sine - shape.arm * cosine * Math.cos(angleB);
  const tangential = -shape.arm * Math.sin(angleB);
  return [
    radial * Math.cos(angleA) - tangential * Math.sin(angleA),
    radial * Math.sin(angleA) + tangential * Math.cos(angleA),
    shape.apex - shape.axis * cosine - shape.arm * sine * Math.cos(angleB),
  ];
}

function commonDivisor(first: number, second: number): number {
  return second === 0 ? first : commonDivisor(second, first % second);
}

/** Pinion-shaft angle after which the motion repeats, rad. */
export function period(shape: Geometry): number {
  if (shape.layout === "planar") return 2 * Math.PI;
  const { z17, z6 } = shape.teeth;
  return (2 * Math.PI * z6) / commonDivisor(z17, z6);
}
