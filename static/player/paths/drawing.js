// Drawing on the floor of the stage: where people walk in the next run, and where they are at the moment that is shown.
// What comes of it goes to the player's director, which keeps it.

import { FIELD_OF_VIEW, axesOf } from "../orbit.js";
import { project } from "../overlay.js";
import { floorUnder, inside, lengthOf, lines, named, onFloor, passing, STEP, trouble } from "./walks.js";
import { say } from "../../texts.js";

const NEAR = 0.4; // metres from a person's place on the floor within which a drag begins their path
const ASIDE = 0.5; // metres from there to the handle that moves them
const LEAST = 0.1; // metres of the last step of a path that is drawn
const NUDGE = 0.1; // metres; with Shift five times as far
const KEYS = { ArrowLeft: ["right", -1], ArrowRight: ["right", 1], ArrowDown: ["away", -1], ArrowUp: ["away", 1] };
const HANDLES = {
  path: { sign: "✎", title: "player.draw_path", keys: "player.draw_path_keys" },
  here: { sign: "✥", title: "player.here", keys: "player.here_keys" },
};

export class Drawing {
  constructor(player) {
    this.player = player;
    this.on = false;
    this.held = null;
    this.grips = player.find(".pdd-grips");
    this.lengths = player.find(".pdd-lengths");
    this.bar = player.find(".pdd-drawing");
    this.bar.addEventListener("click", (event) => this.press(event.target.closest("[data-draw]")?.dataset.draw));
    const { stage } = player;
    stage.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    stage.addEventListener("pointermove", (event) => this.drag(event));
    stage.addEventListener("pointerup", (event) => this.release(event));
    stage.addEventListener("pointercancel", () => this.drop());
    player.root.addEventListener("keydown", (event) => this.key(event), { capture: true });
  }

  get director() {
    return this.player.director;
  }

  /** The paths for the next run, with the one that is drawn now. */
  get paths() {
    const kept = this.director?.paths ?? [];
    if (!this.held) return kept;
    const { person, points } = this.held;
    return [...kept.filter((path) => path.person !== person), { person, points }];
  }

  pathOf(person) {
    return this.director.paths.find((path) => path.person === person)?.points ?? [];
  }

  get seconds() {
    return Math.round(100 * (this.player.clock.shown / this.player.clock.fps)) / 100;
  }

  /** Places [x, z] of the people at the moment that is shown. */
  get places() {
    const { player } = this;
    return player.everybody(player.clock.shown).map((points) => [points[player.skeleton.pelvis][1], points[player.skeleton.pelvis][0]]);
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
    const made = ["a", "b"].slice(0, people).flatMap((person) => Object.entries(HANDLES).map(([kind, { sign, title, keys }]) => {
      const grip = document.createElement("button");
      grip.type = "button";
      grip.className = `pdd-grip pdd-grip-${person}`;
      Object.assign(grip.dataset, { person, kind });
      grip.textContent = sign;
      grip.title = say(title, { who: person.toUpperCase() });
      grip.ariaLabel = `${grip.title}: ${say(keys)}`;
      return grip;
    }));
    this.grips.replaceChildren(...made);
  }

  say(text = "") {
    const rest = say("player.draw_rest");
    this.bar.querySelector("output").textContent = text || `${this.seconds.toFixed(1)} s: ${rest}`;
    this.bar.querySelector("[data-draw=undo]").disabled = !this.director.mayUndo;
  }

  press(act) {
    if (act === "undo") this.undo();
    else if (act === "done") this.toggle(false);
  }

  undo() {
    this.director.undo();
    this.say();
    this.player.refresh();
  }

  // ---- hands ---------------------------------------------------------------------------------------

  floorAt(event) {
    const { player } = this;
    const box = player.stage.getBoundingClientRect();
    const { yaw, elevation, eye } = player.orbit;
    return floorUnder([event.clientX - box.left, event.clientY - box.top], { yaw, elevation, eye }, box.width, box.height);
  }

  begin(event) {
    if (!this.on || this.held || event.button || event.shiftKey) return;
    const grip = event.target.closest(".pdd-grip");
    if (!grip && !event.target.closest(".pdd-touch")) return;
    const from = this.floorAt(event);
    const { places } = this;
    const gaps = places.map(([x, z]) => (from ? Math.hypot(from[0] - x, from[1] - z) : Infinity));
    const nearest = gaps.indexOf(Math.min(...gaps));
    if (!from || (!grip && gaps[nearest] > NEAR)) return;
    event.preventDefault();
    event.stopPropagation();
    this.player.clock.pause();
    const { person, kind } = grip?.dataset ?? { person: "ab"[nearest], kind: "path" };
    const place = places["ab".indexOf(person)];
    const before = this.pathOf(person);
    const points = kind === "path" ? [[this.seconds, ...inside(place)]] : before;
    this.held = { person, kind, points, place, from, id: event.pointerId };
    this.player.stage.setPointerCapture(event.pointerId);
    (grip ?? this.player.root).focus({ preventScroll: true });
  }

