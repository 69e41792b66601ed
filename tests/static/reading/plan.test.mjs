// Edits of a plan by hand.

import assert from "node:assert/strict";
import test from "node:test";

import * as edits from "../../../static/reading/plan.js";

const act = (id, agents, more = {}) => ({ id, act: `act-${id}`, agents, patient: null, order: [], words: null, ...more });
const draft = (beats, acts, more = {}) => ({ plan: { sentence: "", acts, unread: [], reader: "lexicon", ...more }, beats });
const PUSH = { name: "push", said: "pushes", patient: true, mutual: false };
const HUG = { name: "hug", said: "hugs", patient: true, mutual: true };

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
  for (const one of [edits.remove(START, "1"), edits.remove(START, "3"), edits.hand(START, "1")]) {
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

test("the other person does it, to the first one", () => {
  const [first] = edits.hand(draft([["1"]], [act("1", ["a"], { patient: "b", part_of: "b" })]), "1").plan.acts;
  assert.deepEqual([first.agents, first.patient, first.part_of], [["b"], "a", "a"]);
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
  const push = edits.understand(said, 1, PUSH);
  assert.deepEqual([push.beats.at(-1), push.plan.acts.at(-1).agents, push.plan.acts.at(-1).patient], [["3"], ["a"], "b"]);
});
