// How many pictures a second are drawn.

const WINDOW = 1500; // milliseconds that are looked back on

export class Rate {
  constructor() {
    this.times = []; // milliseconds
  }

  /** Takes a picture that was drawn at `now` milliseconds. */
  count(now) {
    this.times.push(now);
    while (now - this.times[0] > WINDOW) this.times.shift();
  }

  /** Pictures a second over the last second and a half. */
  get value() {
    const span = this.times[this.times.length - 1] - this.times[0];
    return span > 0 ? (1000 * (this.times.length - 1)) / span : 0;
  }
}
