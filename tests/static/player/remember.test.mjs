// What the browser keeps: people are drawn as the visitor left them.

import assert from "node:assert/strict";
import test from "node:test";

import { figureAtFirst, keepFigure } from "../../../static/player/remember.js";

const BODY = { bodies: true, skeletons: false };
const BOTH = { bodies: true, skeletons: true };

function storing(entries = {}) {
  globalThis.localStorage = { getItem: (key) => entries[key] ?? null, setItem: (key, value) => { entries[key] = String(value); } };
}

test("people are bodies with skeletons at first", () => {
  storing();
  assert.deepEqual(figureAtFirst(), BOTH);
});

test("bodies, skeletons and both come back as they were left", () => {
  storing();
  for (const figure of [{ bodies: false, skeletons: true }, BOTH, BODY]) {
    keepFigure({ ...figure, trails: true });
    assert.deepEqual(figureAtFirst(), figure);
  }
});

test("a browser that keeps nothing, or something else, shows both", () => {
  storing({ "pas-de-deux-figure": "hologram" });
  assert.deepEqual(figureAtFirst(), BOTH);
  globalThis.localStorage = { getItem: () => { throw new Error("denied"); }, setItem: () => { throw new Error("denied"); } };
  keepFigure(BODY);
  assert.deepEqual(figureAtFirst(), BOTH);
});
