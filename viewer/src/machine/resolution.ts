// Resolution of the picture: full at rest, lower while the frames of a motion are slow.

/** Fractions of the full resolution, from fast to slow machines. */
const FRACTIONS = [1, 0.7, 0.5] as const;
/** Mean times between frames for a lower and a higher resolution, s. */
const SLOW = 1 / 20;
const FAST = 1 / 45;
/** Numbers of frames over which the time is averaged before the resolution falls or rises. */
const FALL = 4;
const RISE = 90;
/** A longer gap between frames is a pause, s. */
const PAUSE = 2;

/** Chooses the resolution from the times between frames. */
export class Resolution {
  private place = 0;
  private frames = 0;
  private sum = 0;
  private last = -Infinity;

  /** Account for a frame and return its fraction of the full resolution.
   *  @param now time of the frame, s
   *  @param isMoving true while the animation plays or the camera moves */
  at(now: number, isMoving: boolean): number {
    if (!isMoving) {
      this.last = -Infinity;
      return 1;
    }
    const passed = now - this.last;
    this.last = now;
    if (passed < PAUSE) {
      this.frames += 1;
      this.sum += passed;
      const mean = this.sum / this.frames;
      if (this.frames >= FALL && mean > SLOW) this.move(1);
      else if (this.frames >= RISE) this.move(mean < FAST ? -1 : 0);
    }
    return FRACTIONS[this.place] ?? 1;
  }

  /** Return true while the resolution is below the full one. */
  get isLow(): boolean {
    return this.place > 0;
  }

  private move(by: number): void {
    this.place = Math.min(Math.max(this.place + by, 0), FRACTIONS.length - 1);
    this.frames = 0;
    this.sum = 0;
  }
}

/** Return true if the browser computes 3-D pictures on the processor: on remote desktops and virtual machines. */
export function isSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
