// The page's search: Ctrl K opens a dialog whose field offers acts and runs. webdemo/ui/components/finder.py has its data.

import { node } from "../player/node.js";
import { say } from "../texts.js";

const PATIENCE = 8000; // ms until the prompt must be on the page

/** Puts a sentence into the prompt of the tab Generate, as if it had been typed. */
async function write(sentence) {
  const tabs = [...document.querySelectorAll(".pd-tabs [role=tab]")];
  tabs.find((tab) => tab.textContent.trim() === say("tabs.generate") && tab.ariaSelected !== "true")?.click();
  if (document.querySelector(".pd-off")) document.querySelector("#way input").click(); // a class was asked for
  const end = performance.now() + PATIENCE;
  let prompt = null;
  while (!prompt?.offsetParent && performance.now() < end) {
    await new Promise((done) => setTimeout(done, 50));
    prompt = document.querySelector("#prompt textarea");
  }
  if (!prompt) return;
  Object.getOwnPropertyDescriptor(Object.getPrototypeOf(prompt), "value").set.call(prompt, sentence);
  prompt.dispatchEvent(new Event("input", { bubbles: true }));
  prompt.focus();
}

/** The entry that is called so, or else the first that has all the words. */
function find(entries, asked) {
  const words = asked.toLowerCase().split(/\s+/).filter(Boolean);
  const has = ({ kind, name, more }) => words.every((word) => `${kind} ${name} ${more}`.toLowerCase().includes(word));
  return words.length ? entries.find(({ name }) => name === asked) ?? entries.find(has) : null;
}

/** `element` holds finder.html; `props` are the component's, watched by `watch`; `trigger` tells Python. */
export function mount(element, props, watch, trigger) {
  const [dialog, field, list, line, opener] = ["dialog", "input", "datalist", "p", "button"].map((part) => element.querySelector(part));
  let entries = [];
  const open = () => {
    trigger("input"); // runs change, and acts are read when they are first wanted
    field.value = line.textContent = "";
    dialog.showModal();
  };
  const take = (event) => {
    event.preventDefault();
    const entry = find(entries, field.value);
    line.textContent = entry || !field.value || !entries.length ? "" : say("finder.nothing");
    if (!entry) return;
    dialog.close();
    if (entry.run) window.location.search = new URLSearchParams({ run: entry.run });
    else write(entry.more);
  };
  const load = () => {
    const { acts, runs } = props.known ?? { acts: [], runs: [] };
    const seen = new Map();
    const once = (name) => {
      const count = (seen.get(name) ?? 0) + 1;
      seen.set(name, count);
      return count > 1 ? `${name} (${count})` : name;
    };
    entries = [
      ...acts.map(([name, sentence]) => ({ kind: say("finder.act"), name, more: sentence })),
      ...runs.map(([run, name, more]) => ({ kind: say("finder.run"), name: once(name), more, run })),
    ];
    list.replaceChildren(...entries.map(({ kind, name, more }) => Object.assign(node("option"), { value: name, label: `${kind}: ${more}` })));
  };
  opener.addEventListener("click", open);
  opener.querySelector("kbd").textContent = /Mac|iP(hone|ad)/.test(navigator.platform) ? "⌘ K" : say("finder.keys");
  field.form.addEventListener("submit", take);
  field.addEventListener("input", (event) => event.inputType === "insertReplacementText" && take(event)); // one is picked
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close()); // beside it
  const pressed = (event) => {
    if (!element.isConnected) return document.removeEventListener("keydown", pressed);
    if (event.key.toLowerCase() !== "k" || !(event.ctrlKey || event.metaKey) || event.altKey || event.shiftKey) return;
    event.preventDefault();
    dialog.open ? dialog.close() : open();
  };
  document.addEventListener("keydown", pressed);
  opener.disabled = false; // before, nobody would hear
  watch(["known"], load);
  load();
}
