// Saying a touch by pressing where it is: dots over parts of the bodies. The press goes to the player's director, which
// puts it into words, such as the prompt of the next run.

import { say } from "../texts.js";

/** The parts that can be pressed: [joint, its English word, which a prompt has]. */
export const PARTS = [
  ["head", "head"], ["left_shoulder", "shoulder"], ["right_shoulder", "shoulder"], ["spine3", "chest"],
  ["left_elbow", "arm"], ["right_elbow", "arm"], ["left_wrist", "hand"], ["right_wrist", "hand"],
  ["left_knee", "knee"], ["right_knee", "knee"], ["left_foot", "foot"], ["right_foot", "foot"],
];

/** The sentence in which the other person touches a part of a person, "a" or "b". */
export function touchOf(person, part) {
  return `Person ${person === "a" ? "B" : "A"} touches person ${person.toUpperCase()}'s ${part}.`;
}

/** A text with a sentence more, which begins a sentence of its own. */
export function withSentence(text, sentence) {
  const before = text.trimEnd();
  if (!before) return sentence;
  return `${before}${/[.!?…]$/.test(before) ? "" : "."} ${sentence}`;
}

export class Touching {
  /** Lays the dots over the people at the frame that `player` shows. */
  constructor(player) {
    this.player = player;
    this.host = player.find(".pdd-handles");
    this.opener = player.root.contains(document.activeElement) ? document.activeElement : player.root;
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.host.addEventListener("click", (event) => this.press(event.target.closest(".pdd-handle")), { signal });
    player.root.addEventListener("keydown", (event) => this.key(event), { signal, capture: true });
    this.lay();
    const { spots } = player.pane;
    if (spots) this.place(spots);
    this.handles.find((handle) => handle.style.visibility !== "hidden")?.focus({ preventScroll: true });
  }

  /** One button a part, of one person after the other. */
  lay() {
    const { names } = this.player.data;
    this.handles = this.player.sample.roles.flatMap((_, person) => PARTS.map(([joint, part]) => {
      const handle = document.createElement("button");
      handle.type = "button";
      handle.className = `pdd-handle pdd-handle-touch pdd-handle-${"ab"[person]}`;
      Object.assign(handle.dataset, { person, joint: names.indexOf(joint), part });
      handle.title = touchOf("ab"[person], part);
      handle.ariaLabel = say("player.touch_part", { sentence: handle.title });
      return handle;
    }));
    this.host.replaceChildren(...this.handles);
    this.host.hidden = false;
  }

  /** Puts the dots over their joints; `spots` [person][joint] are project() results. */
  place(spots) {
    for (const handle of this.handles) {
      const [x, y, depth] = spots[handle.dataset.person][handle.dataset.joint];
      handle.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      handle.style.zIndex = String(1000 - Math.round(10 * Math.min(depth, 99)));
      handle.style.visibility = depth > 0.1 ? "visible" : "hidden";
    }
  }

  press(handle) {
    if (!handle) return;
    const { director, directing } = this.player;
    const { person, part } = handle.dataset;
    directing.endTouching();
    director.say(touchOf("ab"[person], part));
  }

  key(event) {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    this.player.directing.endTouching();
  }

  close() {
    this.abort.abort();
    if (this.host.contains(document.activeElement)) this.opener.focus({ preventScroll: true });
    this.host.replaceChildren();
    this.host.hidden = true;
  }
}
