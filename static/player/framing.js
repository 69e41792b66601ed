// How the scene is framed: presets of the camera, the room for people in a view, and what shows all of them.

import { fit, heading, moments, preset } from "./views.js";

export class Framing {
  constructor(player) {
    this.player = player;
    this.preset = "threequarter"; // null once a hand has turned the view
    this.box = { width: 960, height: 640, inset: { top: 44, right: 64, bottom: 22, left: 24 } }; // the room for people in a view
  }

  /** Takes up a preset. */
  goTo(name) {
    const { player } = this;
    const { orbit, clock, skeleton } = player;
    this.preset = name;
    const view = preset(name, heading(player.everybody(clock.shown), skeleton));
    const wanted = this.wanted(view);
    orbit.jump(wanted.targets);
    orbit.goTo({ ...view, distance: wanted.distance });
    player.refresh();
  }

  /**
   * What the camera of each view should look at, to hold its own people about this moment, and from how far: from
   * equally far in all of them, so that people are equally large.
   */
  wanted({ yaw, elevation } = this.player.orbit) {
    const { clock, skeleton, shown } = this.player;
    const times = moments(clock.shown, clock);
    const pairs = shown.map((pane) => ({
      now: pane.poseAt(clock.shown),
      soon: times.flatMap((frame) => pane.poseAt(frame)),
      used: times.flatMap((frame) => pane.sample.things.beside(pane.poseAt(frame), skeleton.pelvis)),
      box: this.box,
    }));
    return fit(pairs, skeleton, { yaw, elevation });
  }

  /** Measures the room for people in a view, in pixels: what names, captions and tools leave of it. */
  measure() {
    const { pane, grid } = this.player;
    const { clientWidth: width, clientHeight: height } = pane.host;
    if (!width || !height) return; // in a closed tab there is no size yet
    if (grid.cells.length) {
      this.box = { width, height, inset: { top: 12, right: 8, bottom: 24, left: 8 } };
      return;
    }
    const tools = this.player.find(".pdd-tools").getBoundingClientRect();
    const inset = { top: 44, right: 24, bottom: 22, left: 24 };
    if (tools.width > tools.height) inset.bottom += tools.height; // on narrow stages they lie below
    else inset.right += tools.width;
    if (pane.sample?.caption) inset.bottom = Math.max(inset.bottom, 48);
    this.box = { width, height, inset };
  }
}
