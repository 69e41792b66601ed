// The player: one element, one scene, one clock. main.js makes these; everything else is a part of it.

import { Actions } from "./actions.js";
import { aim, figureAtFirst, remember } from "./remember.js";
import { Clock } from "./clock.js";
import { Clothes } from "./clothes.js";
import { Controls } from "./controls.js";
import { decode, describe } from "./decode.js";
import { Directing } from "./directing.js";
import { Grid } from "./grid.js";
import { Orbit } from "./orbit.js";
import { THEMES, themeName } from "./palette.js";
import { Pane } from "./pane.js";
import { Strip } from "./strip.js";
import { Framing } from "./views.js";

const STILL_AFTER = 250; // ms
const [LIVE_PAUSE, LOADING_PAUSE] = [48, 100]; // ms between pictures of a person who moves now, and while the page loads
export const loops = { running: 0 }; // animation loops alive on the page; a leak shows here

export class Player {
  constructor(root) {
    this.root = root;
    this.find = (selector) => root.querySelector(selector);
    this.stage = this.find(".pdd-stage");
    this.controls = new Controls(root);
    this.clock = new Clock();
    this.orbit = new Orbit();
    this.show = { ghosts: false, figure: figureAtFirst() };
    this.clothes = new Clothes(this);
    this.framing = new Framing(this);
    this.pane = new Pane(this.find(".pdd-pane"), (look) => this.clothes.body(look));
    this.grid = new Grid(this.find(".pdd-grid"), this.pane);
    this.focus = null; // the number of the cell of a grid that is seen large
    this.actions = new Actions(this);
    this.strip = new Strip(root, { onSeek: (frame) => this.seek(frame) });
    this.data = null;
    this.directing = new Directing(this);
    this.sampleIndex = 0;
    this.dirty = true;
    this.handle = 0;
    this.root.dataset.theme = this.themeName = themeName();
  }

  async open(Plotly) {
    await this.pane.open(this.theme.background, Plotly);
    this.scene = this.pane.scene;
    this.listen();
    this.wake();
    this.clothes.change();
  }

  get theme() {
    return THEMES[this.themeName];
  }

  get sample() {
    const sample = this.data?.samples[this.sampleIndex] ?? null;
    return this.focus === null ? sample : sample?.cells?.[this.focus] ?? sample;
  }

  /** What shows motions: the cells of a grid, or the one pane. */
  get shown() {
    return this.grid.cells.length ? this.grid.cells : [this.pane];
  }

  /** Everybody in view, one motion after another: an array a person of [x, y, z] a joint. */
  everybody(frame) {
    return this.shown.flatMap((pane) => pane.poseAt(frame));
  }

  // ---- content -------------------------------------------------------------------------------

  /** Shows a payload of webdemo/view/payload.py, or the empty state for null. */
  load(payload) {
    this.directing.end();
    this.root.toggleAttribute("data-stream", Boolean(payload?.stream)); // which is no result yet
    if (!payload?.samples?.length) {
      this.data = null;
      this.clock.pause();
      this.root.dataset.state = "empty";
      this.strip.load(null);
      this.focus = null;
      this.find(".pdd-back").hidden = true;
      const reshaped = this.grid.load(null);
      this.pane.load(null);
      if (reshaped) this.resize();
      this.refresh();
      return;
    }
    this.data = decode(payload);
    this.focus = null;
    if (!payload.rounds && !payload.stream) remember();
    this.skeleton = describe(this.data.names, this.data.parents);
    this.root.dataset.state = "ready";
    this.rounds = 0;
    this.clock.frame = Math.min(this.data.samples[0].past_until ?? 0, this.data.samples[0].frames - 1);
    this.controls.load(this.data);
    this.select(0);
    this.clothes.change();
    this.root.toggleAttribute("data-first", Boolean(payload.rounds)); // nothing is made yet that could be directed
    this.framing.goTo("threequarter");
    if (!payload.rounds || !matchMedia("(prefers-reduced-motion: reduce)").matches) this.clock.play();
    if (!payload.rounds && !payload.stream) aim(this);
    this.refresh();
  }

  /** Another sample of the same payload, at the same moment and under the same camera. */
  select(index) {
    const count = this.data.samples.length;
    this.sampleIndex = ((index % count) + count) % count;
    const { sample } = this;
    this.clock.load(sample);
    this.pane.load(sample, sample.caption);
    const reshaped = this.grid.load(sample.cells ? sample : null);
    this.find(".pdd-back").hidden = this.focus === null;
    if (reshaped) {
      this.resize();
      this.clothes.change();
    } else this.framing.measure();
    this.strip.load(sample, this.theme.curve);
    this.controls.select(sample, this.sampleIndex);
    this.refresh();
  }

  /** A cell of a grid in the whole stage, or all of them again for null; at the same moment, from the same side. */
  enlarge(cell) {
    if (this.focus === cell || !this.data?.samples[this.sampleIndex].cells) return;
    this.focus = cell;
    this.select(this.sampleIndex);
    this.orbit.cut(this.framing.wanted(), true); // the others stand elsewhere
  }

  // ---- actions -------------------------------------------------------------------------------

  seek(frame) {
    if (!this.directing.mayLeave()) return;
    this.clock.seek(frame);
    this.wake();
  }

