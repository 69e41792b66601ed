// Drawing on the floor of the stage: where people walk in the next run. What comes of it goes to the player's director,
// which keeps it.

import { node } from "../node.js";
import { FIELD_OF_VIEW, axesOf } from "../orbit.js";
import { project, put } from "../overlay.js";
import { floorUnder, inside, lengthOf, lines, named, onFloor, STEP } from "./walks.js";
import { say } from "../../texts.js";

const LEAST = 0.1; // metres of the last step of a path that is drawn
const KEYS = { ArrowLeft: ["right", -1], ArrowRight: ["right", 1], ArrowDown: ["away", -1], ArrowUp: ["away", 1] };

export class Drawing {
  constructor(player) {
    this.player = player;
    this.on = false;
    this.held = null;
    this.grips = player.find(".pdd-grips");
    this.lengths = player.find(".pdd-lengths");
    this.bar = player.find(".pdd-drawing");
    this.bar.querySelector("button").addEventListener("click", () => this.toggle(false));
    const { stage } = player;
    stage.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    stage.addEventListener("pointermove", (event) => this.drag(event));
    stage.addEventListener("pointerup", (event) => this.release(event));
    stage.addEventListener("pointercancel", () => this.drop());
    player.root.addEventListener("keydown", (event) => this.key(event), { capture: true });
  }

  get director() {
    return this.player.directing.director;
  }

  /** The paths for the next run, with the one that is drawn now. */
  get paths() {
    const kept = this.director?.paths ?? [];
    if (!this.held) return kept;
    const { person, points } = this.held;
    return [...kept.filter((path) => path.person !== person), { person, points }];
  }

  get seconds() {
    return Math.round(100 * (this.player.clock.shown / this.player.clock.fps)) / 100;
  }

  /** Places [x, z] of the people at the moment that is shown. */
  get places() {
    const { player } = this;
    return player.everybody(player.clock.shown).map((points) => [points[player.skeleton.pelvis][1], points[player.skeleton.pelvis][0]]);
  }

  /** The first point of a path: where a person is at the moment that is shown. */
  begun(person) {
    return [this.seconds, ...inside(this.places["ab".indexOf(person)])];
  }

  // ---- the mode ------------------------------------------------------------------------------------

  toggle(on = !this.on) {
    if (on === this.on) return;
    this.on = on;
    this.drop();
    this.bar.hidden = !on;
    if (on) {
      this.player.clock.pause();
      this.layGrips();
      this.say();
    } else {
      if ([this.grips, this.bar].some((part) => part.contains(document.activeElement))) this.player.root.focus({ preventScroll: true });
      this.grips.replaceChildren();
    }
    this.player.refresh();
  }

  layGrips() {
    const people = this.player.sample.roles.length;
    this.grips.replaceChildren(...["a", "b"].slice(0, people).map((person) => {
      const grip = node("button", `pdd-grip pdd-grip-${person}`, "✎");
      grip.dataset.person = person;
      grip.title = say("player.draw_path", { who: person.toUpperCase() });
      grip.ariaLabel = `${grip.title}: ${say("player.draw_path_keys")}`;
      return grip;
    }));
  }

  say(text = `${this.seconds.toFixed(1)} s: ${say("player.draw_rest")}`) {
    this.bar.querySelector("output").textContent = text;
  }

  // ---- hands ---------------------------------------------------------------------------------------

  floorAt(event) {
    const { player } = this;
    const box = player.stage.getBoundingClientRect();
    const { yaw, elevation, eye } = player.orbit;
    return floorUnder([event.clientX - box.left, event.clientY - box.top], { yaw, elevation, eye }, box.width, box.height);
  }

  begin(event) {
    const grip = event.target.closest(".pdd-grip");
    if (!grip || this.held || event.button) return;
    event.preventDefault();
    event.stopPropagation();
    this.player.clock.pause();
    const { person } = grip.dataset;
    this.held = { person, points: [this.begun(person)], id: event.pointerId };
    this.player.stage.setPointerCapture(event.pointerId);
    grip.focus({ preventScroll: true });
  }

  drag(event) {
    const { held } = this;
    if (!held || event.pointerId !== held.id) return;
    const at = this.floorAt(event);
    if (!at) return;
    held.end = inside(at);
    if (!this.further(held, STEP)) return;
    this.say(named(held.person, held.points));
    this.player.wake();
  }

  release(event) {
    const { held } = this;
    if (!held || event.pointerId !== held.id) return;
    this.held = null;
    if (held.end) this.further(held, LEAST);
    if (held.points.length > 1) this.keep(held.person, held.points);
    else this.say();
    this.player.wake();
  }

  /** Adds the place under the pointer to a path that is drawn, where that is so far from the last; says whether it did. */
  further(held, least) {
    const [, x, z] = held.points.at(-1);
    if (Math.hypot(held.end[0] - x, held.end[1] - z) < least) return false;
    held.points = [...held.points, [null, ...held.end]];
    return true;
  }

  drop() {
    this.held = null;
    this.player.wake();
  }

  /** Hands a path to the director. */
  keep(person, points) {
    this.director.keepPath(person, points);
    this.say(points.length ? say("player.drawn", { path: named(person, points) }) : undefined);
    this.player.refresh();
  }

  // ---- keys ----------------------------------------------------------------------------------------

  key(event) {
    if (!this.on) return;
    const grip = event.target.closest(".pdd-grip");
    if (event.key === "Escape") this.held ? this.drop() : this.toggle(false);
    else if (grip && event.key in KEYS) this.lengthen(grip.dataset.person, ...KEYS[event.key]);
    else if (grip && ["Delete", "Backspace"].includes(event.key)) this.keep(grip.dataset.person, []);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** A path one step longer. */
  lengthen(person, axis, sign) {
    const { right, back } = axesOf(this.player.orbit.yaw, 0);
    const way = axis === "right" ? right : back.map((v) => -v);
    const kept = this.director.paths.find((path) => path.person === person)?.points ?? [];
    const points = kept.length ? kept : [this.begun(person)];
    const [, x, z] = points.at(-1);
    this.keep(person, [...points, [null, ...inside([x + sign * STEP * way[1], z + sign * STEP * way[0]])]]);
  }

  // ---- drawing -------------------------------------------------------------------------------------

  /** Lays the lines on the floor of a pane. */
  lay(pane, theme) {
    const { paths } = this;
    const places = this.on ? this.places : [];
    if (paths.length || places.length) pane.scene.set("paths", lines(paths, places, theme.people.map(({ middle }) => middle)));
    else pane.drop(["paths"]);
  }

  /** Puts handles and lengths where they belong in the picture. */
  place({ matrix }) {
    const { clientWidth: width, clientHeight: height } = this.player.pane.host;
    const lay = (element, place, lift = 0) => {
      const [x, y, depth] = project(onFloor(place), matrix, width, height, FIELD_OF_VIEW);
      put(element, [x, y + lift, depth]);
    };
    const places = this.on ? this.places : [];
    for (const grip of this.grips.children) lay(grip, places["ab".indexOf(grip.dataset.person)]);
    const long = this.player.directing.alone ? this.paths.filter(({ points }) => points.length > 1) : [];
    while (this.lengths.children.length > long.length) this.lengths.lastChild.remove();
    while (this.lengths.children.length < long.length) this.lengths.append(node("span"));
    long.forEach(({ person, points }, i) => {
      const label = this.lengths.children[i];
      label.className = `pdd-length pdd-length-${person}`;
      label.textContent = `${lengthOf(points).toFixed(1)} m`;
      lay(label, points.at(-1).slice(1, 3), 18);
    });
  }
}
