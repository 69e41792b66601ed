// When a text is read: after a pause, and only the newest one counts.

export const PAUSE = 500; // milliseconds

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
