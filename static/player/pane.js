// One view of one motion: its 3D scene and the names above heads. A player has one, or two side by side.

import { poseAt } from "./decode.js";
import * as figure from "./figure.js";
import { FIELD_OF_VIEW } from "./orbit.js";
import { Labels, project } from "./overlay.js";
import { Scene } from "./scene.js";

const ABOVE_HEAD = 0.17; // metres

export class Pane {
  constructor(host) {
    this.host = host;
    this.find = (selector) => host.querySelector(selector);
    this.labels = new Labels(this.find(".pdd-labels"));
    this.sample = null;
    this.scene = null;
    this.spots = [];
    this.painted = { floor: "", trails: false, ghosts: false };
  }

  async open(background, Plotly) {
    this.scene = await new Scene(this.find(".pdd-gl"), Plotly).open(background);
    return this;
  }

  /** Another motion to show, or null; `caption` tells it from the one beside it. */
  load(sample, caption = "") {
    this.sample = sample;
    const text = this.find(".pdd-caption");
    text.textContent = caption;
    text.hidden = !caption;
    this.labels.load(sample?.roles ?? []);
    this.spots = [];
    if (!this.scene) return;
    if (!sample) for (const name of this.scene.names) if (name !== "floor") this.scene.hide(name);
    if (sample?.motion.people < 2) for (const name of ["bonesB", "jointsB"]) this.scene.hide(name);
  }

  poseAt(frame) {
    return poseAt(this.sample.motion, frame);
  }

  /** Everything is drawn anew at the next picture. */
  refresh() {
    this.painted.floor = "";
  }

  /** Draws `pose` of this pane's motion, or the floor alone for null. */
  paint(pose, { orbit, matrix, theme, themeName, clock, skeleton, show }) {
    const { scene } = this;
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
    const put = (name, layer) => scene.set(name, layer);
    scene.setView(matrix, orbit.eye, orbit.center);
    const floorKey = `${themeName} ${orbit.target.map(Math.round)}`;
    if (this.painted.floor !== floorKey) put("floor", figure.floor(orbit.target, 9, theme));
    this.painted.floor = floorKey;
    if (pose) {
      const lens = new figure.Lens(orbit, height);
      put("shadow", figure.shadow(pose, skeleton, theme, lens));
      put("outline", figure.outline(pose, skeleton, theme.outline, lens));
      const colors = clock.shown < (this.sample.past_until ?? 0) ? theme.given : theme.people;
      pose.forEach((points, person) => {
        put(`bones${"AB"[person]}`, figure.bones(points, skeleton, colors[person], lens));
        put(`joints${"AB"[person]}`, figure.joints(points, skeleton, colors[person], lens));
      });
      this.paintExtras(put, lens, { theme, clock, skeleton, show });
      this.spots = pose.map((points) => points.map((p) => project(p, matrix, width, height, FIELD_OF_VIEW)));
      this.labels.place(pose.map((points) => {
        const above = figure.headCenter(points, skeleton);
        return project([above[0], above[1], above[2] + ABOVE_HEAD], matrix, width, height, FIELD_OF_VIEW);
      }));
    }
    scene.draw();
  }

  paintExtras(put, lens, { theme, clock, skeleton, show }) {
    const { scene, sample, painted } = this;
    if (show.trails) put("trails", figure.trails((f) => this.poseAt(f), clock.shown, clock.fps, skeleton, theme));
    else if (painted.trails) scene.hide("trails");
    painted.trails = show.trails;
    const other = sample.ghostMotion ? poseAt(sample.ghostMotion, clock.shown) : [];
    const moments = show.ghosts ? figure.ghostFrames(clock.frames).map((f) => this.poseAt(f)) : [];
    const pale = moments.length + other.length > 0;
    if (pale) put("ghosts", figure.ghosts(moments, other, skeleton, theme, lens));
    else if (painted.ghosts) scene.hide("ghosts");
    painted.ghosts = pale;
  }

  close() {
    this.scene?.close();
  }
}
