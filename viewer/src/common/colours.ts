// Colours of parts and curves, apart for the colour-blind (after Okabe and Ito).

/** Of curves: 3 : 1 at least on white and on the dark paper. */
export const CURVES = {
  blue: "#3a86c8",
  green: "#229a6f",
  purple: "#b565a0",
  orange: "#c77f12",
  red: "#d0532b",
  grey: "#858d96",
} as const;

/** Colours of the parts and of the annotations; a part and its curve have the same colour. */
export const PARTS = {
  link1: "#3f7fb5",
  drive: "#7fb2d6",
  satellite: "#d3a04a",
  imbalance: "#c8501e",
  link2: "#2f9c78",
  output: "#b0729a",
  steel: "#9aa2ab",
  housing: "#7d858e",
  holds: "#f2a900",
  force: "#8a5cc2",
  trace: "#cc1f1a",
} as const;
