import assert from "node:assert/strict";
import { test } from "node:test";

import { advice } from "../../../static/reading/length.js";

test("acts that fit need no advice", () => {
  assert.equal(advice(5, 5, 10), null);
  assert.equal(advice(3, 5, 10), null);
  assert.equal(advice(12, 10, 10), null);
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
});
