// From the paths of the next run to lines on the floor of the scene, and from a place in the picture to the floor.

import { FIELD_OF_VIEW, axesOf } from "../orbit.js";

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
