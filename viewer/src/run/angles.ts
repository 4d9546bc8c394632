// Angles with their whole turns.

const ANGLES = {
  q: ["drive_angle", "drive_turns"],
  theta1: ["input_angle", "input_turns"],
  theta_out: ["output_angle", "output_turns"],
} as const;

/** Columns with the angles of the drives (q), of link 1 and of the output shaft besides, turns and all, rad. */
export function withAngles(columns: Record<string, Float64Array>): Record<string, Float64Array> {
  const added: Record<string, Float64Array> = {};
  for (const [name, [rest, turns]] of Object.entries(ANGLES)) {
    const [angles, whole] = [columns[rest], columns[turns]];
    if (angles && whole) added[name] = angles.map((angle, n) => angle + 2 * Math.PI * (whole[n] ?? NaN));
  }
  return { ...columns, ...added };
}
