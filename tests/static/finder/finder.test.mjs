// What the page's search finds.

import assert from "node:assert/strict";
import test from "node:test";

import { search } from "../../../static/finder/finder.js";

const acts = [["hugs", "She hugs him."], ["shakes hands", "They shake hands."], ["holds", "He hugs a tree and holds on."]];
const entries = acts.map(([name, more]) => ({ kind: "Act", name, more }));

test("names come before sentences, and all words must fit", () => {
  assert.deepEqual(search(entries, "hug").map(({ name }) => name), ["hugs", "holds"]);
  assert.deepEqual(search(entries, "HANDS shake").map(({ name }) => name), ["shakes hands"]);
  assert.deepEqual(search(entries, "hug hands"), []);
  assert.deepEqual(search([...entries, { kind: "Run", name: "Übung am Fluß", more: "generate" }], "ubung").length, 1);
});

test("without words everything is listed in its order, up to a page of it", () => {
  assert.deepEqual(search(entries, "  "), entries);
  assert.equal(search(Array.from({ length: 300 }, () => entries[0]), "").length, 40);
});
