// The texts of the page in one language: static/texts holds a file a language (webdemo/ui/text/texts.py).
// The lab's page carries all texts in Gradio's configuration, and a page without one fetches the file of its language.

const LANGUAGES = ["en"]; // the names of the files
const ENGLISH = "en";
const ATTRIBUTES = ["title", "aria-label", "placeholder"];

/** The language that is nearest to what a browser wants, by Gradio's rule: "de-AT" is German, an unknown one English. */
export function nearest(wanted, known) {
  return [wanted, wanted?.split("-")[0]].find((name) => known.includes(name)) ?? ENGLISH;
}

/** What is wanted: where Gradio has chosen, its choice; else the address's ?lang= or the browser's first language. */
function wanted() {
  const page = globalThis.document?.documentElement;
  if (globalThis.gradio_config && page) return page.lang;
  const asked = new URLSearchParams(globalThis.location?.search ?? "").get("lang");
  return asked || globalThis.navigator?.language || ENGLISH;
}

const bundled = globalThis.gradio_config?.i18n_translations;

async function read(name) {
  if (bundled?.[name]) return bundled[name];
  const address = new URL(`texts/${name}.json`, import.meta.url);
  if (address.protocol === "file:") { // a test of Node's
    const files = "node:fs/promises"; // no module of a page
    return JSON.parse(await (await import(files)).readFile(address, "utf-8"));
  }
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(`The texts did not load: ${answer.status}`);
  return answer.json();
}

export const language = nearest(globalThis.document ? wanted() : ENGLISH, bundled ? Object.keys(bundled) : LANGUAGES);
const texts = await read(language);

/** The text of a key with values in the place of the names in braces; a key that no text has is given back. */
export function say(key, values = {}) {
  const text = texts[key] ?? key;
  return text.replace(/\{(\w+)\}/g, (name, inner) => values[inner] ?? name);
}

/** Puts the language into markup, which is written in English: data-say names an element's text, data-say-title its title. */
export function translate(root) {
  if (language === ENGLISH) return;
  for (const element of root.querySelectorAll("[data-say]")) element.textContent = say(element.dataset.say);
  for (const name of ATTRIBUTES) {
    for (const element of root.querySelectorAll(`[data-say-${name}]`)) element.setAttribute(name, say(element.getAttribute(`data-say-${name}`)));
  }
}
