// The camera: an orbit around a target in scene axes (x towards where A faces at first, z up), metres.
// Views beside each other share its angles and its distance, so that people are equally large in them, and each has its
// own target.

import { dot } from "./pose.js";

const LOWEST = -0.05; // radians of elevation; the floor hides what lies under it
const HIGHEST = 1.5;
const NEAREST = 0.8;
const FARTHEST = 40;
const FOLLOW_SECONDS = 0.3; // time constants of the follow
const FRAME_SECONDS = 0.45;
const SETTLED = 0.004; // metres
export const FIELD_OF_VIEW = Math.PI / 4; // plotly's

const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

export class Orbit {
  constructor() {
    this.yaw = 0.9;
    this.elevation = 0.3;
    this.distance = 5;
    this.targets = [[0, 0, 0.9]]; // one a view
    this.pan = [0, 0, 0]; // what the user moved the target by
    this.following = true;
    this.framing = true; // whether the distance adapts, until the user zooms
  }

  /** The first view's eye. */
  get eye() {
    return this.view().eye;
  }

  /** Where the camera of a view stands: { target, center, eye, matrix }. */
  view(index = 0) {
    const target = this.targets[index] ?? this.targets[0];
    const center = target.map((v, i) => v + this.pan[i]);
    const axes = axesOf(this.yaw, this.elevation);
    const eye = center.map((v, i) => v + this.distance * axes.back[i]);
    return { target, center, eye, matrix: matrixOf(eye, axes) };
  }

  /** Turns by radians. */
  turn(yaw, elevation) {
    this.yaw += yaw;
    this.elevation = clamp(this.elevation + elevation, LOWEST, HIGHEST);
  }

  zoom(factor) {
    this.framing = false;
    this.distance = clamp(this.distance * factor, NEAREST, FARTHEST);
  }

  /** Moves the target in the image plane by fractions of the view's height. */
  slide(right, up) {
    const scale = 2 * this.distance * Math.tan(FIELD_OF_VIEW / 2);
    const axes = axesOf(this.yaw, this.elevation);
    this.pan = this.pan.map((v, i) => v - scale * (right * axes.right[i] + up * axes.up[i]));
  }

  /** Takes up a view; what is left out stays. */
  goTo({ yaw = this.yaw, elevation = this.elevation, distance = this.distance }) {
    this.yaw = yaw;
    this.elevation = clamp(elevation, LOWEST, HIGHEST);
    this.distance = clamp(distance, NEAREST, FARTHEST);
    this.pan = [0, 0, 0];
    this.framing = true;
  }

  /** Follows `wanted` ({ targets, distance } or null) smoothly. `seconds` since the last call. */
  step(seconds, wanted) {
    if (!this.following || !wanted || this.settled(wanted)) return;
    const k = 1 - Math.exp(-seconds / FOLLOW_SECONDS);
    this.targets = wanted.targets.map((want, n) => (this.targets[n] ?? want).map((v, i) => v + k * (want[i] - v)));
    if (this.framing) this.distance += (1 - Math.exp(-seconds / FRAME_SECONDS)) * (wanted.distance - this.distance);
  }

  jump(targets) {
    this.targets = targets.map((target) => target.slice());
  }

  /** Takes what is to be followed in view at once, where the people too are elsewhere at once. */
  cut(wanted, always = false) {
    if (!wanted || !(this.following || always)) return;
    this.jump(wanted.targets);
    if (this.framing) this.distance = wanted.distance;
  }

  /** Whether the picture would stay as it is without anyone's doing. */
  settled(wanted) {
    if (!this.following || !wanted) return true;
    if (wanted.targets.length !== this.targets.length) return false;
    const away = wanted.targets.map((want, n) => Math.hypot(...want.map((v, i) => v - this.targets[n][i])));
    return Math.max(...away) < SETTLED && (!this.framing || Math.abs(wanted.distance - this.distance) < SETTLED);
  }
}

/** The view matrix from an eye along a camera's axes, column-major as WebGL wants it. */
function matrixOf(eye, { right, up, back }) {
  return [
    right[0], up[0], back[0], 0,
    right[1], up[1], back[1], 0,
    right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
  ];
}

/** Right, up and back of a camera that looks from there: scene axes. */
export function axesOf(yaw, elevation) {
  const [s, c, se, ce] = [Math.sin(yaw), Math.cos(yaw), Math.sin(elevation), Math.cos(elevation)];
  return { right: [-s, c, 0], up: [-se * c, -se * s, ce], back: [ce * c, ce * s, se] };
}
