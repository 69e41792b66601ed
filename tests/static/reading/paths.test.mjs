// The paths beside the sentence direct the player of their tab for as long as they stand on the page.

import assert from "node:assert/strict";
import test from "node:test";

import { Paths } from "../../../static/reading/paths.js";

/** A place of the page with a list of paths and a player in its tab. */
function place(isConnected) {
  const player = { directed: 0, directing: { direct: () => player.directed++ } };
  const list = { addEventListener: () => {}, replaceChildren: () => {}, append: () => {} };
  const lab = { querySelector: () => ({ player }) };
  return { isConnected, player, parentElement: { querySelector: () => list }, closest: () => lab };
}

test.beforeEach(() => {
  globalThis.document = new EventTarget();
});

test("a player is directed at once and whenever one is there", () => {
  const root = place(true);
  new Paths(root, () => {});
  assert.equal(root.player.directed, 1);
  document.dispatchEvent(new Event("pdd-here"));
  assert.equal(root.player.directed, 2);
});

test("a place that has left the page by then is left alone, for good", () => {
  const root = place(false);
  new Paths(root, () => {});
  root.isConnected = true;
  document.dispatchEvent(new Event("pdd-here"));
  assert.equal(root.player.directed, 0);
});
