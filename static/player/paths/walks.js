// Arithmetic of paths on the floor. A point is [seconds or null, x, z]: metres in world axes, as in a story's paths.

import { say } from "../../texts.js";

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
