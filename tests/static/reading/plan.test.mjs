// Edits of a plan by hand.

import assert from "node:assert/strict";
import test from "node:test";

import * as edits from "../../../static/reading/plan.js";

const act = (id, agents, more = {}) => ({ id, act: `act-${id}`, agents, patient: null, order: [], words: null, ...more });
const draft = (beats, acts, more = {}) => ({ plan: { sentence: "", acts, unread: [], reader: "lexicon", ...more }, beats });
const PUSH = { name: "push", said: "pushes", caption: "{a} [push] {b}", patient: true, mutual: false };
const BOW = { name: "bow", said: "bows", caption: "{a} [bow]", patient: false, mutual: false };
const HUG = { name: "hug", said: "hugs", caption: "{a} [hug] {b}", patient: true, mutual: true };

/** The beats that the relations of a plan give, as the server works them out. */
function beatsOf({ plan }) {
  const level = Object.fromEntries(plan.acts.map(({ id }) => [id, 0]));
  for (const _ of plan.acts) {
    for (const { id, order } of plan.acts) {
      for (const { kind, act: other } of order) {
        level[id] = Math.max(level[id], level[other] + (kind === "after"));
        if (kind !== "after") level[other] = Math.max(level[other], level[id]);
      }
    }
  }
  const found = [];
  for (const { id } of plan.acts) (found[level[id]] ??= []).push(id);
  return found;
}

const START = draft([["1", "2"], ["3"]], [
  act("1", ["a"], { patient: "b" }), act("2", ["b"], { order: [{ kind: "while", act: "1" }] }),
  act("3", ["b"], { order: [{ kind: "after", act: "1" }] }),
]);

test("every edit leaves a plan whose relations say what its beats say", () => {
  const some = [
    edits.remove(START, "1"), edits.remove(START, "3"), edits.change(START, "2", PUSH), edits.hand(START, "1"),
    edits.shift(START, "2", -1), edits.shift(START, "2", 1), edits.shift(START, "3", -1),
    edits.add(START, BOW, ["a"]), edits.add(START, BOW, ["a", "b"], "1"),
  ];
  for (const one of some) {
    assert.deepEqual(beatsOf(one), one.beats);
    assert.deepEqual(one.plan.acts.map(({ id }) => id), one.beats.flat());
    assert.equal(one.plan.reader, "hand");
  }
  assert.deepEqual(START.plan.acts[1].order, [{ kind: "while", act: "1" }], "the draft itself stays");
});

test("an act is taken out with its relations", () => {
  assert.deepEqual(edits.remove(START, "1").beats, [["2"], ["3"]]);
  assert.deepEqual(edits.remove(edits.remove(edits.remove(START, "1"), "2"), "3").plan.acts, []);
});

test("an act becomes another one by the same people; its details go", () => {
  const fields = { patient: "b", part: "back", side: "left", times: 2, words: { start: 0, stop: 4 } };
  const one = draft([["1"]], [act("1", ["a"], fields)]);
  const [bow] = edits.change(one, "1", BOW).plan.acts;
  assert.deepEqual([bow.act, bow.patient, bow.part, bow.side, bow.times, bow.words.stop], [
    "bow", null, undefined, undefined, 2, 4,
  ]);
  assert.equal(edits.change(edits.change(one, "1", BOW), "1", PUSH).plan.acts[0].patient, "b");
});

test("the other person does it, to the first one", () => {
  const [first] = edits.hand(draft([["1"]], [act("1", ["a"], { patient: "b", part_of: "b" })]), "1").plan.acts;
  assert.deepEqual([first.agents, first.patient, first.part_of], [["b"], "a", "a"]);
});

test("an act goes out of its beat, into the next one of the other person, and past one of its own", () => {
  const out = edits.shift(START, "2", 1);
  assert.deepEqual(out.beats, [["1"], ["2"], ["3"]]);
  assert.deepEqual(edits.shift(out, "2", -1).beats, [["1", "2"], ["3"]]);
  assert.deepEqual(edits.shift(out, "2", 1).beats, [["1"], ["3"], ["2"]]);
  assert.deepEqual(edits.shift(out, "1", -1).beats, out.beats, "nothing is before the first");
});

test("a new act has a name of its own, and its place", () => {
  const odd = draft([["2"], ["3"]], [act("2", ["a"]), act("3", ["b"])]);
  const more = edits.add(odd, PUSH, ["b"], "2");
  assert.deepEqual(more.beats, [["2"], ["4"], ["3"]].map((beat) => beat));
  const [, push] = more.plan.acts;
  assert.deepEqual([push.agents, push.patient], [["b"], "a"]);
  assert.deepEqual(edits.add(odd, HUG, ["a", "b"]).plan.acts.at(-1).patient, null);
});

test("an act that is put in for words stands where they stand", () => {
  const words = (start, stop) => ({ words: { start, stop } });
  const said = draft([["1"], ["2"]], [act("1", ["a"], words(0, 5)), act("2", ["b"], words(20, 25))], {
    unread: [{ ...words(8, 15), why: "", nearest: ["hug"] }, { ...words(30, 35), why: "", nearest: [] }],
  });
  const found = edits.understand(said, 0, HUG);
  assert.deepEqual(found.beats, [["1"], ["3"], ["2"]]);
  assert.deepEqual([found.plan.acts[1].agents, found.plan.acts[1].words], [["a", "b"], { start: 8, stop: 15 }]);
  assert.deepEqual(found.plan.unread.map(({ words: { start } }) => start), [30]);
});

test("acts are found by name and caption, those that begin so first", () => {
  const entries = [HUG, { ...BOW, caption: "{a} [bow] and hug" }, PUSH];
  assert.deepEqual(edits.search(entries, "hug").map(({ name }) => name), ["hug", "bow"]);
  assert.deepEqual(edits.search(entries, " PUSH  es ").map(({ name }) => name), ["push"]);
  assert.deepEqual(edits.search(entries, "zz"), []);
  assert.equal(edits.search(entries, "").length, 3);
  assert.equal(edits.search(entries, "", 2).length, 2);
});