  act(action, argument) {
    this.actions.do(action, argument);
  }

  /** While a message covers the scene nothing is drawn. */
  cover(covered) {
    this.covered = covered;
    if (!covered && this.scene) this.wake();
  }

  // ---- listening -----------------------------------------------------------------------------

  listen() {
    const { root } = this;
    this.controls.listen(this);
    this.abort = new AbortController();
    const { signal } = this.abort;
    document.addEventListener("visibilitychange", () => this.wake(), { signal });
    document.addEventListener("fullscreenchange", () => this.refresh(), { signal });
    this.themeWatch = new MutationObserver(() => this.setTheme(themeName()));
    this.themeWatch.observe(document.body, { attributes: true, attributeFilter: ["class"] });
    // Fires with size 0 when the element leaves the page or is hidden, and again when it comes back.
    this.sizeWatch = new ResizeObserver(() => {
      if (!root.isConnected) return this.close();
      if (this.stage.clientWidth) this.resize();
    });
    this.sizeWatch.observe(this.stage);
  }

  /** A hand has turned the view: it is no longer that of a preset. */
  turned() {
    this.framing.preset = null;
    this.wake();
  }

  setTheme(name) {
    if (name === this.themeName) return;
    this.themeName = name;
    this.root.dataset.theme = name;
    this.scene?.setBackground(this.theme.background);
    this.strip.load(this.sample, this.theme.curve);
    this.refresh();
  }

  resize() {
    this.grid.fit();
    this.scene?.resize();
    this.framing.measure();
    this.strip.paint();
    this.refresh();
  }

  /** Everything is drawn anew at the next frame. */
  refresh() {
    this.pane.refresh();
    this.wake();
  }

  // ---- the loop ------------------------------------------------------------------------------

  /** Asks for a picture; the loop goes on by itself for as long as something moves. */
  wake(still = false) {
    this.dirty = true;
    clearTimeout(this.stillTimer);
    if (!still) this.setStill(false);
    if (this.handle || this.closed || !this.scene) return;
    loops.running++;
    this.handle = requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    this.handle = 0;
    loops.running--;
    if (!this.root.isConnected) return this.close();
    if (document.hidden || !this.stage.clientWidth || this.covered) {
      this.clock.last = null;
      this.lastTick = null;
      return;
    }
    const seconds = this.lastTick ? Math.min((now - this.lastTick) / 1000, 0.5) : 0;
    this.lastTick = now;
    const before = this.clock.frame;
    this.clock.advance(now);
    const pose = this.data && this.everybody(this.clock.shown);
    const wanted = pose && this.framing.wanted();
    if (this.clock.frame < before) {
      this.orbit.cut(wanted); // the loop begins anew
      this.rounds++;
      if (this.data.rounds && this.rounds >= this.data.rounds) this.clock.pause();
    }
    this.orbit.step(seconds, wanted);
    const moving = this.clock.playing || !this.orbit.settled(wanted);
    if (moving && now - this.painted < this.sparing) return this.wake();
    this.painted = now;
    if (moving || this.dirty) {
      this.dirty = false;
      this.paint(pose);
    }
    if (moving || this.dirty) {
      const asked = this.dirty;
      this.wake();
      this.dirty = asked;
    } else {
      this.lastTick = null;
      this.stillTimer = setTimeout(() => this.setStill(true) && this.wake(true), STILL_AFTER);
    }
  }

  paint(pose) {
    const { grid, orbit, theme, themeName, clock, skeleton, show } = this;
    const { drawing, posing } = this.directing;
    const posed = posing?.pose;
    const pinned = pose && !posed && !clock.playing ? this.directing.posesAt(Math.round(clock.shown)) : [];
    if (pose) drawing.lay(this.pane, theme);
    this.shown.forEach((pane, index) => {
      const people = posed ?? (pose && pane.poseAt(clock.shown));
      const view = orbit.view(index);
      const ground = grid.cells.length ? orbit.targets[0] : view.target; // one floor for all cells, which one scene draws
      pane.paint(people, { view, ground, theme, themeName, clock, skeleton, show, pinned });
    });
    posing?.place(this.pane.spots);
    if (pose) drawing.place(orbit.view());
    this.controls.show(this);
    this.strip.show(clock.shown);
    this.pose = posed ?? pose;
    this.frameShown = clock.shown;
  }

  setStill(still) {
    return this.shown.map((pane) => pane.scene?.setStill(still, this.sparing)).some(Boolean);
  }

  /** Milliseconds between pictures where the processor draws them and is needed for more: to load the page, or to follow a person. */
  get sparing() {
    if (!this.scene?.software) return 0;
    if (this.root.closest(".pdd-early")) return LOADING_PAUSE;
    return this.data?.stream && this.clock.limit !== null ? LIVE_PAUSE : 0;
  }

  close() {
    if (this.closed) return;
    this.closed = true;
    clearTimeout(this.stillTimer);
    if (this.handle) {
      cancelAnimationFrame(this.handle);
      loops.running--;
    }
    this.handle = 0;
    this.abort?.abort();
    this.themeWatch?.disconnect();
    this.sizeWatch?.disconnect();
    this.pane.close();
    this.onclose?.();
  }
}

