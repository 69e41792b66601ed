// What the page's search finds.

import assert from "node:assert/strict";
import test from "node:test";

import { placesOf, search } from "../../../static/finder/finder.js";

const component = (id, type, props) => ({ id, type, props: { visible: true, ...props } });
const CONFIG = {
  components: [
    component(1, "tabs", {}), component(2, "tabitem", { label: "Generate" }), component(3, "accordion", { label: "More ▼", elem_id: "more" }),
    component(4, "slider", { label: "Samples", elem_id: "samples" }), component(5, "button", { value: "Generate", elem_id: "generate" }),
    component(6, "textbox", { label: "of a program", elem_id: null }), component(7, "tabitem", { label: "Scene" }),
    component(8, "slider", { label: "Samples", elem_id: "scene-samples" }), component(9, "slider", { label: "Hidden", elem_id: "hidden", visible: false }),
    component(10, "number", { label: "outside of all tabs", elem_id: "outside" }),
  ],
  layout: {
    id: 0,
    children: [{ id: 10 }, { id: 1, children: [
      { id: 2, children: [{ id: 3, children: [{ id: 4 }] }, { id: 5 }, { id: 6 }] },
      { id: 7, children: [{ id: 8 }, { id: 9 }] },
    ] }],
  },
};
const acts = [["hugs", "She hugs him."], ["shakes hands", "They shake hands."], ["holds", "He hugs a tree and holds on."]];
const entries = acts.map(([name, more]) => ({ kind: "Act", name, more }));

test("tabs and controls are found with what must be opened to see them", () => {
  const places = placesOf(CONFIG);
  assert.deepEqual(places.filter(({ kind }) => kind === "Tab").map(({ name }) => name), ["Generate", "Scene"]);
  assert.deepEqual(places.find(({ target }) => target === "samples").folds, ["more"]);
  assert.deepEqual(places.find(({ target }) => target === "scene-samples"), { kind: "Control", name: "Samples", more: "Scene", tab: "Scene", folds: [], target: "scene-samples" });
  assert.equal(places.find(({ target }) => target === "more").name, "More");
  assert.ok(places.some(({ target, name }) => target === "generate" && name === "Generate"));
});

test("what is hidden, or a program's alone, is not found", () => {
  const targets = placesOf(CONFIG).map(({ target }) => target);
  assert.ok(!targets.includes("hidden") && !targets.includes("outside") && targets.every((target) => target !== undefined));
  assert.equal(placesOf(CONFIG).length, 6);
});

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
