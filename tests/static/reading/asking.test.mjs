// A text is read after a pause, and only the newest one counts.

import assert from "node:assert/strict";
import test from "node:test";

import { Asking, PAUSE } from "../../../static/reading/asking.js";

/** A clock that is moved by hand. */
class Timers {
  now = 0;
  waiting = new Map();
  last = 0;
  setTimeout(job, after) {
    this.waiting.set(++this.last, { job, at: this.now + after });
    return this.last;
  }
  clearTimeout(which) {
    this.waiting.delete(which);
  }
  pass(milliseconds) {
    this.now += milliseconds;
    for (const [which, { job, at }] of [...this.waiting]) {
      if (at > this.now) continue;
      this.waiting.delete(which);
      job();
    }
  }
}

function asking() {
  const asked = [];
  const timers = new Timers();
  return { asked, timers, it: new Asking((text) => asked.push(text), timers) };
}

test("only what stands after a pause is asked for", () => {
  const { asked, timers, it } = asking();
  for (const text of ["T", "Th", "They hug."]) {
    it.typed(text);
    timers.pass(PAUSE - 1);
  }
  assert.deepEqual(asked, []);
  timers.pass(1);
  assert.deepEqual(asked, ["They hug."]);
});

test("an empty text, and the one that was asked for, are not asked for", () => {
  const { asked, timers, it } = asking();
  it.typed("They hug.");
  timers.pass(PAUSE);
  it.typed("  ");
  timers.pass(PAUSE);
  it.typed("They hug.");
  timers.pass(PAUSE);
  assert.deepEqual(asked, ["They hug."]);
});

test("an answer for an older text does not count", () => {
  const { timers, it } = asking();
  it.typed("They hug.");
  timers.pass(PAUSE);
  it.typed("They bow.");
  assert.equal(it.answers({ text: "They hug." }), false);
  assert.equal(it.answers({ text: "They bow." }), true);
  assert.equal(it.answers(null), false);
});

test("a text that is set once more is not new", () => {
  const { it } = asking();
  assert.equal(it.typed("They hug."), true);
  assert.equal(it.typed("They hug."), false);
});

test("a run has its text read at once, and waits for the answer", async () => {
  const asked = [];
  const it = new Asking((text) => asked.push(text));
  let shown = null;
  it.typed("They hug.");
  const waiting = it.answered(() => shown).then(() => shown?.text);
  assert.deepEqual(asked, ["They hug."]);
  setTimeout(() => (shown = { text: "They hug." }), 60);
  assert.equal(await waiting, "They hug.");
  it.typed("");
  await it.answered(() => shown);
  assert.deepEqual(asked, ["They hug."]);
});
