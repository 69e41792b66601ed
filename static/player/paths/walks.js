// Paths on the floor: their arithmetic, their lines in the scene and the place under the pointer. A point is
// [seconds or null, x, z]: metres in world axes, as in a story's paths.

import { say } from "../../texts.js";
import { axesOf, FIELD_OF_VIEW } from "../orbit.js";

export const STEP = 0.35; // metres between two points of a path that is drawn
const EDGE = 8; // metres from the middle of the floor to its edges
const WALKING = 1.2; // metres a second, where a path has no times
const MOST_SPEED = 4; // metres a second that people run
const APART = 0.15; // seconds between two points that have times
const FRAME = 1 / 30;

const between = (p, q) => Math.hypot(q[1] - p[1], q[2] - p[2]);
const round = (value) => Math.round(100 * value) / 100;

/** A place on the floor, to the centimetre. */
export const inside = ([x, z]) => [x, z].map((value) => round(Math.min(Math.max(value, -EDGE), EDGE)));

export const lengthOf = (points) => points.slice(1).reduce((sum, point, i) => sum + between(points[i], point), 0);

/** The points with a time each, as the server gives them: an even speed between those that have one, a walk behind. */
export function timed(points, total) {
  if (!points.length) return [];
  const along = [0];
  points.slice(1).forEach((point, i) => along.push(along[i] + between(points[i], point)));
  const times = points.map(([seconds]) => seconds);
  const known = times.findIndex((seconds) => seconds !== null);
  times[0] ??= known < 0 ? 0 : Math.max(0, times[known] - along[known] / WALKING);
  const last = times.findLastIndex((seconds) => seconds !== null);
  times[times.length - 1] ??= Math.min(total - FRAME, times[last] + (along.at(-1) - along[last]) / WALKING);
  return points.map((point, i) => {
    if (times[i] !== null) return [times[i], ...point.slice(1)];
    const from = times.findLastIndex((seconds, k) => k < i && seconds !== null);
    const to = times.findIndex((seconds, k) => k > i && seconds !== null);
    const share = (along[i] - along[from]) / (along[to] - along[from] || 1);
    return [times[from] + share * (times[to] - times[from]), ...point.slice(1)];
  });
}

/** Why nobody can walk a path within a motion of so many seconds; "" where they can. */
export function trouble(points, total) {
  const all = timed(points, total);
  for (const [i, point] of all.slice(1).entries()) {
    const [way, seconds] = [between(all[i], point), point[0] - all[i][0]];
    if (way <= MOST_SPEED * Math.max(seconds, 0)) continue;
    const whole = points.slice(i, i + 2).some(([time]) => time === null);
    const asked = whole ? say("player.way_since", { metres: lengthOf(points).toFixed(1), seconds: all[0][0].toFixed(1) }) : say("player.way_in", { metres: way.toFixed(1), seconds: Math.max(seconds, 0).toFixed(1) });
    return say("player.too_far", { way: asked });
  }
  return "";
}

/** A path that also passes a place at a moment; another place there makes way. */
export function passing(points, seconds, place, total) {
  const at = round(Math.min(seconds, total - FRAME));
  const kept = timed(points, total).filter(([time]) => Math.abs(time - at) >= APART);
  return [...kept, [at, ...inside(place)]].map(([time, ...rest]) => [round(time), ...rest]).sort((p, q) => p[0] - q[0]);
}

/** A path in a few words. */
export function named(person, points) {
  const who = person.toUpperCase();
  const from = points[0][0] > APART ? say("player.path_since", { seconds: points[0][0].toFixed(1) }) : "";
  if (points.length > 1) return say("player.path", { who, metres: lengthOf(points).toFixed(1) }) + from;
  return say("player.here_at", { who, seconds: (points[0][0] ?? 0).toFixed(1) });
}

/** A chip for each path, with a button that takes it away. */
export function chips(list, paths, remove) {
  const made = paths.map(({ person, points }) => {
    const chip = document.createElement("li");
    const button = document.createElement("button");
    const text = named(person, points);
    chip.dataset.person = person;
    chip.append(`${text} `, button);
    button.type = "button";
    button.textContent = "✕";
    button.title = say("player.remove_title");
    button.ariaLabel = say("player.remove", { text });
    button.addEventListener("click", () => remove(person));
    return chip;
  });
  list.replaceChildren(...made);
  list.hidden = !made.length;
}

const OVER = 0.012; // metres over the floor, so that it does not cover the lines
const FARTHEST = 40; // metres from the eye
const RING = 0.36; // radii in metres
const MARK = 0.14;
const SIDES = 40;
const GAP = [NaN, NaN, NaN];

/** The place [x, z] of the floor, in world axes, under a point of the picture; null over the horizon. */
export function floorUnder([x, y], { yaw, elevation, eye }, width, height) {
  const { right, up, back } = axesOf(yaw, elevation);
  const far = height / 2 / Math.tan(FIELD_OF_VIEW / 2);
  const ray = [0, 1, 2].map((i) => (right[i] * (x - width / 2) + up[i] * (height / 2 - y)) / far - back[i]);
  if (ray[2] > -1e-3) return null;
  const t = -eye[2] / ray[2];
  return t > 0 && t < FARTHEST ? [eye[1] + t * ray[1], eye[0] + t * ray[0]] : null;
}

/** A place [x, z] of the floor as a point of the scene. */
export const onFloor = ([x, z]) => [z, x, OVER];

const circle = ([x, z], radius) => Array.from({ length: SIDES + 1 }, (_, i) => {
  const angle = (2 * Math.PI * i) / SIDES;
  return onFloor([x + radius * Math.cos(angle), z + radius * Math.sin(angle)]);
});

/**
 * Lines of a layer: each path with a mark at its points that have a time, and a ring at each place of `rings`
 * ({ person, place }).
 */
export function lines(paths, rings, colours) {
  const out = { points: [], colors: [], sizes: [] };
  const add = (points, color, width) => {
    out.points.push(...points, GAP);
    out.colors.push(...points.map(() => color), color);
    out.sizes.push(...points.map(() => width), width);
  };
  for (const { person, points } of paths) {
    const color = colours["ab".indexOf(person)];
    if (points.length > 1) add(points.map(([, x, z]) => onFloor([x, z])), color, 5);
    points.forEach(([seconds, x, z], i) => {
      if (seconds !== null || i === points.length - 1) add(circle([x, z], MARK), color, 3);
    });
  }
  for (const { person, place } of rings) add(circle(place, RING), colours[person], 3);
  return out;
}
