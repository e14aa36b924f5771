// The clock of a replay.

/** Less than this before the end, Play begins anew [s]. */
const kAtEnd = 1e-6;
/** Greatest step of the clock in one frame [s]: after the window was hidden the replay continues where it was. */
const kLongest = 0.1;

export class Playback {
  time = 0;
  /** Seconds of the motion per second. */
  rate = 1;
  private running = false;
  private frame = 0;
  private before: number | null = null;   // time of the last frame

  /** `end` gives the motion's length [s]; `show` is called after each change of the time, `told` after Play and Pause. */
  constructor(readonly end: () => number, private readonly show: () => void, private readonly told: (running: boolean) => void) {}

  seek(t: number): void {
    this.time = Math.min(Math.max(0, t), this.end());
    this.show();
  }

  start(): void {
    if (this.running) return;
    if (this.time >= this.end() - kAtEnd) this.time = 0;
    this.before = null;
    this.set(true);
    this.frame = requestAnimationFrame(this.tick);
  }

  pause(): void {
    cancelAnimationFrame(this.frame);
    this.set(false);
  }

  toggle(): void {
    if (this.running) this.pause();
    else this.start();
  }

  private set(running: boolean): void {
    this.running = running;
    this.told(running);
  }

  private readonly tick = (now: number): void => {
    if (!this.running) return;
    // A frame's time is that of its begin, which may lie before start().
    if (this.before !== null) this.time += Math.min(kLongest, Math.max(0, now - this.before) / 1000) * this.rate;
    this.before = now;
    if (this.time >= this.end()) {
      this.time = this.end();
      this.pause();
    }
    this.show();
    if (this.running) this.frame = requestAnimationFrame(this.tick);
  };
}
