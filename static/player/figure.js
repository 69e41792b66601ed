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
const SIDES = 12; // of a ball's disc
const ROUND = Array.from({ length: SIDES + 1 }, (_, i) => [Math.cos((2 * Math.PI * i) / SIDES), Math.sin((2 * Math.PI * i) / SIDES)]);

/** Turns metres at a point into CSS pixels for the present view. */
export class Lens {
  constructor({ eye, center, matrix }, heightPx) {
    this.eye = eye;
    [this.right, this.up] = [0, 1].map((row) => [matrix[row], matrix[4 + row], matrix[8 + row]]);
    this.forward = unit(sub(center, eye));
    this.pxAtOneMetre = heightPx / 2 / Math.tan(FIELD_OF_VIEW / 2);
  }

  depth(p) {
    return Math.max(dot(sub(p, this.eye), this.forward), 0.05);
  }

  pixels(metres, p) {
    return (metres * this.pxAtOneMetre) / this.depth(p);
  }

  /** And back again. */
  metres(pixels, p) {
    return (pixels * this.depth(p)) / this.pxAtOneMetre;
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

/** Lines for people, each { points, limbs } with the limbs' colours, or { points, color, width } for all: a layer. */
export function bones(people, skeleton, lens, wide = 1) {
  const out = { points: [], colors: [], sizes: [] };
  for (const { points, limbs, ...given } of people) {
    for (const { from, to, side } of skeleton.bones) {
      const [a, b, color] = [points[from], points[to], given.color ?? limbs[side]];
      const width = given.width ?? Math.max(lens.pixels(2 * wide * BONE, middle(a, b)), LEAST_PX);
      out.points.push(a, b, GAP);
      out.colors.push(color, color, color);
      out.sizes.push(width, width, width);
    }
  }
  return out;
}

/** Balls at their joints. */
export const joints = (people, skeleton, lens, scale, wide = 1) => balls(people.flatMap(({ points, limbs }) => (
  points.map((p, joint) => ({ p, color: limbs[skeleton.joints[joint].side], radius: Math.max(wide * JOINT, lens.metres(LEAST_PX, p)) }))
)), lens, scale);

/** Discs that face the eye, at points `p` with a radius in metres: triangles of a layer. */
export function balls(all, lens, scale) {
  const positions = new Float32Array(9 * SIDES * all.length);
  const colors = new Float32Array(12 * SIDES * all.length);
  let corner = 0;
  for (const { p, color, radius } of all) {
    for (let side = 0; side < SIDES; side++) {
      for (const [x, y] of [[0, 0], ROUND[side], ROUND[side + 1]]) {
        for (let i = 0; i < 3; i++) positions[3 * corner + i] = scale[i] * (p[i] + radius * (x * lens.right[i] + y * lens.up[i]));
        colors.set(color, 4 * corner);
        colors[4 * corner++ + 3] = 1;
      }
    }
  }
  return { positions, colors };
}

/** Pale figures: moments along the way, in which somebody may be missing, and what really happened. */
export function ghosts(moments, real, skeleton, theme, lens) {
  const back = (points, color, width) => ({ points: points.map((p) => lens.behind(p, GHOST_BEHIND)), color, width });
  const pale = theme.people.map(({ middle: hue }) => mix(theme.background, hue, 0.38));
  const along = moments.flatMap((pose) => pose.flatMap((points, p) => (points ? [back(points, pale[p], 3)] : [])));
  return bones([...along, ...real.map((points) => back(points, theme.ghost, 5))], skeleton, lens);
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
