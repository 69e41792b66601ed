// How the scene is framed: presets of the camera, which follow from the places of the two people, and what shows everybody.

import { FIELD_OF_VIEW, axesOf } from "./orbit.js";
import { dot } from "./pose.js";

const AROUND = 0.13; // metres about a joint that must be in view: palms and the sides of a body
const ABOVE = 0.24; // metres over the joint of a head: its crown
const NEAREST = 2.6; // metres; nearer, one face would fill the stage
const SPAN = [-0.2, 1.2]; // seconds about the moment in which nobody leaves the view
const MOMENTS = 8; // looked at within them

/** Angle of the line from A to B on the floor; of the way A faces where there is nobody else. */
export function heading(pose, skeleton) {
  const [a, b] = pose.map((points) => points[skeleton.pelvis]);
  if (b && Math.hypot(b[0] - a[0], b[1] - a[1]) > 0.05) return Math.atan2(b[1] - a[1], b[0] - a[0]);
  const [left, right] = skeleton.hips.map((j) => pose[0][j]);
  if (!left || !right) return 0;
  // The left hip lies a quarter turn anticlockwise (seen from above) of where the body faces.
  return Math.atan2(left[1] - right[1], left[0] - right[0]) - Math.PI / 2;
}

// Radians beside the line from A to B, and above the floor.
const PRESETS = {
  threequarter: [-1.05, 0.24],
  front: [0, 0.16],
  side: [-Math.PI / 2, 0.1],
  top: [-Math.PI / 2, 1.48],
  a: [Math.PI + 0.4, 0.3],
  b: [-0.4, 0.3],
};

/** Yaw and elevation of a preset, for the angle of the line from A to B. */
export function preset(name, along) {
  const [aside, elevation] = PRESETS[name];
  return { yaw: along + aside, elevation };
}

/** Moments about `frame` at which everybody must be in view. */
export function moments(frame, { frames, fps }) {
  const [from, to] = SPAN.map((seconds) => Math.min(Math.max(frame + seconds * fps, 0), frames - 1));
  return [frame, ...Array.from({ length: MOMENTS }, (_, i) => from + ((to - from) * i) / (MOMENTS - 1))];
}

/**
 * Where the cameras of views beside each other must look, and from how far all of them, so that people are in view.
 *
 * `pairs` are { now, soon, box } a view. `now` and `soon` are poses: all of `soon` fit into the distance, and the middle
 * is that of `now`. The box is `width` × `height` pixels, of which `inset` { top, right, bottom, left } are taken by
 * names and buttons.
 */
export function fit(pairs, skeleton, { yaw, elevation }) {
  const axes = axesOf(yaw, elevation);
  const needed = pairs.map((pair) => need(pair, skeleton, axes));
  const distance = Math.max(...needed.map(({ least }) => least), NEAREST);
  const { right, up, back } = axes;
  const targets = needed.map(({ here, slopes, depth }) => {
    const [x, y] = [0, 2].map((k) => (here[k] - here[k + 1] - (slopes[k] - slopes[k + 1]) * (distance + depth)) / 2);
    return [0, 1, 2].map((i) => right[i] * x + up[i] * y + back[i] * depth);
  });
  return { targets, distance };
}

/** How far a pair's people reach to each side of its view, and the least distance from which all are in it. */
function need({ now, soon, used = [], box: { width, height, inset } }, skeleton, { right, up, back }) {
  const half = height / 2 || 1;
  const slope = (pixels) => Math.max(Math.tan(FIELD_OF_VIEW / 2) * (pixels / half), 0.05);
  const slopes = [slope(width / 2 - inset.right), slope(width / 2 - inset.left), slope(half - inset.top), slope(half - inset.bottom)];
  // A point (x, y, z) in the camera's axes lies inside a side of slope s, seen from distance d about a centre c,
  // where x - c <= s (d - z): so c + s d is at least the largest x + s z of all, and so for each side.
  const reach = (poses) => {
    const most = [-Infinity, -Infinity, -Infinity, -Infinity];
    for (const points of poses) {
      points.forEach((point, joint) => {
        const tall = joint === skeleton.head ? ABOVE : 0;
        for (const p of tall ? [point, [point[0], point[1], point[2] + tall]] : [point]) {
          const [x, y, z] = [dot(right, p), dot(up, p), dot(back, p)];
          const sides = [x, -x, y, -y];
          for (let k = 0; k < 4; k++) most[k] = Math.max(most[k], sides[k] + slopes[k] * z + AROUND);
        }
      });
    }
    return most;
  };
  const all = reach([...soon, ...used]);
  // They are measured from the world's origin: the depth of the centre is free, so it is taken amidst everybody.
  const depth = mean(now.flatMap((points) => points.map((p) => dot(back, p))));
  const least = Math.max(...[0, 2].map((k) => (all[k] + all[k + 1]) / (slopes[k] + slopes[k + 1]))) - depth;
  return { here: reach([...now, ...used]), slopes, depth, least };
}

const mean = (values) => values.reduce((sum, v) => sum + v, 0) / Math.max(values.length, 1);

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
