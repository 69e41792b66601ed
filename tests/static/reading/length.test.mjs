import assert from "node:assert/strict";
import { test } from "node:test";

import { advice, Length } from "../../../static/reading/length.js";

test("acts that fit need no advice", () => {
  assert.equal(advice(5, 5, 10), null);
  assert.equal(advice(3, 5, 10), null);
});

test("acts that need more than the motion has say how much", () => {
  const found = advice(6.5, 5, 10);
  assert.equal(found.seconds, 6.5);
  assert.match(found.text, /about 6.5 s, and the motion lasts 5 s/);
  assert.doesNotMatch(found.text, /Scene/);
});

test("acts that need more than a motion can have send people to the tab Scene", () => {
  const found = advice(14, 5, 10);
  assert.equal(found.seconds, 10);
  assert.match(found.text, /tab Scene/);
  assert.equal(advice(14, 10, 10).seconds, null, "it can be no longer");
});

/** A field of seconds at 5 of at most 10, and a prompt, both as a page has them. */
function page() {
  const heard = {};
  let hear;
  const input = (target, isTrusted) => hear({ isTrusted, target });
  const number = { value: "5", max: "10", closest: () => true, dispatchEvent: () => input(number, false) };
  const shown = [];
  const tab = { querySelector: () => shown[0] ?? null, addEventListener: (kind, listener) => (hear = listener) };
  const host = { addEventListener() {}, querySelector: () => ({}) };
  const type = (value) => input({ value, closest: () => null, matches: () => true }, true);
  const length = new Length(host, tab, 5);
  length.draw(null);
  shown.push(number); // Gradio puts it there later
  return { length, number, host, type };
}

test("a length that comes after the run of its sentence has begun is only advised", () => {
  const { length, number, host, type } = page();
  type("long");
  length.leave();
  length.draw(7.5, "long");
  assert.equal(number.value, "5");
  assert.equal(host.hidden, false);
  type("longer");
  length.draw(8, "longer");
  assert.equal(number.value, "8", "until something else is typed");
});

test("a typed sentence lengthens the motion, and a shorter one gives the usual length back", () => {
  const { length, number, host, type } = page();
  type("long");
  length.draw(7.5, "long");
  assert.equal(number.value, "7.5");
  assert.equal(host.hidden, true);
  type("endless");
  length.draw(40, "endless");
  assert.equal(number.value, "10");
  assert.equal(host.hidden, false, "it does not fit");
  type("short");
  length.draw(2, "short");
  assert.equal(number.value, "5");
});

test("a length that somebody or an example has set stays", () => {
  const { length, number, host, type } = page();
  length.draw(7, "an example's");
  assert.equal(number.value, "5", "nobody typed it");
  number.value = "3";
  type("long");
  length.draw(7, "long");
  assert.equal(number.value, "3");
  assert.equal(host.hidden, false);
});
