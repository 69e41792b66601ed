// Posing: people stand still at a frame and can be pulled at by handles over their hands, feet, hips and heads. What
// comes of it goes to the player's director, such as a story, which keeps it.

import { node } from "./node.js";
import { FIELD_OF_VIEW, axesOf } from "./orbit.js";
import { put } from "./overlay.js";
import { HANDLES, carry, pull } from "./reach.js";
import { say } from "../texts.js";

const KEY_STEP = 0.02; // metres; with Shift five times as far
const WORLD = ([z, x, y]) => [x, y, z].map((v) => Math.round(1e5 * v) / 1e5);
const KEYS = {
  ArrowLeft: ["right", -1], ArrowRight: ["right", 1], ArrowDown: ["up", -1], ArrowUp: ["up", 1],
  PageDown: ["back", 1], PageUp: ["back", -1],
};

export class Posing {
  /** Begins at the frame that `player` shows. `posed` holds poses of people that are kept there already, or null. */
  constructor(player, posed) {
    this.player = player;
    this.frame = Math.round(player.clock.shown);
    this.pose = player.everybody(this.frame).map((points, person) => posed[person] ?? points);
    this.changed = this.pose.map(() => false);
    this.steps = []; // what the pose was before each pull
    this.held = null;
    this.host = player.find(".pdd-handles");
    this.bar = player.find(".pdd-posing");
    this.opener = player.root.contains(document.activeElement) ? document.activeElement : player.root;
    this.listen();
    this.lay();
    this.place(player.pane.spots);
    this.focus(this.handles.find((handle) => handle.style.visibility !== "hidden"));
  }

  listen() {
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.host.addEventListener("pointerdown", (event) => this.begin(event), { signal });
    this.host.addEventListener("pointermove", (event) => this.drag(event), { signal });
    this.host.addEventListener("pointerup", () => this.release(true), { signal });
    this.host.addEventListener("pointercancel", () => this.release(false), { signal });
    this.host.addEventListener("focusin", (event) => this.choose(event.target), { signal });
    this.bar.addEventListener("click", (event) => this.press(event), { signal });
    this.player.root.addEventListener("keydown", (event) => this.key(event), { signal, capture: true });
  }

  /** One button a handle, in the order of people and HANDLES. */
  lay() {
    this.handles = this.pose.flatMap((_, person) => HANDLES.map(([joint, name]) => {
      const handle = node("button", `pdd-handle pdd-handle-${"ab"[person]}`);
      Object.assign(handle.dataset, { person, joint });
      handle.title = say("player.joint_of", { joint: name[0].toUpperCase() + name.slice(1), person: "AB"[person] });
      handle.setAttribute("aria-label", say("player.handle", { joint: handle.title }));
      return handle;
    }));
    this.host.replaceChildren(...this.handles);
    this.host.hidden = this.bar.hidden = false;
  }

  /** Puts the handles over their joints; `spots` [person][joint] are project() results. */
  place(spots) {
    this.spots = spots;
    for (const handle of this.handles) {
      const spot = spots[handle.dataset.person][handle.dataset.joint];
      if (spot[2] <= 0.1 && handle === document.activeElement) this.focus(this.player.root);
      put(handle, spot);
    }
  }

  // ---- the focus: Tab goes from joint to joint and on to the buttons; it never gets lost ------------

  focus(element) {
    (element ?? this.player.root).focus({ preventScroll: true });
  }

  choose(handle) {
    this.chosen = handle;
    this.say();
  }

  say() {
    const { bar } = this;
    const any = this.changed.some(Boolean);
    for (const [act, enabled] of [["keep", any], ["back", this.steps.length > 0]]) {
      const button = bar.querySelector(`[data-pose=${act}]`);
      if (!enabled && button === document.activeElement) this.focus(this.chosen); // a disabled button loses the focus
      button.disabled = !enabled;
    }
    const seconds = (this.frame / this.player.clock.fps).toFixed(2);
    const who = this.changed.flatMap((is, person) => (is ? ["AB"[person]] : [])).join(say("player.and"));
    const where = this.chosen ? say("player.joint_at", { joint: this.chosen.title, seconds }) : say("player.at", { seconds });
    bar.querySelector("output").textContent = `${where}: ${say(who ? "player.changed" : "player.drag_joint", { who })}`;
  }

