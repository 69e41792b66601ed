// From a pose to what the scene draws: bones with thickness in metres, joints, shadow, trails, ghosts.

import { mix } from "./palette.js";
import { FIELD_OF_VIEW } from "./orbit.js";

const GAP = [NaN, NaN, NaN];
const OUTLINE_PX = 2.2;
const OUTLINE_BEHIND = 0.05; // metres away from the eye, so that the outline shows only around a body
const GHOST_BEHIND = 0.25; // metres away from the eye, so that they never cover the figures
const SHADOW_BEHIND = 0.15; // so that feet, which are drawn flat, stand on it instead of in it
const DISC_SIDES = 10;
const TRAIL_SECONDS = 1;
const GHOSTS = 5;

/** Turns metres at a point into CSS pixels for the present view. */
export class Lens {
  constructor(orbit, heightPx) {
    this.eye = orbit.eye;
    const center = orbit.center;
    const toward = center.map((v, i) => v - this.eye[i]);
    const n = Math.hypot(...toward) || 1;
    this.forward = toward.map((v) => v / n);
    this.pxAtOneMetre = heightPx / 2 / Math.tan(FIELD_OF_VIEW / 2);
  }

  depth(p) {
    return Math.max((p[0] - this.eye[0]) * this.forward[0] + (p[1] - this.eye[1]) * this.forward[1] + (p[2] - this.eye[2]) * this.forward[2], 0.05);
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
  const along = points[head].map((v, i) => v - points[neck][i]);
  const n = Math.hypot(...along) || 1;
  return points[head].map((v, i) => v + (0.055 * along[i]) / n);
}

/** Lines for one person: points, colours and widths of a layer. */
export function bones(points, skeleton, colors, lens) {
  const out = { points: [], colors: [], sizes: [] };
  const add = (a, b, color, radius) => {
    const width = lens.pixels(2 * radius, middle(a, b));
    out.points.push(a, b, GAP);
    out.colors.push(color, color, color);
    out.sizes.push(width, width, width);
  };
  for (const bone of skeleton.bones) add(points[bone.from], points[bone.to], colors[bone.side], bone.radius);
  return out;
}

/** Balls at the joints and the head. */
export function joints(points, skeleton, colors, lens) {
  const out = { points: [], colors: [], sizes: [] };
  const add = (p, color, radius) => {
    out.points.push(p);
    out.colors.push(color);
    out.sizes.push(lens.pixels(2 * radius, p));
  };
  points.forEach((p, j) => j !== skeleton.head && add(p, colors[skeleton.joints[j].side], skeleton.joints[j].radius));
  add(headCenter(points, skeleton), colors.middle, skeleton.headRadius);
  return out;
}

/** A rim behind each body, so that limbs stand off from what they cross. */
export function outline(pose, skeleton, color, lens) {
  const out = { points: [], sizes: [] };
  for (const points of pose) {
    for (const bone of skeleton.bones) {
      const [a, b] = [lens.behind(points[bone.from], OUTLINE_BEHIND), lens.behind(points[bone.to], OUTLINE_BEHIND)];
      const width = lens.pixels(2 * bone.radius, middle(a, b)) + 2 * OUTLINE_PX;
      out.points.push(a, b, GAP);
      out.sizes.push(width, width, width);
    }
  }
  return { ...out, colors: color };
}

/** The bodies laid flat on the floor as a lamp overhead would: a pale rim and a darker core, as one mesh. */
export function shadow(pose, skeleton, theme, lens) {
  const out = { points: [], colors: [], cells: [] };
  const layers = [
    { color: theme.shadow, spread: 0.05, behind: SHADOW_BEHIND },
    { color: theme.shadowCore, spread: 0, behind: SHADOW_BEHIND - 0.01 },
  ];
  for (const { color, spread, behind } of layers) {
    const add = (x, y) => {
      out.colors.push(color);
      return out.points.push(lens.behind([x, y, 0], behind)) - 1;
    };
    const disc = (p, radius) => {
      const ring = Array.from({ length: DISC_SIDES }, (_, i) => (2 * Math.PI * i) / DISC_SIDES);
      const corners = ring.map((angle) => add(p[0] + radius * Math.cos(angle), p[1] + radius * Math.sin(angle)));
      for (let i = 2; i < DISC_SIDES; i++) out.cells.push([corners[0], corners[i - 1], corners[i]]);
    };
    for (const points of pose) {
      for (const bone of skeleton.bones) {
        const [a, b, radius] = [points[bone.from], points[bone.to], bone.radius + spread];
        const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
        const [nx, ny] = [(-radius * (b[1] - a[1])) / length, (radius * (b[0] - a[0])) / length];
        const corners = [add(a[0] + nx, a[1] + ny), add(a[0] - nx, a[1] - ny), add(b[0] - nx, b[1] - ny), add(b[0] + nx, b[1] + ny)];
        out.cells.push([corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]);
        disc(b, radius);
      }
      disc(headCenter(points, skeleton), skeleton.headRadius + spread);
    }
  }
  return out;
}

/** The last second of pelvis and wrists, fading into the background. */
export function trails(poseAt, frame, fps, skeleton, theme) {
  const out = { points: [], colors: [], sizes: [] };
  const first = Math.max(0, frame - TRAIL_SECONDS * fps);
  const count = Math.max(2, Math.ceil(((frame - first) / fps) * 24));
  const poses = Array.from({ length: count }, (_, i) => poseAt(first + ((frame - first) * i) / (count - 1)));
  poses[0].forEach((_, person) => {
    for (const joint of [skeleton.pelvis, ...skeleton.wrists]) {
      const color = theme.people[person][skeleton.joints[joint].side];
      poses.forEach((pose, i) => {
        const t = i / (count - 1);
        out.points.push(pose[person][joint]);
        out.colors.push(mix(theme.background, color, t));
        out.sizes.push(1 + 2.5 * t);
      });
      out.points.push(GAP);
      out.colors.push(theme.background);
      out.sizes.push(1);
    }
  });
  return out;
}

/** Pale figures: moments along the way, and a second motion where the payload has one. */
export function ghosts(moments, other, skeleton, theme, lens) {
  const out = { points: [], colors: [], sizes: [] };
  const add = (points, color, width) => {
    const back = points.map((p) => lens.behind(p, GHOST_BEHIND));
    for (const bone of skeleton.bones) {
      out.points.push(back[bone.from], back[bone.to], GAP);
      out.colors.push(color, color, color);
      out.sizes.push(width, width, width);
    }
  };
  for (const pose of moments) pose.forEach((points, p) => add(points, mix(theme.background, theme.people[p].middle, 0.38), 3));
  for (const points of other) add(points, theme.ghost, 5);
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
    const t = Math.min(Math.hypot(x - cx, y - cy) / radius, 1);
    return mix(strong ? theme.gridStrong : theme.grid, theme.background, t * t * (3 - 2 * t));
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
