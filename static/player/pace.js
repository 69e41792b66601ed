// How fast a stream is played: a little faster than it comes while more is in hand than its arrivals need.

const WINDOW = 1000; // milliseconds of arrivals that are looked at
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
    while (this.arrivals[0][0] < now - WINDOW) this.arrivals.shift();
    if (now - this.arrivals[0][0] < WINDOW / 2) return 1; // too few to tell
    const spare = Math.min(...this.arrivals.map(([, left]) => left)) - SPARE;
    return spare > 0 ? Math.min(FASTEST, 1 + CATCH_UP * (1 + spare)) : 1;
  }

  /** Forgets what was in hand, after a jump. */
  begin() {
    this.arrivals = [];
  }
}
