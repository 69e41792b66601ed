// Changes that were not made yet outlive a reload.

import assert from "node:assert/strict";
import test from "node:test";

import { Draft } from "../../../static/story/draft.js";

const MADE = { beats: [{ words: "They wave.", a: null, b: "", seconds: 2 }] };
const CHANGED = { ...MADE, poses: [{ person: "a", seconds: 1, positions: [] }] };
const OTHER = { beats: [{ words: "They bow.", a: "", b: "" }] };

/** The session storage of a browser's tab, as far as a draft uses it. */
class Store extends Map {
  getItem(key) {
    return this.get(key) ?? null;
  }
  setItem(key, value) {
    this.set(key, value);
  }
  removeItem(key) {
    this.delete(key);
  }
}

/** What is given back when a changed story is followed by a reload and by `after` from the server. */
function reloaded(after) {
  const store = new Store();
  const draft = new Draft(store);
  draft.given(null);
  draft.given(MADE);
  draft.keep(CHANGED);
  const fresh = new Draft(store);
  fresh.given(null);
  return [fresh.given(after)?.poses.length ?? null, store.size];
}

test("changes that were not made outlive a reload with their story", () => {
  assert.deepEqual(reloaded(MADE), [1, 1]);
  assert.deepEqual(reloaded(OTHER), [null, 0]);
});

test("what was made is no draft", () => {
  const store = new Store();
  const draft = new Draft(store);
  draft.keep(OTHER);
  draft.given(OTHER);
  assert.equal(store.size, 0);
  assert.equal(new Draft(store).given(OTHER), null);
});

test("a browser without storage keeps nothing and says nothing", () => {
  const none = () => {
    throw new Error("refused");
  };
  const draft = new Draft({ getItem: none, setItem: none, removeItem: none });
  draft.keep(OTHER);
  assert.equal(draft.given(OTHER), null);
});
