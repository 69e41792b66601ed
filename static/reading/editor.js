// The panel in which an act of a plan is changed or added, with the list of all acts.

import { people } from "./marks.js";
import * as edits from "./plan.js";
import { say } from "../texts.js";

let panels = 0;

export class Editor {
  /** `view` shows the plan: it has its `draft`, `entries` and `said`, takes edits, and asks for the list of acts. */
  constructor(root, view) {
    this.view = view;
    this.panel = root.querySelector(".pdr-edit");
    this.list = root.querySelector(".pdr-list");
    this.field = root.querySelector(".pdr-search");
    this.id = null; // the act that is changed; null while one is added
    this.active = 0;
    this.list.id = `pdr-list-${(panels += 1)}`;
    this.field.setAttribute("aria-controls", this.list.id);
    for (const radio of this.panel.querySelectorAll("[type=radio]")) radio.name += panels; // one panel's own
    this.panel.addEventListener("click", (event) => this.press(event));
    this.panel.addEventListener("keydown", (event) => this.key(event));
    this.field.addEventListener("input", () => this.draw());
  }

  get open() {
    return !this.panel.hidden;
  }

  /** Opens for an act, or to add one. */
  show(id = null) {
    this.id = id;
    this.panel.hidden = false;
    this.field.value = "";
    this.view.wantList();
    this.view.draw();
    this.panel.querySelector(id ? ".pdr-moves button" : ".pdr-search").focus();
  }

  close() {
    const { id } = this;
    this.panel.hidden = true;
    this.id = null;
    this.view.draw();
    this.view.focusChip(id);
  }

  draw() {
    if (!this.open) return;
    const act = this.view.draft?.plan.acts.find(({ id }) => id === this.id);
    if (this.id && !act) {
      this.panel.hidden = true;
      return;
    }
    const title = act ? `${people(act)} ${this.view.said[act.id] ?? act.act}` : say("reading.new_act");
    this.panel.querySelector(".pdr-title").textContent = title;
    this.panel.setAttribute("aria-label", act ? say("reading.change", { title }) : title);
    this.panel.querySelector(".pdr-moves").hidden = !act;
    this.panel.querySelector(".pdr-whose").hidden = Boolean(act);
    const verb = say(act ? "reading.something_else" : "reading.search");
    this.field.placeholder = verb;
    this.field.ariaLabel = verb;
    this.options = edits.search(this.view.entries ?? [], this.field.value);
    this.active = 0;
    this.list.replaceChildren(...this.options.map((entry, number) => this.option(entry, number)));
    if (!this.options.length) this.list.append(this.nothing());
    this.point();
  }

  option(entry, number) {
    const row = document.createElement("li");
    row.role = "option";
    row.id = `${this.list.id}-${number}`;
    row.dataset.number = number;
    row.append(entry.said, " ");
    const caption = document.createElement("small");
    caption.textContent = entry.caption;
    row.append(caption);
    return row;
  }

  nothing() {
    const row = document.createElement("li");
    row.textContent = say(this.view.entries ? "reading.no_act" : "reading.on_their_way");
    return row;
  }

  /** Marks the option that Enter takes. */
  point() {
    [...this.list.children].forEach((row, number) => row.setAttribute("aria-selected", number === this.active));
    if (this.options.length) this.field.setAttribute("aria-activedescendant", `${this.list.id}-${this.active}`);
    else this.field.removeAttribute("aria-activedescendant");
  }

  press(event) {
    const row = event.target.closest("[data-number]");
    if (row) return this.take(this.options[row.dataset.number]);
    const todo = event.target.closest("[data-do]")?.dataset.do;
    if (todo === "close") return this.close();
    const { draft } = this.view;
    if (todo === "remove") this.view.removeAct(this.id);
    else if (todo === "hand") this.view.edit(edits.hand(draft, this.id));
    else if (todo) this.view.edit(edits.shift(draft, this.id, todo === "earlier" ? -1 : 1));
  }

  key(event) {
    if (event.key === "Escape") {
      event.stopPropagation();
      return this.close();
    }
    if (event.target !== this.field || !this.options.length) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) this.active = (this.active + step + this.options.length) % this.options.length;
    else if (event.key === "Enter") this.take(this.options[this.active]);
    else return;
    event.preventDefault();
    this.point();
  }

  take(entry) {
    const { draft } = this.view;
    const whose = this.panel.querySelector("[type=radio]:checked").value;
    const next = this.id ? edits.change(draft, this.id, entry) : edits.add(draft, entry, [...whose]);
    this.id ??= next.plan.acts.at(-1).id;
    this.view.edit(next);
    this.close();
  }
}
