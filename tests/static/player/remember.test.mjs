// What the browser keeps: people are drawn as the visitor left them.

import assert from "node:assert/strict";
import test from "node:test";

import { FIGURES, figureAtFirst, keepFigure } from "../../../static/player/remember.js";

function storing(entries = {}) {
  globalThis.localStorage = { getItem: (key) => entries[key] ?? null, setItem: (key, value) => { entries[key] = String(value); } };
}

test("people are bodies with skeletons at first", () => {
  storing();
  assert.equal(figureAtFirst(), "both");
});

test("bodies, skeletons and both come back as they were left", () => {
  storing();
  for (const figure of FIGURES) {
    keepFigure(figure);
    assert.equal(figureAtFirst(), figure);
  }
});

test("a browser that keeps nothing, or something else, shows both", () => {
  storing({ "pas-de-deux-figure": "hologram" });
  assert.equal(figureAtFirst(), "both");
  globalThis.localStorage = { getItem: () => { throw new Error("denied"); }, setItem: () => { throw new Error("denied"); } };
  keepFigure("body");
  assert.equal(figureAtFirst(), "both");
});
