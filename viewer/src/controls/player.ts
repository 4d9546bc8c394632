// The clock of the viewer: plays a run in slow motion.

export interface Clock {
  /** s, in the run */
  time: number;
  playing: boolean;
  /** Seconds of the run in a second. */
  speed: number;
  /** Start and end of the repeated interval, s; null: the whole run. */
  loop: [number, number] | null;
}

/** Plays, pauses and jumps; notifies of changes. */
export class Player {
  readonly clock: Clock = { time: 0, playing: false, speed: 0.05, loop: null };
  private length = 0;

  constructor(private readonly changed: () => void) {}

  /** End of the run so far, s; the clock may be beyond it while the run grows. */
  reach(length: number, ended: boolean): void {
    this.length = length;
    if (ended && this.clock.time > length) this.clock.time = length;
  }

  set(change: Partial<Clock>): void {
    Object.assign(this.clock, change);
    this.clock.time = Math.min(Math.max(this.clock.time, 0), this.length);
    this.changed();
  }

  /** Go on by a time on the wall, s. */
  advance(passed: number): void {
    const { clock } = this;
    if (!clock.playing || this.length === 0) return;
    const [from, to] = clock.loop ?? [0, this.length];
    const next = clock.time + clock.speed * Math.min(passed, 0.1);
    clock.time = next > to || next < from ? from + (to > from ? (Math.max(next, from) - from) % (to - from) : 0) : next;
    this.changed();
  }
}

/** Slow enough that a turn of link 1 takes a second and a half. */
export function calmSpeed(speed: number): number {
  const turn = (2 * Math.PI) / Math.max(Math.abs(speed), 1e-3);
  return Math.min(1, Number((turn / 1.5).toPrecision(1)));
}
