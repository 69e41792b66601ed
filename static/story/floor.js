// The floor seen from above: paths are drawn with the pointer, and their points moved with the pointer or the arrow keys.

import { edges, path, pathOf } from "./edits.js";
import { say } from "../texts.js";

const EDGE = 8;
const STEP = 0.35; // metres between two points of a drawn path
const NEAR = 0.5; // metres from where a person stands within which a drawn path begins there
const NAMES = { a: "A", b: "B" };
const SVG = "http://www.w3.org/2000/svg";
const make = (name, attributes, parent) => {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  parent?.append(node);
  return node;
};
const inside = (value) => Math.round(100 * Math.min(Math.max(value, -EDGE), EDGE)) / 100;

/** The place [x, z] of each person of a motion at a moment; it stands still before its beginning and after its end. */
export function placesAt(motion, seconds) {
  return (motion?.tracks ?? []).map((track) => track[Math.min(Math.max(Math.round(seconds / motion.step), 0), track.length - 1)]);
}

/** A point is [seconds or null, x, z] with or without a heading; the picture has x to the right and z upwards. */
export class Floor {
  constructor(root, editor) {
    this.editor = editor;
    this.svg = root.querySelector("svg");
    this.root = root;
    this.svg.addEventListener("pointerdown", (event) => this.begin(event));
    this.svg.addEventListener("pointermove", (event) => this.drag(event));
    this.svg.addEventListener("pointerup", () => this.end());
    this.svg.addEventListener("pointercancel", () => this.end());
    this.svg.addEventListener("keydown", (event) => this.key(event));
  }

  get person() {
    return this.root.querySelector("[data-field=who]:checked").value;
  }

  at(event) {
    const box = this.svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 * EDGE - EDGE;
    const z = EDGE - ((event.clientY - box.top) / box.height) * 2 * EDGE;
    return [inside(x), inside(z)];
  }

  begin(event) {
    if (event.button) return;
    event.preventDefault();
    this.svg.setPointerCapture(event.pointerId);
    const { story } = this.editor;
    const [x, z] = this.at(event);
    const point = event.target.dataset?.point;
    if (point) {
      const person = event.target.dataset.person;
      this.held = { person, index: Number(point), points: pathOf(story, person).map((p) => [...p]) };
      return;
    }
    const stands = this.standing(this.person);
    const near = stands && Math.hypot(x - stands[0], z - stands[1]) < NEAR;
    this.held = { person: this.person, drawn: true, points: [[this.start, ...(near ? stands : [x, z])]] };
  }

  /** Seconds at which the selected beat begins, and a path that is drawn now. */
  get start() {
    const { story, selected } = this.editor;
    return story.beats.length ? edges(story)[Math.max(selected, 0)] : 0;
  }

  /** The place at which the motion that is shown has a person at that time, if there is one. */
  standing(person) {
    return placesAt(this.editor.props.motion, this.start)["ab".indexOf(person)];
  }

  drag(event) {
    if (!this.held) return;
    const [x, z] = this.at(event);
    const { points, index, drawn } = this.held;
    if (drawn) {
      const [, lastX, lastZ] = points.at(-1);
      if (Math.hypot(x - lastX, z - lastZ) < STEP) return;
      points.push([null, x, z]);
    } else {
      points[index][1] = x;
      points[index][2] = z;
    }
    this.draw(path(this.editor.story, this.held.person, points));
  }

  end() {
    if (!this.held) return;
    const { person, points, drawn } = this.held;
    this.held = null;
    if (drawn && points.length < 2) return this.draw(this.editor.story);
    this.editor.edit(path(this.editor.story, person, points));
  }

  key(event) {
    const { point, person } = event.target.dataset ?? {};
    if (point === undefined) return;
    const steps = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    const points = pathOf(this.editor.story, person).map((p) => [...p]);
    const index = Number(point);
    if (event.key in steps) {
      points[index][1] = inside(points[index][1] + steps[event.key][0]);
      points[index][2] = inside(points[index][2] + steps[event.key][1]);
    } else if (event.key === "Delete" || event.key === "Backspace") points.splice(index, 1);
    else return;
    event.preventDefault();
    this.editor.edit(path(this.editor.story, person, points));
    this.svg.querySelector(`[data-person="${person}"][data-point="${Math.min(index, points.length - 1)}"]`)?.focus();
  }

  /** The point where the person stands, or one after the last, half a metre on: for the keyboard. */
  addPoint() {
    const { story } = this.editor;
    const points = pathOf(story, this.person).map((p) => [...p]);
    const last = points.at(-1);
    points.push(last ? [null, last[1], inside(last[2] + 0.5)] : [this.start, ...(this.standing(this.person) ?? [0, 0])]);
    this.editor.edit(path(story, this.person, points));
  }

  clear() {
    this.editor.edit(path(this.editor.story, this.person, []));
  }

  draw(story) {
    this.svg.replaceChildren();
    for (let i = -EDGE; i <= EDGE; i += 1) {
      const strong = i === 0 ? "pds-axis" : "pds-grid";
      make("line", { x1: i, x2: i, y1: -EDGE, y2: EDGE, class: strong }, this.svg);
      make("line", { y1: i, y2: i, x1: -EDGE, x2: EDGE, class: strong }, this.svg);
    }
    this.drawMotion(story);
    for (const { person, points } of story.paths) {
      const group = make("g", { class: `pds-path pds-${person}` }, this.svg);
      make("polyline", { points: points.map(([, x, z]) => `${x},${-z}`).join(" ") }, group);
      points.forEach(([seconds, x, z], i) => {
        const named = seconds === null ? "" : say("story.at", { seconds: seconds.toFixed(1) });
        const label = say("story.point", { number: i + 1, person: NAMES[person], x, z }) + named;
        const dot = make("circle", {
          cx: x, cy: -z, r: i ? 0.13 : 0.2, tabindex: 0, role: "button", "aria-label": label,
          "data-point": i, "data-person": person,
        }, group);
        make("title", {}, dot).textContent = label;
      });
    }
  }

  /** Where the people of the motion walk, stronger in the selected beat, and where they stand when it begins. */
  drawMotion(story) {
    const { motion } = this.editor.props;
    const places = placesAt(motion, this.start);
    const line = (points) => points.map(([x, z]) => `${x},${-z}`).join(" ");
    places.forEach(([x, z], i) => {
      const person = "ab"[i];
      const group = make("g", { class: `pds-track pds-${person}` }, this.svg);
      const track = motion.tracks[i];
      make("polyline", { points: line(track) }, group);
      const [from, to] = [this.start, this.until(story)].map((seconds) => Math.round(seconds / motion.step));
      make("polyline", { points: line(track.slice(from, to + 1)), class: "pds-now" }, group);
      make("circle", { cx: x, cy: -z, r: 0.3 }, group);
      const label = say("story.stands", { person: NAMES[person], x, z, seconds: this.start.toFixed(1) });
      make("text", { x, y: 0.15 - z, role: "img", "aria-label": label }, group).textContent = NAMES[person];
    });
  }

  /** Seconds at which the selected beat ends. */
  until(story) {
    return story.beats.length ? edges(story)[Math.max(this.editor.selected, 0) + 1] : Infinity;
  }
}
