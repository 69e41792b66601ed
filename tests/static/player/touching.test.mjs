// A touch that is said by pressing a part of a body.

import assert from "node:assert/strict";
import test from "node:test";

import { PARTS, touchOf, withSentence } from "../../../static/player/touching.js";

test("the other person touches the part that is pressed", () => {
  assert.equal(touchOf("a", "knee"), "Person B touches person A's knee.");
  assert.equal(touchOf("b", "shoulder"), "Person A touches person B's shoulder.");
  assert.equal(new Set(PARTS.map(([joint]) => joint)).size, PARTS.length);
});

test("a sentence more begins a sentence of its own", () => {
  assert.equal(withSentence("", "They hug."), "They hug.");
  assert.equal(withSentence("A bows ", "They hug."), "A bows. They hug.");
  assert.equal(withSentence("Do they bow?", "They hug."), "Do they bow? They hug.");
});
