// The page's search: Ctrl K opens a dialog, arrows choose, Enter goes there. webdemo/ui/components/finder.py has its data.

import { search } from "./finder.js";
import { node } from "../player/node.js";
import { say } from "../texts.js";

const PATIENCE = 8000; // ms until the prompt must be on the page

/** Puts a sentence into the prompt of the tab Generate, as if it had been typed. */
async function write(sentence) {
  const tabs = [...document.querySelectorAll(".pd-tabs [role=tab]")];
  tabs.find((tab) => tab.textContent.trim() === say("tabs.generate") && tab.ariaSelected !== "true")?.click();
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

class Finder {
  constructor(root, ask) {
    this.ask = ask;
    this.dialog = root.querySelector("dialog");
    this.field = root.querySelector("input");
    this.list = root.querySelector("[role=listbox]");
    this.entries = [];
    root.querySelector(".pdq-open").addEventListener("click", () => this.open());
    root.querySelector(".pdq-open kbd").textContent = /Mac|iP(hone|ad)/.test(navigator.platform) ? "⌘ K" : say("finder.keys");
    this.field.addEventListener("input", () => this.show());
    this.dialog.addEventListener("keydown", (event) => this.type(event));
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) return this.dialog.close(); // beside it
      const row = event.target.closest("[role=option]");
      if (row) this.take(Number(row.dataset.index));
    });
    const pressed = (event) => {
      if (!root.isConnected) return document.removeEventListener("keydown", pressed);
      if (event.key.toLowerCase() !== "k" || !(event.ctrlKey || event.metaKey) || event.altKey || event.shiftKey) return;
      event.preventDefault();
      this.dialog.open ? this.dialog.close() : this.open();
    };
    document.addEventListener("keydown", pressed);
  }

  open() {
    this.ask(); // runs change, and acts are read when they are first wanted
    this.field.value = "";
    this.dialog.showModal();
    this.field.focus();
    this.show();
  }

  /** Takes what Python knows: { acts: [name, sentence], runs: [id, title, facts] }. */
  load({ acts, runs }) {
    this.entries = [
      ...acts.map(([name, sentence]) => ({ kind: say("finder.act"), name, more: sentence, sentence })),
      ...runs.map(([run, name, more]) => ({ kind: say("finder.run"), name, more, run })),
    ];
    if (this.dialog.open) this.show();
  }

  show() {
    this.found = search(this.entries, this.field.value);
    this.at = 0;
    this.list.replaceChildren(...this.found.map((entry, index) => {
      const row = node("li", "pdq-row", "");
      Object.assign(row, { id: `pdq-${index}`, role: "option" });
      row.dataset.index = index;
      row.append(node("span", "pdq-kind", entry.kind), node("span", "pdq-name", entry.name), node("span", "pdq-more", entry.more));
      return row;
    }));
    if (this.entries.length && !this.found.length) this.list.append(node("li", "pdq-none", say("finder.nothing")));
    this.mark();
  }

  mark() {
    [...this.list.children].forEach((row, index) => {
      row.ariaSelected = String(index === this.at);
      if (index === this.at) row.scrollIntoView({ block: "nearest" });
    });
    if (this.found.length) this.field.setAttribute("aria-activedescendant", `pdq-${this.at}`);
    else this.field.removeAttribute("aria-activedescendant");
  }

  type(event) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step && this.found.length) {
      this.at = (this.at + step + this.found.length) % this.found.length;
      this.mark();
    } else if (event.key === "Enter") this.take(this.at);
    else return;
    event.preventDefault();
  }

  take(index) {
    const entry = this.found[index];
    if (!entry) return;
    this.dialog.close();
    if (entry.sentence) return write(entry.sentence);
    window.location.search = new URLSearchParams({ run: entry.run });
  }
}

/** `element` holds finder.html; `props` are the component's, watched by `watch`; `trigger` tells Python. */
export function mount(element, props, watch, trigger) {
  const root = element.querySelector(".pdq");
  const finder = new Finder(root, () => trigger("input"));
  const sync = () => props.known && finder.load(props.known);
  watch(["known"], sync);
  sync();
}
