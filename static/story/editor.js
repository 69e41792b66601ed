// The story under the player: beats as blocks in three lanes, a span, poses, and chips of the paths that are drawn on
// the stage. Its value is a story.

import { chips } from "../player/paths/walks.js";
import * as edits from "./edits.js";
import { block, drawRuler, pin } from "./lanes.js";
import { node } from "../player/node.js";
import { say } from "../texts.js";

const LANES = [["words", say("story.both")], ["a", "A"], ["b", "B"]];
const PIXELS = 16; // a second, at least

const plain = (story) => JSON.stringify({ ...story, ahead: false });

/** Calls `drag` with each move of the pointer on `target` and `end` once it is let go. */
function follow(target, drag, end) {
  const left = new AbortController();
  target.addEventListener("pointermove", drag, left);
  for (const kind of ["pointerup", "pointercancel"]) target.addEventListener(kind, () => [left.abort(), end()], left);
}

/** The editor of a story: it shows one and tells of each change. */
class Editor {
  /** `kept` takes the story as the component's value; `changed` tells the server that the user changed it. */
  constructor(root, kept, changed) {
    this.root = root;
    this.kept = kept;
    this.changed = changed;
    this.story = edits.empty();
    this.selected = 0;
    this.past = new edits.Past();
    this.note = null; // stands in for the hint until the next change
    this.shown = 0; // seconds of the motion in the player
    root.addEventListener("click", (event) => this.press(event));
    root.addEventListener("change", (event) => this.field(event));
    root.addEventListener("keydown", (event) => this.key(event));
    const ruler = this.find(".pds-ruler");
    ruler.addEventListener("pointerdown", (event) => this.select(event, ruler));
    this.timer = setInterval(() => this.tick(), 80);
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  get player() {
    return this.root.closest(".pd-results")?.querySelector(".pdd")?.player;
  }

  /** As the player asks for them: each person's kept pose at a frame, or null. */
  posesAt(frame) {
    return ["a", "b"].map((person) => edits.poseAt(this.story, person, frame)?.positions ?? null);
  }

  /** What was posed in the player becomes a part of the story, and the time around it is selected. */
  keepPoses(frame, poses) {
    let story = this.story;
    for (const { person, positions } of poses) story = edits.pose(story, person, frame, positions);
    if (this.shown) story = { ...story, span: edits.spanAround(edits.momentOf(frame), this.shown) };
    this.edit(story);
    this.tell(say("story.pinned"));
  }

  get paths() {
    return this.story.paths;
  }

  keepPath(person, points) {
    this.edit(edits.path(this.story, person, points));
    this.tell(say("story.walked"));
  }

  /** Goes back to the story before, or forward again. */
  travel(way) {
    const next = this.past.travel(way, this.story);
    if (next !== this.story) this.show(next);
  }

  /** Seconds that the line shows: the story's, or those of the motion in the player where that is longer. */
  get total() {
    return Math.max(edits.edges(this.story).at(-1), this.shown, 1);
  }

  /** The value as the server gave it. */
  load(story) {
    if (story === this.given) return;
    this.given = story;
    const next = edits.read(story);
    if (plain(next) === this.sent) {
      this.story = { ...this.story, ahead: next.ahead };
      return;
    }
    this.keepPast();
    this.story = next;
    this.sent = plain(next);
    this.bound();
    this.draw();
  }

  /** The beats, paths and poses that the text over the line gives, unless they were changed since it was written. */
  lay(laid) {
    if (!laid || laid.at === this.laid) return;
    const { at, ...beats } = laid;
    this.laid = at;
    if (this.story.ahead) return;
    this.keepPast();
    this.hold(edits.read({ ...this.story, ...beats, span: null }));
    this.bound();
    this.draw();
  }

  /** The story becomes the component's value. */
  hold(story) {
    this.story = this.given = story;
    this.sent = plain(story);
    this.kept(story);
  }

  keepPast() {
    if (this.story.beats.length) this.past.keep(this.story);
  }

  bound() {
    this.selected = Math.min(Math.max(this.selected, 0), this.story.beats.length - 1);
  }

  /** Lengths that follow from the words, as the server worked them out. */
  measure(lengths) {
    if (!lengths || lengths.length !== this.story.beats.length) return;
    const story = edits.measured(this.story, lengths);
    const moved = JSON.stringify(story.poses) !== JSON.stringify(this.story.poses);
    this.story = story;
    if (moved) this.hold(story); // poses move with their beats
    this.draw();
  }

  /** A change by the user. */
  edit(story) {
    if (story === this.story) return this.draw();
    this.past.keep(this.story);
    this.note = null;
    this.show(story);
  }

  show(next) {
    const ahead = this.story.ahead || edits.wordsOf(next) !== edits.wordsOf(this.story);
    this.hold({ ...next, ahead });
    this.bound();
    this.draw();
    this.changed();
  }

  // ---- events ----------------------------------------------------------------------------------

  press(event) {
    const cell = event.target.closest?.(".pds-cell");
    if (cell) return this.write(Number(cell.dataset.beat), cell.dataset.lane);
    const pressed = event.target.closest?.(".pds-pin");
    if (pressed) {
      this.player?.act("pause");
      this.player?.seek(edits.frameOf(this.story.poses[pressed.dataset.pose].seconds));
      return;
    }
    const act = event.target.closest?.("[data-act]")?.dataset.act;
    if (!act) return;
    const { story, selected } = this;
    if (act === "add") {
      this.selected = story.beats.length ? selected + 1 : 0;
      this.edit(edits.add(story, selected, say("story.new_words")));
      this.write(this.selected, "words");
    } else if (act === "undo" || act === "redo") this.travel(act);
    else if (act === "no-span") this.edit({ ...story, span: null });
    else if (story.beats.length) this.change(act);
  }

  /** What is done to the selected beat. */
  change(act) {
    const { story, selected } = this;
    if (act === "split") this.edit(edits.split(story, selected));
    else if (act === "delete") this.edit(edits.remove(story, selected));
    else if (act === "again") this.edit(edits.change(story, selected, { seed: Math.floor(Math.random() * 2 ** 32) }));
    else {
      const by = act === "left" ? -1 : 1;
      const next = edits.move(story, selected, by);
      if (next !== story) this.selected += by;
      this.edit(next);
    }
  }

  field(event) {
    const { field } = event.target.dataset;
    const { story, selected } = this;
    const value = Number(event.target.value);
    if (field === "seconds" && story.beats.length) {
      const free = event.target.value === "";
      this.edit(free ? edits.change(story, selected, { seconds: null }) : edits.stretch(story, selected, value));
    } else if (field === "loop") this.edit({ ...story, loop: event.target.checked });
    else if (field === "from" || field === "to") {
      const [from, to] = ["from", "to"].map((name) => Number(this.find(`[data-field=${name}]`).value));
      if (to > from) this.edit({ ...story, span: [from, Math.min(to, this.total)] });
    }
  }

  key(event) {
    const cell = event.target.closest?.(".pds-cell");
    const arrow = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const pinned = event.target.closest?.(".pds-pin");
    if (pinned && (arrow || event.key === "Delete")) this.changePin(Number(pinned.dataset.pose), arrow, event.shiftKey ? 10 : 1);
    else if (cell && arrow) {
      if (event.altKey) this.change(arrow < 0 ? "left" : "right");
      else this.selected = Math.min(Math.max(this.selected + arrow, 0), this.story.beats.length - 1);
      this.draw();
      this.find(`.pds-cell[data-beat="${this.selected}"][data-lane="${cell.dataset.lane}"]`)?.focus();
    } else if (cell && event.key === "Delete") this.change("delete");
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && event.target.tagName !== "TEXTAREA") {
      this.travel(event.shiftKey ? "redo" : "undo");
    } else return;
    event.preventDefault();
  }

