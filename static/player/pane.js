// The view of a motion: its 3D scene and the names above heads.

import { Figure } from "./body.js";
import { poseAt } from "./decode.js";
import * as figure from "./figure.js";
import { Ground } from "./ground.js";
import { shapesAt } from "./hands.js";
import { FIELD_OF_VIEW } from "./orbit.js";
import { Labels, project } from "./overlay.js";
import { Scene } from "./scene.js";

const ABOVE_HEAD = 0.2; // metres
const WIDE = 3.5; // times, skeletons that stand for bodies that cannot be had

export class Pane {
  /** `wear` gives the body of a look, or null while there is none. */
  constructor(host, wear) {
    this.host = host;
    this.wear = wear;
    this.find = (selector) => host.querySelector(selector);
    this.labels = new Labels(this.find(".pdd-labels"));
    this.sample = null;
    this.scene = null;
    this.spots = [];
    this.floor = ""; // what the floor was painted for
    this.ground = new Ground();
    this.made = new Map(); // figures of all looks that have been seen, for A and for B
    this.figures = [];
  }

  /** The figures of the present motion's people; none where a body is missing. */
  dressed(people) {
    const bodies = this.sample.looks.slice(0, people).map(this.wear);
    if (!bodies.every(Boolean)) return [];
    return bodies.map((body, person) => {
      const known = this.made.get(body) ?? this.made.set(body, []).get(body);
      return (known[person] ??= new Figure(body));
    });
  }

  async open(background, Plotly) {
    this.scene = await new Scene(this.find(".pdd-gl"), Plotly).open(background);
  }

  /** Another motion to show, or null; `caption` names a cell of a grid that is seen large. */
  load(sample, caption = "") {
    this.sample = sample;
    const text = this.find(".pdd-caption");
    text.textContent = caption;
    text.hidden = !caption;
    this.labels.load(sample?.roles ?? []);
    this.spots = [];
    if (!this.scene) return;
    for (const name of this.scene.names) if (name !== "floor" && name !== "ground") this.scene.hide(name);
  }

  poseAt(frame) {
    return poseAt(this.sample.motion, frame);
  }

  /** Everything is drawn anew at the next picture. */
  refresh() {
    this.floor = "";
  }

  /** Draws `pose` of this pane's motion, or the floor alone for null; `view` is of Orbit.view(), `ground` the floor's middle. */
  paint(pose, { view, ground, theme, themeName, clock, skeleton, show, pinned }) {
    const { scene } = this;
    const { matrix } = view;
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
    scene.setView(matrix);
    this.paintFloor(ground, theme, themeName);
    if (pose) {
      const lens = new figure.Lens(view, height);
      const given = clock.shown < (this.sample.past_until ?? 0);
      const bodies = show.figure !== "skeleton" && skeleton.wears ? this.dressed(pose.length) : [];
      if (bodies.length) this.figures = bodies;
      bodies.forEach((body, person) => {
        const hands = shapesAt(this.sample.grips, person, clock.shown, this.sample.fps);
        body.pose(pose[person], hands);
        body.shade((given ? theme.givenBodies : theme.bodies)[person], theme.lamps, lens, scene.scale);
        scene.setTriangles(`body${"AB"[person]}`, { positions: body.positions, colors: body.colors });
      });
      this.drop(["bodyA", "bodyB"].slice(bodies.length));
      const { things } = this.sample;
      if (things.figures.length) scene.setTriangles("things", things.at(clock.shown, theme.lamps, lens, scene.scale));
      else this.drop(["things"]);
      const colors = given ? theme.given : theme.people;
      const wide = bodies.length || show.figure === "skeleton" ? 1 : WIDE;
      const thin = (show.figure !== "body" || !bodies.length ? pose : []).map((points, person) => (
        bodies.length
          ? { points: figure.ahead(points, lens), limbs: figure.inked(colors[person]) }
          : { points, limbs: colors[person] }
      ));
      if (thin.length) {
        scene.set("bones", figure.bones(thin, skeleton, lens, wide));
        scene.setTriangles("joints", figure.joints(thin, skeleton, lens, scene.scale, wide));
      } else this.drop(["bones", "joints"]);
      this.paintShadow(pose, skeleton, bodies, things, theme);
      this.paintGhosts(lens, { theme, clock, skeleton, show, pinned });
      this.spots = pose.map((points) => points.map((p) => project(p, matrix, width, height, FIELD_OF_VIEW)));
      this.labels.place(pose.map((points) => {
        const above = figure.headCenter(points, skeleton);
        return project([above[0], above[1], above[2] + ABOVE_HEAD], matrix, width, height, FIELD_OF_VIEW);
      }));
    }
    scene.draw();
  }

  /** Takes layers away that are not drawn now. */
  drop(names) {
    for (const name of names) if (this.scene.layers.get(name)?.hidden !== true) this.scene.hide(name);
  }

  paintFloor(target, theme, themeName) {
    const { scene, ground } = this;
    const key = `${themeName} ${target.slice(0, 2).map(Math.round)} ${scene.scale}`;
    if (this.floor === key) return;
    this.floor = key;
    scene.set("floor", figure.floor(target, 9, theme));
    ground.lay(target.map(Math.round), theme, scene.scale);
    this.layGround();
  }

  layGround() {
    const { scene, ground } = this;
    ground.place(scene.scale);
    scene.setTriangles("ground", { positions: ground.positions, colors: ground.colors, places: ground.places });
  }

  paintShadow(pose, skeleton, bodies, things, theme) {
    const { scene, ground } = this;
    const { shadow } = ground;
    const before = `${shadow.origin} ${shadow.span}`;
    shadow.cast(pose, skeleton, bodies, theme.shade, things.shades);
    scene.setShade("ground", shadow.pixels, shadow.size);
    if (before !== `${shadow.origin} ${shadow.span}`) this.layGround();
  }

  /** Pale figures: what really followed a prediction, moments along the way, poses that are kept at this one. */
  paintGhosts(lens, { theme, clock, skeleton, show, pinned }) {
    const { sample } = this;
    const real = sample.ghostMotion ? poseAt(sample.ghostMotion, clock.shown) : [];
    const moments = show.ghosts ? figure.ghostFrames(clock.frames).map((f) => this.poseAt(f)) : [];
    if (pinned.some(Boolean)) moments.push(pinned);
    if (moments.length + real.length) this.scene.set("ghosts", figure.ghosts(moments, real, skeleton, theme, lens));
    else this.drop(["ghosts"]);
  }

  close() {
    this.scene?.close();
  }
}
