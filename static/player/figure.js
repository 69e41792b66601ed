// From a pose to the lines that the scene draws: bones and joints, ghosts, the grid on the floor.

import { floorAt, mix, smooth } from "./palette.js";
import { FIELD_OF_VIEW } from "./orbit.js";
import { dot, sub, unit } from "./pose.js";

const GAP = [NaN, NaN, NaN];
const BONE = 0.008; // radii in metres
const JOINT = 0.018;
const LEAST_PX = 1.5;
const GHOST_BEHIND = 0.25; // metres away from the eye, so that they never cover the figures
const BODY_BEFORE = 0.25; // metres towards the eye, so that a skeleton is seen over the body around it
const INK = 0.45; // of black, in limbs on a body of the same hue
const GHOSTS = 5;

/** Turns metres at a point into CSS pixels for the present view. */
export class Lens {
  constructor({ eye, center }, heightPx) {
    this.eye = eye;
    this.forward = unit(sub(center, eye));
    this.pxAtOneMetre = heightPx / 2 / Math.tan(FIELD_OF_VIEW / 2);
  }

  depth(p) {
    return Math.max(dot(sub(p, this.eye), this.forward), 0.05);
  }

  pixels(metres, p) {
    return (metres * this.pxAtOneMetre) / this.depth(p);
  }

  /** The point moved away from the eye along its own ray; its place in the picture stays. */
  behind(p, metres) {
    const k = 1 + metres / this.depth(p);
    return [this.eye[0] + k * (p[0] - this.eye[0]), this.eye[1] + k * (p[1] - this.eye[1]), this.eye[2] + k * (p[2] - this.eye[2])];
  }
}

const middle = (a, b) => [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])];

/** Where the head's ball sits: a little beyond the joint at the base of the skull. */
export function headCenter(points, skeleton) {
  const { head, neck } = skeleton;
  if (head < 0) return points[0].map((v, i) => (i === 2 ? v + 0.8 : v));
  if (neck < 0) return points[head];
  const along = unit(sub(points[head], points[neck]));
  return points[head].map((v, i) => v + 0.055 * along[i]);
}

/** The points moved towards the eye, each along its own ray, but at most half of the way. */
export const ahead = (points, lens) => points.map((p) => lens.behind(p, -Math.min(BODY_BEFORE, 0.5 * lens.depth(p))));

/** Colours of limbs that are seen on a body: darker than what it wears. */
export const inked = (limbs) =>
  Object.fromEntries(Object.entries(limbs).map(([side, color]) => [side, mix(color, [0, 0, 0], INK)]));

/** Lines for one person: points, colours and widths of a layer. */
export function bones(points, skeleton, colors, lens, wide = 1) {
  const out = { points: [], colors: [], sizes: [] };
  for (const { from, to, side } of skeleton.bones) {
    const [a, b, color] = [points[from], points[to], colors[side]];
    const width = Math.max(lens.pixels(2 * wide * BONE, middle(a, b)), LEAST_PX);
    out.points.push(a, b, GAP);
    out.colors.push(color, color, color);
    out.sizes.push(width, width, width);
  }
  return out;
}

/** Balls at the joints. */
export function joints(points, skeleton, colors, lens, wide = 1) {
  return {
    points,
    colors: skeleton.joints.map(({ side }) => colors[side]),
    sizes: points.map((p) => Math.max(lens.pixels(2 * wide * JOINT, p), 2 * LEAST_PX)),
  };
}

/** Pale figures: moments along the way, in which somebody may be missing, and what really happened. */
export function ghosts(moments, real, skeleton, theme, lens) {
  const out = { points: [], colors: [], sizes: [] };
  const add = (points, color, width) => {
    const back = points.map((p) => lens.behind(p, GHOST_BEHIND));
    for (const bone of skeleton.bones) {
      out.points.push(back[bone.from], back[bone.to], GAP);
      out.colors.push(color, color, color);
      out.sizes.push(width, width, width);
    }
  };
  for (const pose of moments) pose.forEach((points, p) => points && add(points, mix(theme.background, theme.people[p].middle, 0.38), 3));
  for (const points of real) add(points, theme.ghost, 5);
  return out;
}

/** Frames of the onion skin: evenly spaced, both ends in. */
export const ghostFrames = (frames) =>
  Array.from({ length: GHOSTS }, (_, i) => Math.round(((frames - 1) * i) / (GHOSTS - 1)));

/** A grid of metres that fades out around `center`. */
export function floor(center, radius, theme) {
  const out = { points: [], colors: [], sizes: [] };
  const [cx, cy] = center.map(Math.round);
  const fade = (x, y, strong) => {
    const away = Math.hypot(x - cx, y - cy);
    return mix(strong ? theme.gridStrong : theme.grid, floorAt(theme, away), smooth(Math.min(away / radius, 1)));
  };
  const n = Math.ceil(radius);
  const line = (at, strong) => {
    for (let i = -n; i <= n; i += 1) {
      const [x, y] = at(i);
      out.points.push([x, y, 0]);
      out.colors.push(fade(x, y, strong));
      out.sizes.push(strong ? 1.6 : 1.1);
    }
    out.points.push(GAP);
    out.colors.push(theme.background);
    out.sizes.push(1);
  };
  for (let k = -n; k <= n; k++) {
    line((i) => [cx + i, cy + k], (cy + k) % 5 === 0);
    line((i) => [cx + k, cy + i], (cx + k) % 5 === 0);
  }
  return out;
}