  /** Moves a pose by so many frames, or takes it away where there is no arrow. */
  changePin(index, arrow, frames) {
    const { story } = this;
    if (!arrow) return this.edit(edits.removePose(story, index));
    const { person, seconds } = story.poses[index];
    const frame = Math.max(edits.frameOf(seconds) + arrow * frames, 0);
    this.edit(edits.movePose(story, index, frame));
    const moved = this.story.poses.indexOf(edits.poseAt(this.story, person, frame));
    this.find(`.pds-pin[data-pose="${moved}"]`)?.focus({ preventScroll: true });
  }

  /** Opens a field for the words of a lane over its block. */
  write(index, lane) {
    this.selected = index;
    this.draw();
    const cell = this.find(`.pds-cell[data-beat="${index}"][data-lane="${lane}"]`);
    if (!cell) return;
    const field = node("textarea", "pds-words");
    field.value = this.story.beats[index][lane] ?? "";
    field.rows = 2;
    field.maxLength = 400;
    field.setAttribute("aria-label", cell.getAttribute("aria-label"));
    let open = true;
    const close = (keep, focus) => {
      if (!open) return;
      open = false;
      const words = field.value.trim();
      field.remove();
      const before = this.story.beats[index]?.[lane] ?? "";
      if (keep && words !== before) this.edit(edits.change(this.story, index, { [lane]: words }));
      else if (this.late) this.draw();
      if (focus) this.find(`.pds-cell[data-beat="${index}"][data-lane="${lane}"]`)?.focus();
    };
    field.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter" && !event.shiftKey) close(true, true);
      else if (event.key === "Escape") close(false, true);
      else return;
      event.preventDefault();
    });
    field.addEventListener("blur", () => close(true, false));
    const { left, width } = cell.parentElement.style;
    Object.assign(field.style, { left: `max(0px, min(${left}, 100% - 240px))`, minWidth: `max(${width}, 240px)` });
    cell.closest(".pds-lane").append(field);
    field.focus();
    field.select();
  }

  /** A span on the ruler: a press seeks, a drag selects. */
  select(event, ruler) {
    if (event.button) return;
    const box = ruler.getBoundingClientRect();
    const at = (x) => Math.round(10 * Math.min(Math.max((x - box.left) / box.width, 0), 1) * this.total) / 10;
    const first = at(event.clientX);
    this.player?.seek(edits.frameOf(first));
    ruler.setPointerCapture(event.pointerId);
    let span = null;
    const drag = (moved) => {
      const now = at(moved.clientX);
      span = Math.abs(now - first) >= edits.SHORTEST ? [Math.min(first, now), Math.max(first, now)] : null;
      this.drawSpan(span);
    };
    follow(ruler, drag, () => span && this.edit({ ...this.story, span }));
  }

  stretchBy(event, index) {
    event.preventDefault();
    event.stopPropagation();
    const wide = this.find(".pds-lanes").clientWidth / this.total;
    const [from, before, story] = [event.clientX, edits.lengthOf(this.story.beats[index]), this.story];
    let next = story;
    const drag = (moved) => {
      next = edits.stretch(story, index, before + (moved.clientX - from) / wide);
      this.find(".pds-hint").textContent = say("story.beat_length", { number: index + 1, seconds: next.beats[index].seconds });
    };
    follow(window, drag, () => next !== story && this.edit(next));
  }

  tick() {
    if (!this.root.isConnected) return clearInterval(this.timer);
    const { player } = this;
    if (player && player.directing.director !== this) player.directing.direct(this);
    const seconds = player?.data ? player.clock.duration : 0;
    if (seconds !== this.shown) {
      this.shown = seconds;
      this.draw();
    }
    const frame = player?.frameShown;
    if (frame == null || !this.root.offsetParent) return;
    this.find(".pds-playhead").style.left = `${(100 * frame) / 30 / this.total}%`;
  }

  // ---- drawing ---------------------------------------------------------------------------------

  draw() {
    this.late = Boolean(this.find(".pds-words"));
    if (this.late) return; // it is drawn when that is over
    const { story, total } = this;
    const starts = edits.edges(story);
    const focused = this.root.contains(document.activeElement) && document.activeElement.dataset.key;
    this.find(".pds-line").style.minWidth = `${Math.round(PIXELS * total)}px`;
    this.player?.root.style.setProperty("--pds-share", (this.shown || total) / total); // its line ends where the motion does
    const lanes = this.find(".pds-lanes");
    lanes.replaceChildren();
    for (const [lane, name] of LANES) {
      const row = node("div", `pds-lane pds-lane-${lane}`);
      row.append(node("span", "pds-name", name));
      const stretch = (event, index) => this.stretchBy(event, index);
      story.beats.forEach((beat, i) => row.append(
        block(beat, i, { lane, name, starts, total, selected: i === this.selected, stretch }),
      ));
      story.poses.forEach((pose, i) => pose.person === lane && row.append(pin(pose, i, total)));
      lanes.append(row);
    }
    if (focused) this.find(`[data-key="${focused}"]`)?.focus({ preventScroll: true });
    drawRuler(this.find(".pds-ruler"), total);
    this.drawSpan(story.span);
    chips(this.find(".pds-walks"), story.paths, (person) => this.keepPath(person, []));
    this.player?.refresh(); // it shows poses
    const beat = story.beats[this.selected];
    this.find("[data-field=seconds]").value = beat ? edits.lengthOf(beat) : "";
    this.find("[data-field=loop]").checked = story.loop;
    this.find("[data-field=from]").value = story.span?.[0] ?? "";
    this.find("[data-field=to]").value = story.span?.[1] ?? "";
    for (const part of this.root.querySelectorAll("[data-of=beat]")) part.disabled = !beat;
    this.find("[data-act=undo]").disabled = !this.past.before.length;
    this.find("[data-act=redo]").disabled = !this.past.after.length;
    this.find("[data-act=no-span]").disabled = !story.span;
    const said = beat ? this.summary(beat) : say("story.empty");
    this.find(".pds-hint").textContent = this.note ?? said;
  }

  /** Says something in place of the hint, until the next change. */
  tell(note) {
    this.note = note;
    this.find(".pds-hint").textContent = note;
  }

  summary(beat) {
    const length = `${edits.lengthOf(beat).toFixed(1)} s${beat.seconds == null ? say("story.from_words") : ""}`;
    const seed = beat.seed == null ? "" : say("story.seed", { seed: beat.seed });
    return say("story.beat", { number: this.selected + 1, facts: length + seed });
  }

  drawSpan(span) {
    const shown = this.find(".pds-span");
    shown.hidden = !span;
    if (!span) return;
    shown.style.left = `${(100 * span[0]) / this.total}%`;
    shown.style.width = `${(100 * (span[1] - span[0])) / this.total}%`;
  }
}

/** `element` holds story.html; `props` are the component's, watched by `watch`; `trigger` tells the server. */
export function mount(element, props, watch, trigger) {
  const root = element.querySelector(".pds");
  root.editor = new Editor(root, (story) => (props.value = story), () => trigger("input"));
  const sync = () => {
    root.editor.load(props.value);
    root.editor.lay(props.laid);
    root.editor.measure(props.lengths);
    root.editor.draw();
  };
  watch(["value", "laid", "lengths"], sync);
  sync();
}
