import assert from "node:assert/strict";
import { test } from "node:test";

const { language, nearest, say, translate } = await import("../../../static/texts.js");

/** The module as a page loads it, with the globals of that page. */
async function inPage(globals, name) {
  const before = Object.fromEntries(Object.keys(globals).map((key) => [key, Object.getOwnPropertyDescriptor(globalThis, key)]));
  for (const [key, value] of Object.entries(globals)) Object.defineProperty(globalThis, key, { value, configurable: true });
  try {
    return await import(`../../../static/texts.js?${name}`);
  } finally {
    for (const [key, was] of Object.entries(before)) was ? Object.defineProperty(globalThis, key, was) : delete globalThis[key];
  }
}

/** An element with attributes, and a root that finds such elements by one of them. */
const element = (attributes) => ({
  attributes, textContent: "as it was", dataset: { say: attributes["data-say"] },
  getAttribute: (name) => attributes[name], setAttribute: (name, value) => (attributes[name] = value),
});
const rooted = (...elements) => ({
  querySelectorAll: (selector) => elements.filter(({ attributes }) => selector.slice(1, -1) in attributes),
});

const KNOWN = ["de", "en"];

test("a language is found as Gradio finds it", () => {
  assert.equal(nearest("de", KNOWN), "de");
  assert.equal(nearest("de-AT", KNOWN), "de");
  assert.equal(nearest("en-US", KNOWN), "en");
  assert.equal(nearest("fr-FR", KNOWN), "en");
  assert.equal(nearest(undefined, KNOWN), "en");
});

test("values stand in the place of their names, and what nobody knows is given back", () => {
  assert.equal(language, "en");
  assert.equal(say("player.sample", { number: 3 }), "Sample 3");
  assert.equal(say("player.sample"), "Sample {number}");
  assert.equal(say("vote.pair", { number: 0, total: 12 }), "Pair 0 of 12");
  assert.equal(say("Something that the server said {number}"), "Something that the server said {number}");
});

test("in the lab's page, Gradio's choice counts, and its configuration has the texts", async () => {
  const known = { de: { "player.sample": "Probe {number}" }, en: { "player.sample": "Sample {number}" } };
  const page = { gradio_config: { i18n_translations: known }, document: { documentElement: { lang: "de" } }, location: { search: "?lang=en" } };
  const texts = await inPage(page, "gradio");
  assert.equal(texts.language, "de");
  assert.equal(texts.say("player.sample", { number: 2 }), "Probe 2");
});

test("markup is put into the language, and English markup is left alone", async () => {
  const button = () => element({ "data-say": "player.front", title: "Front (2)", "data-say-title": "player.front_title" });
  const english = button();
  translate(rooted(english));
  assert.deepEqual([english.textContent, english.attributes.title], ["as it was", "Front (2)"]);
  const i18n_translations = { de: { "player.front": "Vorn", "player.front_title": "Von vorn (2)" }, en: {} };
  const page = { gradio_config: { i18n_translations }, document: { documentElement: { lang: "de" } }, location: { search: "" } };
  const german = button();
  (await inPage(page, "markup")).translate(rooted(german));
  assert.deepEqual([german.textContent, german.attributes.title], ["Vorn", "Von vorn (2)"]);
});
