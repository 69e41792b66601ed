// What was changed in a story since the server last gave one, kept over a reload of the page in the same browser tab.

import * as edits from "./edits.js";

const KEY = "pas-de-deux-story";

export class Draft {
  constructor(store = window.sessionStorage) {
    this.store = store;
    this.base = edits.wordsOf(null);
    this.fresh = true; // nothing was changed since the page was opened
  }

  /** The user changed the story. */
  keep(story) {
    this.fresh = false;
    this.write(JSON.stringify({ base: this.base, story }));
  }

  /** The server gave a story: returns what it had been changed to before a reload, or null. */
  given(story) {
    this.base = edits.wordsOf(story);
    const kept = this.fresh ? this.read() : null;
    if (kept?.base === this.base) return edits.read(kept.story);
    if (story?.beats?.length) this.write(null);
    return null;
  }

  read() {
    try {
      return JSON.parse(this.store.getItem(KEY));
    } catch {
      return null; // a browser without storage, or what another version wrote
    }
  }

  write(text) {
    try {
      if (text === null) this.store.removeItem(KEY);
      else this.store.setItem(KEY, text);
    } catch {
      // Without storage, or where it is full, a reload loses what was not made.
    }
  }
}