  /** Shows that the pose must be kept or given up first. */
  remind() {
    this.bar.querySelector("output").textContent = say("player.keep_first");
    this.bar.querySelector("[data-pose=keep]").focus({ preventScroll: true });
    this.player.wake(); // the slider goes back
  }

  // ---- pulling -----------------------------------------------------------------------------------

  begin(event) {
    const handle = event.target.closest(".pdd-handle");
    if (!handle || event.button || this.held) return;
    event.preventDefault();
    handle.focus({ preventScroll: true });
    handle.setPointerCapture(event.pointerId);
    const [person, joint] = [Number(handle.dataset.person), Number(handle.dataset.joint)];
    const depth = this.spots[person][joint][2];
    const { clientHeight } = this.player.pane.host;
    this.held = {
      handle, person, joint, id: event.pointerId, before: this.pose[person], from: [event.clientX, event.clientY],
      whole: event.shiftKey, metres: (2 * Math.tan(FIELD_OF_VIEW / 2) * depth) / clientHeight,
    };
    handle.classList.add("pdd-held");
  }

  drag(event) {
    const { held } = this;
    if (!held || event.pointerId !== held.id) return;
    const { right, up } = this.axes;
    const [dx, dy] = [event.clientX - held.from[0], event.clientY - held.from[1]];
    const by = [0, 1, 2].map((i) => held.metres * (dx * right[i] - dy * up[i]));
    this.move(held.person, held.joint, held.before, by, held.whole);
  }

  get axes() {
    const { yaw, elevation } = this.player.orbit;
    return axesOf(yaw, elevation);
  }

  /** A person's pose as `before`, with a joint pulled away from where it was; with the whole person where `whole`. */
  move(person, joint, before, by, whole) {
    const target = before[joint].map((v, i) => v + by[i]);
    this.pose = this.pose.map((points, i) => {
      if (i !== person) return points;
      return whole ? carry(before, by) : pull(before, joint, target);
    });
    this.player.wake();
  }

  /** Ends a pull, which is kept as a step or undone. */
  release(kept) {
    const { held } = this;
    if (!held) return;
    this.held = null;
    held.handle.classList.remove("pdd-held");
    if (!kept) {
      this.pose = this.pose.map((points, i) => (i === held.person ? held.before : points));
      this.player.wake();
    } else if (this.pose[held.person] !== held.before) this.remember(held.person, held.before);
  }

  remember(person, before) {
    this.steps.push({ person, before, changed: this.changed[person] });
    this.changed = this.changed.map((is, i) => is || i === person);
    this.say();
  }

  back() {
    const step = this.steps.pop();
    if (!step) return;
    this.pose = this.pose.map((points, i) => (i === step.person ? step.before : points));
    this.changed = this.changed.map((is, i) => (i === step.person ? step.changed : is));
    this.say();
    this.player.wake();
  }

  // ---- keys and buttons ----------------------------------------------------------------------------

  press(event) {
    const act = event.target.closest("[data-pose]")?.dataset.pose;
    if (act === "keep") this.keep();
    else if (act === "back") this.back();
    else if (act === "cancel") this.player.directing.endPosing();
  }

  key(event) {
    const { target } = event;
    const handle = target.closest(".pdd-handle");
    if (event.key === "Escape") this.held ? this.release(false) : this.player.directing.endPosing();
    else if (event.key === "Enter" && !target.closest(".pdd-posing")) this.keep();
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") this.back();
    else if (handle && event.key in KEYS && !this.held) this.nudge(handle, ...KEYS[event.key], event);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  nudge(handle, axis, sign, { shiftKey, altKey }) {
    const [person, joint] = [Number(handle.dataset.person), Number(handle.dataset.joint)];
    const before = this.pose[person];
    const by = this.axes[axis].map((v) => sign * (shiftKey ? 5 : 1) * KEY_STEP * v);
    this.move(person, joint, before, by, altKey);
    this.remember(person, before);
  }

  /** Hands what was changed to the director, in world axes, and ends. */
  keep() {
    const kept = this.pose.map((points, person) => ({ person: "ab"[person], positions: points.map(WORLD) }));
    const changed = kept.filter((_, person) => this.changed[person]);
    const { player, frame } = this;
    if (!changed.length) return;
    player.directing.endPosing();
    player.directing.director.keepPoses(frame, changed);
  }

  close() {
    this.abort.abort();
    if ([this.host, this.bar].some((part) => part.contains(document.activeElement))) this.focus(this.opener);
    this.host.replaceChildren();
    this.host.hidden = this.bar.hidden = true;
  }
}