  drag(event) {
    const { held } = this;
    if (!held || event.pointerId !== held.id) return;
    const at = this.floorAt(event);
    if (!at) return;
    if (held.kind === "here") {
      held.now = held.place.map((v, i) => v + at[i] - held.from[i]);
      held.points = passing(this.pathOf(held.person), this.seconds, held.now, this.director.seconds);
    } else {
      held.end = inside(at);
      if (!this.further(held, STEP)) return;
    }
    this.say(trouble(held.points, this.director.seconds) || named(held.person, held.points));
    this.player.wake();
  }

  release(event) {
    const { held } = this;
    if (!held || event.pointerId !== held.id) return;
    this.held = null;
    if (held.end) this.further(held, LEAST);
    const drawn = held.kind === "here" ? held.now : held.points.length > 1;
    if (!drawn) this.say();
    else if (this.keep(held.person, held.points)) this.director.drawn?.();
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

  /** Hands a path to the director, or says why nobody can walk it; whether they can. */
  keep(person, points) {
    const wrong = trouble(points, this.director.seconds);
    if (!wrong) this.director.keepPath(person, points);
    this.say(wrong || (points.length ? say("player.drawn", { path: named(person, points) }) : ""));
    this.player.refresh();
    return !wrong;
  }

  // ---- keys ----------------------------------------------------------------------------------------

  key(event) {
    if (!this.on) return;
    const grip = event.target.closest(".pdd-grip");
    if (event.key === "Escape") this.held ? this.drop() : this.toggle(false);
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") this.undo();
    else if (grip && event.key in KEYS) this.nudge(grip.dataset, ...KEYS[event.key], event.shiftKey ? 5 : 1);
    else if (grip && ["Delete", "Backspace"].includes(event.key)) this.keep(grip.dataset.person, []);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  nudge({ person, kind }, axis, sign, times) {
    const { right, back } = axesOf(this.player.orbit.yaw, 0);
    const way = { right, away: back.map((v) => -v) }[axis];
    const by = [way[1], way[0]].map((v) => sign * times * v);
    const points = this.pathOf(person);
    const place = this.places["ab".indexOf(person)];
    const moved = ([x, z], metres) => inside([x + metres * by[0], z + metres * by[1]]);
    if (kind === "path") {
      const begun = points.length ? points : [[this.seconds, ...inside(place)]];
      this.keep(person, [...begun, [null, ...moved(begun.at(-1).slice(1, 3), STEP)]]);
    } else {
      const there = points.find(([seconds]) => seconds !== null && Math.abs(seconds - this.seconds) < 0.02);
      this.keep(person, passing(points, this.seconds, moved(there?.slice(1, 3) ?? place, NUDGE), this.director.seconds));
    }
  }

  // ---- drawing -------------------------------------------------------------------------------------

  /** Lays the lines on the floor of a scene. */
  lay(scene, theme) {
    const { paths } = this;
    const rings = this.on ? this.places.map((place, person) => ({ person, place })) : [];
    if (this.held?.now) rings.push({ person: "ab".indexOf(this.held.person), place: this.held.now });
    if (paths.length || rings.length) scene.set("paths", lines(paths, rings, theme.people.map(({ middle }) => middle)));
    else if (scene.layers.get("paths")?.hidden !== true) scene.hide("paths");
  }

  /** Puts handles and lengths where they belong in the picture. */
  place({ matrix }) {
    const { clientWidth: width, clientHeight: height } = this.player.pane.host;
    const put = (element, place, lift) => {
      const [x, y, depth] = project(onFloor(place), matrix, width, height, FIELD_OF_VIEW);
      element.style.transform = `translate(${x.toFixed(1)}px, ${(y + lift).toFixed(1)}px) translate(-50%, -50%)`;
      element.style.visibility = depth > 0.1 ? "visible" : "hidden";
    };
    const { right } = axesOf(this.player.orbit.yaw, 0);
    const places = this.on ? this.places : [];
    for (const grip of this.grips.children) {
      const person = "ab".indexOf(grip.dataset.person);
      const [x, z] = (this.held?.person === grip.dataset.person && this.held.now) || places[person];
      const aside = grip.dataset.kind === "here" ? ASIDE : 0;
      put(grip, [x + aside * right[1], z + aside * right[0]], 0);
    }
    const long = this.paths.filter(({ points }) => points.length > 1);
    while (this.lengths.children.length > long.length) this.lengths.lastChild.remove();
    while (this.lengths.children.length < long.length) this.lengths.append(document.createElement("span"));
    long.forEach(({ person, points }, i) => {
      const label = this.lengths.children[i];
      label.className = `pdd-length pdd-length-${person}`;
      label.textContent = `${lengthOf(points).toFixed(1)} m`;
      put(label, points.at(-1).slice(1, 3), 18);
    });
  }
}
