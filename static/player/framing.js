// How the scene is framed: presets of the camera, the room for people in a view, and what shows all of them.

import { fit, heading, moments, preset } from "./views.js";

export class Framing {
  constructor(player) {
    this.player = player;
    this.preset = "threequarter"; // null once a hand has turned the view
    this.box = { width: 960, height: 640, inset: { top: 44, right: 64, bottom: 22, left: 24 } };
  }

  /** Glides to a preset; at once where `now` is null. */
  goTo(name, now = performance.now()) {
    const { player } = this;
    const { orbit, clock, skeleton } = player;
    this.preset = name;
    const view = preset(name, heading(player.everybody(clock.shown), skeleton));
    const wanted = this.wanted(view);
    if (!orbit.following || now === null) orbit.jump(wanted.target);
    orbit.goTo({ ...view, distance: wanted.distance }, now);
    player.refresh();
  }

  /** The view that a motion is first seen in. */
  reset() {
    this.goTo("threequarter", null);
  }

  /** What the camera should look at, and from how far, to hold everybody in all views about this moment. */
  wanted(view) {
    const { orbit, clock, futures, skeleton } = this.player;
    const now = this.player.everybody(clock.shown);
    const all = (frame) => [...this.player.everybody(frame), ...futures.at(frame).flatMap(({ people }) => people)];
    const soon = moments(clock.shown, clock).flatMap(all);
    return fit(now, soon, skeleton, view ?? orbit.glide?.to ?? orbit, this.box);
  }

  /** Measures the room for people in a view, in pixels: what names, captions and tools leave of it. */
  measure() {
    const { panes, grid, sample } = this.player;
    const { clientWidth: width, clientHeight: height } = panes[0].host;
    if (!width || !height) return; // in a closed tab there is no size yet
    if (grid.cells.length) {
      this.box = { width, height, inset: { top: 12, right: 8, bottom: 24, left: 8 } };
      return;
    }
    const inset = { top: 44, right: 24, bottom: 22, left: 24 };
    const tools = this.player.find(".pdd-tools").getBoundingClientRect();
    if (tools.width > tools.height) inset.bottom += tools.height; // on narrow stages they lie below
    else inset.right += tools.width;
    if (sample?.caption) inset.bottom = Math.max(inset.bottom, 48);
    this.box = { width, height, inset };
  }
}
