// The time of a player: its clock, and the hurry of a stream that lags.

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

const ARRIVALS = 1000; // milliseconds of arrivals that are looked at
const SPARE = 0.75; // frames in hand that may be left when new ones come
const CATCH_UP = 0.08; // of the speed, for every frame too many
const FASTEST = 1.3;

export class Pace {
  constructor() {
    this.arrivals = []; // [milliseconds, frames in hand just before]
  }

  /**
   * Takes an arrival: at `now` milliseconds there were `inHand` frames that had not been shown yet. Returns by how much
   * faster than their own speed frames are to be shown until the next one.
   */
  add(now, inHand) {
    this.arrivals.push([now, inHand]);
    while (this.arrivals[0][0] < now - ARRIVALS) this.arrivals.shift();
    if (now - this.arrivals[0][0] < ARRIVALS / 2) return 1; // too few to tell
    const spare = Math.min(...this.arrivals.map(([, left]) => left)) - SPARE;
    return spare > 0 ? Math.min(FASTEST, 1 + CATCH_UP * (1 + spare)) : 1;
  }

  /** Forgets what was in hand, after a jump. */
  begin() {
    this.arrivals = [];
  }
}
