// When a text is read: after a pause, and only the newest one counts.

export const PAUSE = 500; // milliseconds
export const PATIENCE = 3000; // of a run, with a text that is not read yet
const LOOK = 25; // between two looks for an answer

export class Asking {
  /** `ask` sends a text to be read; `timers` are the browser's own, except in tests. */
  constructor(ask, timers = globalThis) {
    this.ask = ask;
    this.timers = timers;
    this.text = "";
    this.asked = "";
    this.timer = null;
  }

  /** The text as it is now; returns true where it differs from what was typed before. */
  typed(text) {
    if (text === this.text) return false;
    this.text = text;
    this.timers.clearTimeout(this.timer);
    this.timer = text.trim() && text !== this.asked ? this.timers.setTimeout(() => this.now(), PAUSE) : null;
    return true;
  }

  /** Reads the text at once. */
  now() {
    this.settled();
    this.ask(this.text);
  }

  /** Reads the text at once and waits, no longer than PATIENCE, until what `shown` gives answers it. */
  async answered(shown) {
    if (this.timer) this.now();
    for (let waited = 0; this.text.trim() && !this.answers(shown()) && waited < PATIENCE; waited += LOOK) {
      await new Promise((done) => this.timers.setTimeout(done, LOOK));
    }
  }

  /** The text that stands there now needs no reading any more. */
  settled() {
    this.timers.clearTimeout(this.timer);
    this.timer = null;
    this.asked = this.text;
  }

  /** True if an answer is for the text that stands there now. */
  answers(shown) {
    return Boolean(shown) && shown.text === this.text;
  }
}
