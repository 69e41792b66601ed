// How a prompt is understood, under it: the sentence with its marks, and its plan as chips on two lanes to be edited.

import { Asking } from "./asking.js";
import { Length } from "./length.js";
import { offers, people, pieces, spoken, summary, wordsOf } from "./marks.js";
import { Paths } from "./paths.js";
import * as edits from "./plan.js";
import { node } from "../player/node.js";
import { say } from "../texts.js";

const NAMES = { a: "A", b: "B", ab: say("reading.a_and_b") };
const MARKS = { true: ["✓", say("reading.done")], false: ["✗", say("reading.not_done")], null: ["–", say("reading.not_measured")] };
const SOON = 700; // milliseconds after an edit in which another may come

class View {
  /** `keep` takes the component's value, and `ask` sends it to the server; `editable` plans can be edited. */
  constructor(root, { keep, ask, editable, usual }) {
    this.root = root;
    this.keep = keep;
    this.ask = ask;
    this.editable = editable;
    this.asking = new Asking(() => this.send());
    this.shown = null; // as the server gave it
    this.draft = null; // its plan and beats, as they were edited since
    this.edited = false;
    this.number = 0; // of what was asked last
    this.note = "";
    this.checks = null; // the verdicts on the last result, and those by the ids of its acts
    this.verdicts = new Map();
    this.waiting = false; // a run, for its text to be read
    this.chosen = null; // the id of the act whose panel is open
    this.length = new Length(this.find(".pdr-length"), root.closest(".pd-lab"), usual);
    this.paths = editable ? new Paths(root, () => this.hold(), () => this.makeAgain()) : null;
    for (const kind of ["pointerover", "focusin"]) root.addEventListener(kind, (event) => this.point(event.target));
    for (const kind of ["pointerleave", "focusout"]) root.addEventListener(kind, () => this.point(null));
    root.addEventListener("click", (event) => this.press(event.target));
    root.addEventListener("keydown", (event) => this.key(event));
    this.find(".pdr-again").addEventListener("click", () => this.readAgain());
    this.find(".pdr-fold").addEventListener("click", () => this.fold(false));
    const asks = root.closest(".pd-ask");
    asks?.addEventListener("focusin", (event) => event.target.matches("textarea") && this.fold(false));
  }

  /**
   * Before a run: reads the `text` that it is asked for, so that the motion is as long as its acts. A run that is asked
   * for meanwhile never begins, as none does while another goes on.
   */
  async readFirst(text) {
    if (this.waiting) await new Promise(() => {}); // for ever
    this.waiting = true;
    this.typed(text);
    await this.asking.answered(() => this.shown);
    this.waiting = false;
    this.leave();
  }

  /** A run begins: what is read and edited makes room for its result. */
  leave() {
    this.fold(true);
    this.length.leave();
    if (this.chosen) this.choose(null);
  }

