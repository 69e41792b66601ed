// The notebook of runs: cards that can be searched, chosen, named, tagged and written on.
// Python gives the entries (webdemo/ui/components/notebook.py) and hears of every press by one event.

import { play } from "./thumbnail.js";
import { node } from "../player/node.js";
import { loadStyles } from "../player/loader.js";
import { say } from "../texts.js";

const MOST_RETRIES = 3;
const WAIT = 300; // ms after the last key before a search
const KINDS = [
  ["", "notebook.all_jobs"], ["generate", "tabs.generate"], ["scene", "tabs.scene"], ["react", "tabs.react"], ["predict", "tabs.predict"],
];

export class Notebook {
  constructor(root, tell) {
    this.root = root;
    this.tell = tell;
    this.find = (selector) => root.querySelector(selector);
    this.chosen = new Set();
    this.last = null;
    this.limit = null; // runs that are shown at most: of the last search
    this.retries = 0;
    this.found = null;
    this.entries = new Map();
    root.addEventListener("click", (event) => this.press(event));
    root.addEventListener("keydown", (event) => this.type(event));
    for (const field of root.querySelectorAll("[data-find]")) {
      field.addEventListener("input", () => {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.search(null), field.type === "search" ? WAIT : 0);
      });
    }
    this.options("kind", KINDS.map(([kind, key]) => [kind, say(key)]));
  }

  options(name, pairs) {
    const list = this.find(`[data-find=${name}]`);
    const was = list.value;
    list.replaceChildren(...pairs.map(([value, label]) => Object.assign(node("option", "", label), { value })));
    list.value = pairs.some(([value]) => value === was) ? was : "";
  }

  /** What is searched for now. */
  wanted() {
    const value = (name) => this.find(`[data-find=${name}]`).value;
    const starred = this.find("[data-find=starred]").checked;
    return { words: value("words"), kind: value("kind"), model: value("model"), tag: value("tag"), starred };
  }

  search(limit = this.limit) {
    this.limit = limit;
    this.act("search");
  }

  act(act, more = {}) {
    this.tell({ act, ids: [...this.chosen], search: this.wanted(), limit: this.limit, ...more });
  }

  /** Shows what Python found: { entries, total, limit, tags, models, removed }. */
  load(found) {
    const wanted = this.wanted();
    const same = Object.keys(wanted).every((name) => (wanted[name] || null) === (found.search[name] || null));
    if (!same && this.retries++ < MOST_RETRIES) return this.search(); // a late answer to an earlier search
    this.retries = 0;
    this.found = found;
    this.entries = new Map(found.entries.map((entry) => [entry.id, entry]));
    for (const id of this.chosen) if (!this.entries.has(id)) this.chosen.delete(id);
    if (!this.chosen.size && found.entries.length) this.chosen.add(found.entries[0].id);
    this.options("tag", [["", say("notebook.all_tags")], ...found.tags.map((tag) => [tag, `#${tag}`])]);
    this.options("model", [["", say("notebook.all_methods")], ...found.models]);
    this.find(".pdn-list").replaceChildren(...found.entries.map((entry) => this.card(entry)));
    const empty = this.find(".pdn-empty");
    empty.hidden = found.entries.length > 0;
    empty.textContent = say(found.empty);
    this.find(".pdn-more").hidden = found.total <= found.entries.length;
    this.show();
  }

  /** A copy of one of the templates. */
  made(name) {
    return this.find(`[data-made=${name}]`).content.cloneNode(true);
  }

  card(entry) {
    const card = this.made("card").firstElementChild;
    const part = (selector) => card.querySelector(selector);
    card.dataset.id = entry.id;
    part("input").ariaLabel = say("notebook.choose", { title: entry.title });
    play(part("canvas"), entry.thumbnail);
    part(".pdn-title").textContent = `${entry.favourite ? "★ " : ""}${entry.title}`;
    for (const name of ["facts", "message", "note"]) part(`.pdn-${name}`).textContent = entry[name];
    part(".pdn-tags").append(...entry.tags.map((tag) => node("span", "", `#${tag}`)));
    const more = part("details");
    more.addEventListener("toggle", () => more.open && more.children.length === 1 && this.fill(more, entry));
    return card;
  }

  /** The rest of a card, made when it is opened. */
  fill(more, entry) {
    const rest = this.made("rest");
    for (const field of rest.querySelectorAll("[data-field]")) field.value = [entry[field.dataset.field]].flat().join(" ");
    rest.querySelector("[data-save]").dataset.save = entry.id;
    rest.querySelector("dl").append(...entry.settings.map((pair) => {
      const line = node("div");
      line.append(...pair.map((text, i) => node(["dt", "dd"][i], "", text)));
      return line;
    }));
    more.append(rest);
  }

  press(event) {
    const button = event.target.closest("button");
    if (button?.dataset.save) return this.save(button.closest(".pdn-form"), button.dataset.save);
    if (button?.dataset.act === "more") return this.search(this.found.entries.length + this.found.step);
    if (button?.dataset.act) return this.act(button.dataset.act);
    if (event.target.closest(".pdn-details")) return;
    const card = event.target.closest(".pdn-card");
    if (event.target.closest(".pdn-thumb") && this.entries.get(card.dataset.id).state === "done") {
      this.choose(card, {});
      return this.act("open");
    }
    if (card) this.choose(card, { several: event.target.closest(".pdn-pick") || event.ctrlKey || event.metaKey, range: event.shiftKey });
  }

  type(event) {
    if (!event.target.matches(".pdn-card")) return;
    const act = { Enter: "open", Delete: "remove" }[event.key];
    if (act) {
      if (act === "open" || !this.chosen.has(event.target.dataset.id)) this.choose(event.target, {});
      this.find(`[data-act=${act}]`).click(); // does nothing where that cannot be done
    } else if (event.key === " ") this.choose(event.target, { several: true });
    else if (event.key === "ArrowDown") event.target.nextElementSibling?.focus();
    else if (event.key === "ArrowUp") event.target.previousElementSibling?.focus();
    else return;
    event.preventDefault();
  }

  choose(card, { several = false, range = false }) {
    const { id } = card.dataset;
    const ids = [...this.entries.keys()];
    if (range && ids.includes(this.last)) {
      const [from, to] = [ids.indexOf(this.last), ids.indexOf(id)].sort((a, b) => a - b);
      for (const each of ids.slice(from, to + 1)) this.chosen.add(each);
    } else if (several) this.chosen.has(id) ? this.chosen.delete(id) : this.chosen.add(id);
    else this.chosen = new Set([id]);
    this.last = id;
    this.show();
  }

  save(form, id) {
    const value = (name) => form.querySelector(`[data-field=${name}]`).value;
    const title = value("title");
    const named = title === this.entries.get(id).title ? {} : { title };
    this.act("describe", { ids: [id], ...named, tags: value("tags"), note: value("note") });
  }

  /** Brings marks and buttons to what is chosen. */
  show() {
    for (const card of this.root.querySelectorAll(".pdn-card")) {
      const on = this.chosen.has(card.dataset.id);
      card.classList.toggle("pdn-on", on);
      card.querySelector("input").checked = on;
    }
    const chosen = [...this.chosen].map((id) => this.entries.get(id)).filter(Boolean);
    const [one] = chosen.length === 1 ? chosen : [null];
    const done = chosen.filter((entry) => entry.state === "done");
    const able = {
      open: one?.state === "done", link: one?.state === "done", revoke: one?.links > 0,
      favour: Boolean(one),
      compare: done.length > 1 && done.length === chosen.length && done.length <= 9,
      study: done.length === 2 && chosen.length === 2,
      publish: one?.state === "done",
      export: done.length > 0 && done.length === chosen.length,
      remove: chosen.length > 0 && chosen.every((entry) => entry.state !== "running" && !entry.favourite),
    };
    for (const [act, can] of Object.entries(able)) this.find(`[data-act=${act}]`).disabled = !can;
    this.find("[data-act=favour]").textContent = say(one?.favourite ? "notebook.unkeep" : "notebook.keep");
    const undo = this.find("[data-act=restore]");
    undo.hidden = !this.found?.removed;
    undo.textContent = say(this.found?.removed === 1 ? "notebook.run_back" : "notebook.runs_back", { count: this.found?.removed });
    const total = this.found?.total ?? 0;
    this.find(".pdn-count").textContent = say("notebook.count", { count: chosen.length, total });
    this.find(".pdn-actions").hidden = !total && !this.found?.removed;
  }
}

/** `element` holds notebook.html; `props` are the component's, watched by `watch`; `trigger` tells Python. */
export function mount(element, props, watch, trigger) {
  loadStyles(new URL("notebook.css", import.meta.url).href);
  const events = { open: "submit", compare: "like", study: "edit", publish: "apply" }; // the others are "select"
  const root = element.querySelector(".pdn");
  const notebook = root.notebook = new Notebook(root, (action) => trigger(events[action.act] ?? "select", action));
  let shown = null;
  const sync = () => {
    if (!props.value || props.value === shown) return;
    shown = props.value;
    notebook.load(props.value);
  };
  watch("value", sync);
  sync();
}
