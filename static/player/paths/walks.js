// Paths on the floor: their arithmetic, their lines in the scene and the place under the pointer. A point is
// [seconds or null, x, z]: metres in world axes, as in a story's paths.

import { say } from "../../texts.js";
import { node } from "../node.js";
import { axesOf, FIELD_OF_VIEW } from "../orbit.js";

export const STEP = 0.35; // metres between two points of a path that is drawn
const EDGE = 8; // metres from the middle of the floor to its edges
const LATE = 0.15; // seconds from which the beginning of a path is told

/** A place on the floor, to the centimetre. */
export const inside = ([x, z]) => [x, z].map((value) => Math.round(100 * Math.min(Math.max(value, -EDGE), EDGE)) / 100);

/** Metres of a path. */
export const lengthOf = (points) =>
  points.slice(1).reduce((sum, [, x, z], i) => sum + Math.hypot(x - points[i][1], z - points[i][2]), 0);

/** A path in a few words. */
export function named(person, points) {
  const who = person.toUpperCase();
  const from = points[0][0] > LATE ? say("player.path_since", { seconds: points[0][0].toFixed(1) }) : "";
  if (points.length > 1) return say("player.path", { who, metres: lengthOf(points).toFixed(1) }) + from;
  return say("player.here_at", { who, seconds: (points[0][0] ?? 0).toFixed(1) });
}

/** A chip for each path, with a button that takes it away. */
export function chips(list, paths, remove) {
  const made = paths.map(({ person, points }) => {
    const text = named(person, points);
    const chip = node("li", "", `${text} `);
    const button = node("button", "", "✕");
    chip.dataset.person = person;
    chip.append(button);
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

/** Lines of a layer: each path with a mark at its points that have a time, and a ring about each person's place. */
export function lines(paths, places, colours) {
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
  places.forEach((place, person) => add(circle(place, RING), colours[person], 3));
  return out;
}
