// Poses stay with their beats while these move.

import assert from "node:assert/strict";
import test from "node:test";

import * as edits from "../../../static/story/edits.js";

const STORY = {
  beats: [2, 3, 4].map((s) => ({ words: String(s), a: "", b: "", seconds: s, auto: s })),
  poses: [0.5, 3, 8, 9.5].map((seconds) => ({ person: "a", seconds, positions: [] })),
  paths: [], loop: false, span: null,
};
const CASES = [
  [[["stretch", 0, 3]], [0.5, 4, 9, 10.5]],
  [[["stretch", 0, 3], ["stretch", 0, 2]], [0.5, 3, 8, 9.5]],
  [[["stretch", 1, 0.5]], [0.5, 2.4667, 5.5, 7]], // the pose comes to the end of its beat
  [[["move", 0, 1]], [1, 3.5, 8, 9.5]],
  [[["add", 0]], [0.5, 7, 12, 13.5]],
  [[["remove", 1]], [0.5, 5, 6.5]],
  [[["split", 2]], [0.5, 3, 8, 9.5]],
  [[["split", 2], ["move", 3, -1]], [0.5, 3, 6, 9.5]],
  [[["change", 0, { words: "w" }]], [0.5, 3, 8, 9.5]],
  [[["change", 0, { seconds: null }], ["measured", [5, 3, 4]]], [0.5, 6, 11, 12.5]],
];

for (const [calls, expected] of CASES) {
  test(`poses stay with their beats: ${JSON.stringify(calls)}`, () => {
    const before = JSON.stringify(STORY);
    const story = calls.reduce((now, [name, ...values]) => edits[name](now, ...values), STORY);
    const found = story.poses.map((pose) => pose.seconds);
    assert.equal(found.length, expected.length);
    found.forEach((seconds, i) => assert.ok(Math.abs(seconds - expected[i]) < 1e-4, `${found}`));
    assert.equal(JSON.stringify(STORY), before, "an edit makes a new story");
  });
}