  /** On a phone, a line stands for the reading while a motion is made and watched. */
  fold(folded) {
    this.root.classList.toggle("pdr-folded", folded);
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  get said() {
    return this.shown?.said ?? {};
  }

  /** The props of the component as they are now. */
  sync(props) {
    this.answer(props.shown); // to the text as it was, or, where a run is opened, to the one that comes with it
    this.typed(props.text ?? "");
    this.answer(props.shown);
    this.judge(props.checked?.text ? props.checked : null);
    if (this.shown) this.draw();
  }

  /** Takes the verdicts on a result of the present plan, whose acts they follow in the sentence's order. */
  judge(checks) {
    if (checks === this.checks || (checks && !(this.shown?.plan && this.asking.text === checks.text))) return;
    this.checks = checks;
    this.verdicts.clear();
    const left = [...(checks?.acts ?? [])];
    for (const act of checks ? this.shown.plan.acts : []) {
      const at = left.findIndex((each) => each.act === act.act);
      if (at >= 0) this.verdicts.set(act.id, left.splice(0, at + 1).at(-1));
    }
  }

  typed(text) {
    if (!this.asking.typed(text)) return;
    clearTimeout(this.making);
    this.fold(false);
    if (this.edited) {
      this.note = say("reading.dropped");
      this.asking.asked = ""; // the words are read again, be they the same
    }
    this.edited = false;
    this.chosen = null;
    this.hold();
    const current = this.asking.answers(this.shown);
    this.root.hidden = !text.trim() || !this.shown;
    this.root.classList.toggle("pdr-old", !current);
  }

  /** The value of the component: the text, the plan where it was edited, and paths that were drawn. */
  hold() {
    const plan = this.edited ? JSON.stringify(this.draft.plan) : null;
    this.keep({ text: this.asking.text, plan, number: this.number, paths: this.paths?.paths ?? [] });
  }

  send() {
    this.number += 1;
    this.hold();
    this.ask();
  }

  /** A plan as the server shows it. What is given unasked, with a result from the history, has no number. */
  answer(shown) {
    if (!shown || shown === this.shown || shown === this.refused || !this.asking.answers(shown)) return;
    if (shown.number != null && shown.number !== this.number) return;
    if (shown.error && this.edited) {
      this.refused = shown;
      this.note = shown.error;
      this.draft = this.shown;
      this.edited = this.shown.edited;
      this.hold();
      return;
    }
    this.asking.settled();
    if (!shown.edited && shown.number == null) this.note = "";
    this.shown = shown;
    this.draft = shown.plan ? shown : null;
    if (shown.paths) this.paths?.open(shown.paths);
    this.edited = shown.edited;
    this.hold();
  }

  /** A change by hand. */
  edit(draft) {
    if (draft.plan === this.draft.plan) return;
    this.note = "";
    this.draft = draft;
    this.edited = true;
    this.send();
    this.makeAgain();
  }

  /** Makes the motion on the stage again where it is that of this text: soon, and once nothing else is made or drawn. */
  makeAgain() {
    clearTimeout(this.making);
    const { player } = this.paths;
    if (![this.checks?.text, player?.data?.title].includes(this.asking.text)) return;
    const go = this.root.closest(".pd-ask").querySelector("button.pd-run");
    this.making = setTimeout(() => {
      const busy = go.disabled || player.directing.drawing.held;
      busy ? this.makeAgain() : go.click();
    }, SOON);
  }

  removeAct(id) {
    const ids = this.draft.beats.flat();
    const next = ids[ids.indexOf(id) + 1] ?? ids.at(-2) ?? null;
    this.chosen = null;
    this.edit(edits.remove(this.draft, id));
    this.focusNext = next;
  }

  readAgain() {
    this.note = "";
    this.edited = false;
    this.send();
  }

  /** Opens the panel of an act, or closes it for null. */
  choose(id) {
    this.chosen = id;
    if (this.shown) this.draw();
    if (id) this.find("[data-do=hand]").focus();
  }

  focusChip(id) {
    this.find(`.pdr-chip[data-id="${id}"]`)?.focus();
  }

  // ---- events

  press(target) {
    const chip = target.closest("button.pdr-chip");
    if (chip) this.choose(chip.dataset.id);
    const todo = target.closest("[data-do]")?.dataset.do;
    if (todo === "hand") this.edit(edits.hand(this.draft, this.chosen));
    else if (todo === "remove") this.removeAct(this.chosen);
    else if (todo === "close") this.close();
    const near = target.closest("[data-near]");
    if (!near) return;
    const entry = this.shown.nearest[near.dataset.near];
    const place = this.draft.plan.unread.indexOf(this.shown.plan.unread[near.dataset.unread]);
    if (place >= 0) this.edit(edits.understand(this.draft, place, entry));
  }

  /** Closes the panel, and the focus goes back to its chip. */
  close() {
    const { chosen } = this;
    this.choose(null);
    this.focusChip(chosen);
  }

  key(event) {
    if (event.key === "Escape" && event.target.closest?.(".pdr-edit")) {
      event.stopPropagation();
      return this.close();
    }
    const chip = event.target.closest?.("button.pdr-chip");
    if (!chip || !["Delete", "Backspace"].includes(event.key)) return;
    event.preventDefault();
    this.removeAct(chip.dataset.id);
  }

  /** The words of the chip under the pointer stand out, and the chips of the words under it. */
  point(target) {
    const ids = target?.closest("[data-id]")?.dataset.id ?? target?.closest("[data-acts]")?.dataset.acts ?? "";
    const on = new Set(ids.split(" ").filter(Boolean));
    for (const each of this.root.querySelectorAll("[data-acts], [data-id]")) {
      const own = each.dataset.id ? [each.dataset.id] : each.dataset.acts.split(" ");
      each.classList.toggle("pdr-on", own.some((id) => on.has(id)));
    }
  }

  // ---- drawing

  draw() {
    const { plan, error, text } = this.shown;
    const current = this.asking.answers(this.shown);
    const focused = this.focusNext ?? (this.root.contains(document.activeElement) && document.activeElement.dataset.id);
    this.focusNext = null;
    this.root.classList.toggle("pdr-old", !current);
    this.root.hidden = !this.asking.text.trim() || !text.trim();
    this.find(".pdr-state").hidden = !this.edited;
    const unread = plan ? this.unreadIn(plan) : [];
    this.find(".pdr-said").replaceChildren(...(plan ? this.sentence(plan, unread) : []));
    this.find(".pdr-unread").replaceChildren(...unread.map((part, i) => this.unread(part, i)));
    this.find(".pdr-plan").hidden = !plan?.acts.length;
    this.length.draw(plan ? this.shown.seconds : null, current ? this.asking.text : null);
    this.find(".pdr-beats").replaceChildren(...(plan ? this.shown.beats.map((beat) => this.beat(beat)) : []));
    const notes = plan ? this.shown.notes.filter((note) => !this.shown.whys.includes(note)) : [];
    if (plan && !plan.acts.length) notes.push(say("reading.example"));
    const warnings = [error, this.note].filter(Boolean);
    this.find(".pdr-notes").replaceChildren(
      ...warnings.map((warning) => node("p", "pdr-error", warning)), ...notes.map((note) => node("p", "", note)),
    );
    this.find("p.pdr-heard").textContent = [...warnings, plan ? summary(plan) : ""].join(" ").trim();
    this.find(".pdr-fold").textContent = plan ? this.line(plan) : error;
    if (focused) this.focusChip(focused);
    this.drawPanel();
  }

  /** The panel of the chosen act, for as long as the plan has it. */
  drawPanel() {
    const panel = this.find(".pdr-edit");
    const act = this.draft?.plan.acts.find(({ id }) => id === this.chosen);
    panel.hidden = !act;
    if (!act) return;
    const title = `${people(act)} ${this.said[act.id] ?? act.act}`;
    this.find(".pdr-title").textContent = title;
    panel.setAttribute("aria-label", say("reading.change", { title }));
  }

  /** The parts that are not understood: those of the reading, and the words that the verdict found in no act. */
  unreadIn({ sentence, unread }) {
    const known = unread.map((part) => wordsOf(sentence, part.words));
    const more = this.checks?.text === this.asking.text ? this.checks.unread : [];
    return [...unread, ...more.filter((words) => !known.some((own) => own.includes(words))).map((words) => {
      const start = Array.from(sentence.slice(0, Math.max(sentence.indexOf(words), 0))).length;
      return { words: { start, stop: start + Array.from(words).length }, nearest: [] };
    })];
  }

  whyOf(number) {
    return this.shown.whys[number] ?? say("reading.in_no_act");
  }

  /** What is understood and done, in a line. */
  line(plan) {
    const done = plan.acts.map((act) => this.checked(act)).filter((each) => each && each.done !== null);
    const seen = done.filter((each) => each.done).length;
    return `${summary(plan)}${done.length ? ` ${say("reading.count_done", { seen, all: done.length })}` : ""}`;
  }

  sentence(plan, unread) {
    return pieces(plan.sentence, plan.acts, unread).map((piece) => {
      if (!piece.who && piece.unread < 0) return document.createTextNode(piece.text);
      const made = node("span", `pdr-words ${[...piece.who].map((who) => `pdr-${who}`).join(" ")}`, piece.text);
      made.classList.toggle("pdr-lost", piece.unread >= 0);
      made.dataset.acts = piece.acts.join(" ");
      const said = piece.acts.map((id) => this.said[id]).join(", ");
      made.title = piece.who ? `${NAMES[piece.who]}: ${said}` : this.whyOf(piece.unread);
      return made;
    });
  }

  unread(part, number) {
    const row = node("li", "");
    row.append(node("q", "pdr-lost", wordsOf(this.shown.plan.sentence, part.words)), `: ${this.whyOf(number)}`);
    const near = offers(part.nearest, this.shown.nearest);
    if (near.length && this.editable) {
      const buttons = node("span", "pdr-near");
      buttons.append(`${say("reading.put_in")} `, ...near.map((name) => this.nearest(name, number)));
      row.append(buttons);
    } else if (near.length) {
      row.append(` ${say("reading.nearest", { names: near.map((name) => this.shown.nearest[name].said).join(", ") })}`);
    }
    return row;
  }

  nearest(name, number) {
    const made = node("button", "pdr-small", this.shown.nearest[name].said);
    made.dataset.near = name;
    made.dataset.unread = number;
    return made;
  }

  beat(ids) {
    const row = node("li", "pdr-beat");
    const acts = this.shown.plan.acts;
    row.append(...ids.map((id) => this.chip(acts.find((act) => act.id === id))));
    return row;
  }

  chip(act) {
    const said = this.said[act.id];
    const made = node(this.editable ? "button" : "span", `pdr-chip pdr-${act.agents.join("")}`);
    made.classList.toggle("pdr-not", act.polarity === "not" || act.modality !== "told");
    made.dataset.id = act.id;
    made.classList.toggle("pdr-open", this.chosen === act.id);
    const seen = node("span", "");
    seen.ariaHidden = "true";
    seen.append(node("b", "", people(act)), ` ${said}`);
    const check = this.check(act);
    made.append(seen, ...(check ? [check] : []), node("span", "pdr-heard", this.heard(act, said)));
    return made;
  }

  /** What the last result did of an act, where it is known. */
  checked(act) {
    const found = this.checks?.text === this.asking.text ? this.verdicts.get(act.id) : null;
    return found?.act === act.act ? found : null;
  }

  check(act) {
    const found = this.checked(act);
    if (!found) return null;
    const [sign, name] = MARKS[found.done];
    const made = node("span", `pdr-check pdr-check-${found.done}`, `${sign} ${found.done === null ? [name, found.measure].filter(Boolean).join(": ") : found.measure || name}`);
    made.ariaHidden = "true";
    return made;
  }

  heard(act, said) {
    const found = this.checked(act);
    const done = found ? `; ${MARKS[found.done][1]}${found.measure ? `, ${found.measure}` : ""}` : "";
    return `${spoken(act, said)}${done}${this.editable ? say("reading.press") : ""}`;
  }
}

/** `element` holds reading.html; `props` are the component's, watched by `watch`; `trigger` tells the server. */
export function mount(element, props, watch, trigger) {
  const root = element.querySelector(".pdr");
  const keep = (value) => (props.value = value);
  const view = new View(root, { keep, ask: () => trigger("input"), editable: props.editable, usual: props.usual });
  const sync = () => view.sync(props);
  watch(["text", "shown", "checked"], sync);
  sync();
  root.view = view;
}
