// Which words of a sentence are whose.

import assert from "node:assert/strict";
import test from "node:test";

import { offers, people, pieces, spoken, summary, wordsOf } from "../../../static/reading/marks.js";

const act = (id, agents, start, stop, more = {}) => ({ id, agents, words: start === null ? null : { start, stop }, ...more });
const lost = (start, stop) => ({ words: { start, stop }, why: "No act is known.", nearest: [] });

test("a sentence is cut where its marks begin and end, and nothing of it is lost", () => {
  const said = "A waves and B bows.";
  const found = pieces(said, [act("1", ["a"], 0, 7), act("2", ["b"], 12, 18)], []);
  assert.equal(found.map((piece) => piece.text).join(""), said);
  assert.deepEqual(found.map((piece) => [piece.text, piece.who]), [
    ["A waves", "a"], [" and ", ""], ["B bows", "b"], [".", ""],
  ]);
});

test("words of both people have both, together or from two acts that overlap", () => {
  assert.deepEqual(pieces("They hug.", [act("1", ["b", "a"], 0, 8)], []).map((piece) => piece.who), ["ab", ""]);
  const found = pieces("abcdef", [act("1", ["a"], 0, 4), act("2", ["b"], 2, 6)], []);
  assert.deepEqual(found.map((piece) => [piece.text, piece.who, piece.acts]), [
    ["ab", "a", ["1"]], ["cd", "ab", ["1", "2"]], ["ef", "b", ["2"]],
  ]);
});

test("what was not understood keeps its number, also inside of what was", () => {
  const found = pieces("She bows and flumps", [act("1", ["a"], 0, 19)], [lost(0, 0), lost(13, 19)]);
  assert.deepEqual(found.map((piece) => [piece.text, piece.unread]), [["She bows and ", -1], ["flumps", 1]]);
});

test("an act inside of what was not understood is understood", () => {
  const found = pieces("flumps as they hug", [act("1", ["a", "b"], 10, 18)], [lost(0, 18)]);
  assert.deepEqual(found.map((piece) => [piece.text, piece.unread]), [["flumps as ", 0], ["they hug", -1]]);
});

test("a long part is quoted by its beginning", () => {
  assert.equal(wordsOf("x".repeat(80), { start: 0, stop: 80 }), `${"x".repeat(59)}…`);
});

test("a character outside of the basic plane counts as one, as the server counts it", () => {
  const said = "😀 A waves";
  assert.equal(pieces(said, [act("1", ["a"], 2, 9)], [])[1].text, "A waves");
  assert.equal(wordsOf(said, { start: 2, stop: 9 }), "A waves");
});

test("spans behind the end, of an act without words, or of another sentence break nothing", () => {
  const found = pieces("They hug.", [act("1", ["a"], 5, 500), act("2", ["b"], null), act("3", ["b"], 90, 99)], []);
  assert.equal(found.map((piece) => piece.text).join(""), "They hug.");
  assert.deepEqual(found.map((piece) => piece.who), ["", "a"]);
  assert.deepEqual(pieces("", [], []), []);
});

test("people of a chip, for the eye and for the ear", () => {
  const pat = act("1", ["a"], 0, 1, { patient: "b" });
  assert.deepEqual([people(pat), spoken(pat, "pats on right shoulder ×2")], [
    "A → B", "A to B: pats on right shoulder, 2 times",
  ]);
  const hug = act("1", ["a", "b"], 0, 1, { patient: null });
  assert.deepEqual([people(hug), spoken(hug, "hug")], ["A + B", "A and B: hug"]);
});

test("how much was understood", () => {
  assert.equal(summary({ acts: [1], unread: [] }), "Acts understood: 1.");
  assert.equal(summary({ acts: [1, 2], unread: [1] }), "Acts understood: 2. Not understood: 1.");
});

test("acts that are said alike are offered once, and an unknown one never", () => {
  const known = { hug: { said: "hugs" }, embrace: { said: "hugs" }, wave: { said: "waves" } };
  assert.deepEqual(offers(["hug", "embrace", "gone", "wave"], known), ["hug", "wave"]);
});
