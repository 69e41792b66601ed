// Time-based playback: what frame it is depends on the wall clock, never on how often we draw.

const LONGEST_STEP = 0.5; // seconds; a stalled tab goes on from where it stood

export class Clock {
  constructor() {
    Object.assign(this, { frames: 1, fps: 30, speed: 1, hurry: 1, loop: true, playing: false, frame: 0, last: null, limit: null });
  }

  load({ frames, fps }) {
    this.frames = frames;
    this.fps = fps;
    this.limit = null;
    this.hurry = 1; // by how much a stream is played faster than it comes
    this.seek(this.frame);
  }

  get seconds() {
    return this.frame / this.fps;
  }

  get duration() {
    return this.frames / this.fps;
  }

  play() {
    if (this.frame >= this.frames - 1) this.frame = 0;
    this.playing = this.frames > 1;
    this.last = null;
  }

  pause() {
    this.playing = false;
  }

  seek(frame) {
    this.frame = Math.min(Math.max(frame, 0), this.limit ?? this.frames - 1);
    this.last = null;
  }

  /** Moves on to `now` (ms). Without loop, stops on the last frame; waits at `limit`, where there is no more yet. */
  advance(now) {
    if (!this.playing) return;
    const step = this.last === null ? 0 : Math.min((now - this.last) / 1000, LONGEST_STEP);
    this.last = now;
    const next = this.frame + step * this.speed * this.hurry * this.fps;
    if (this.limit !== null) this.frame = Math.min(next, this.limit);
    else if (next < this.frames - 1) this.frame = next;
    else if (this.loop) this.frame = next % this.frames; // [frames - 1, frames) holds the last frame
    else {
      this.frame = this.frames - 1;
      this.playing = false;
    }
  }

  /** The frame to show: the clock may stand between the last frame and the wrap to the first. */
  get shown() {
    return Math.min(this.frame, this.frames - 1);
  }
}
