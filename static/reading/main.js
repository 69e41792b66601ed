// What is understood of the prompt, under it: the sentence with its marks, and its plan as chips on two lanes.

import { Asking } from "./asking.js";
import { people, pieces, spoken, summary, wordsOf } from "./marks.js";

const NAMES = { a: "A", b: "B", ab: "A and B" };

/** An element with a class and a text. */
function node(tag, kind, text = "") {
  const made = document.createElement(tag);
  made.className = kind;
  made.textContent = text;
  return made;
}

class View {
  /** `ask` sends a text to the server. */
  constructor(root, ask) {
    this.root = root;
    this.asking = new Asking(ask);
    this.shown = null;
    for (const kind of ["pointerover", "focusin"]) root.addEventListener(kind, (event) => this.point(event.target));
    for (const kind of ["pointerleave", "focusout"]) root.addEventListener(kind, () => this.point(null));
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  /** What is typed now. */
  typed(text) {
    if (!this.asking.typed(text)) return;
    const current = this.asking.answers(this.shown);
    this.root.hidden = !text.trim() || !this.shown;
    this.root.classList.toggle("pdr-old", !current);
  }

  /** What the server understood. */
  answer(shown) {
    if (!shown || shown === this.shown || !this.asking.answers(shown)) return;
    this.shown = shown;
    this.draw();
  }

  draw() {
    const { plan, error } = this.shown;
    this.root.classList.remove("pdr-old");
    this.root.hidden = false;
    this.find(".pdr-said").replaceChildren(...(plan ? this.sentence(plan) : []));
    this.find(".pdr-unread").replaceChildren(...(plan ? plan.unread.map((part) => this.unread(part)) : []));
    this.find(".pdr-plan").hidden = !plan?.acts.length;
    this.find(".pdr-beats").replaceChildren(...(plan ? this.shown.beats.map((beat) => this.beat(beat)) : []));
    const notes = plan ? plan.notes.filter((note) => !plan.unread.some((part) => part.why === note)) : [error];
    this.find(".pdr-notes").replaceChildren(...notes.map((note) => node("p", plan ? "" : "pdr-error", note)));
    this.find(".pdr-heard").textContent = plan ? summary(plan) : error;
  }

  sentence(plan) {
    return pieces(plan.sentence, plan.acts, plan.unread).map((piece) => {
      if (!piece.who && piece.unread < 0) return document.createTextNode(piece.text);
      const made = node("span", `pdr-words ${[...piece.who].map((who) => `pdr-${who}`).join(" ")}`, piece.text);
      made.classList.toggle("pdr-lost", piece.unread >= 0);
      made.dataset.acts = piece.acts.join(" ");
      const said = piece.acts.map((id) => this.shown.said[id]).join(", ");
      made.title = piece.who ? `${NAMES[piece.who]}: ${said}` : plan.unread[piece.unread].why;
      return made;
    });
  }

  unread(part) {
    const row = node("li", "");
    row.append(node("q", "pdr-lost", wordsOf(this.shown.plan.sentence, part.words)), ` ${part.why}`);
    if (part.nearest.length) {
      const near = part.nearest.map((name) => this.shown.nearest[name] ?? name);
      row.append(node("span", "pdr-near", ` Nearest: ${near.join(", ")}.`));
    }
    return row;
  }

  beat(ids) {
    const row = node("li", "pdr-beat");
    const acts = this.shown.plan.acts;
    row.append(...ids.map((id) => this.chip(acts.find((act) => act.id === id))));
    return row;
  }

  chip(act) {
    const said = this.shown.said[act.id];
    const made = node("span", `pdr-chip pdr-${act.agents.join("")}`);
    made.classList.toggle("pdr-not", act.polarity === "not" || act.modality !== "told");
    made.dataset.id = act.id;
    const heard = node("span", "pdr-heard", spoken(act, said));
    const seen = node("span", "");
    seen.ariaHidden = "true";
    seen.append(node("b", "", people(act)), ` ${said}`);
    made.append(seen, heard);
    return made;
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
}

/** `element` holds reading.html; `props` are the component's, watched by `watch`; `trigger` tells the server. */
export function mount(element, props, watch, trigger) {
  const root = element.querySelector(".pdr");
  const view = new View(root, (text) => {
    props.value = { text };
    trigger("input");
  });
  const sync = () => {
    view.typed(props.text ?? "");
    view.answer(props.shown);
  };
  watch(["text", "shown"], sync);
  sync();
  root.view = view;
}
