// From a film to landmarks: who is in it, then where everybody is in every picture.

import { FilmError, hold, seek, times } from "./film.js";
import { distinct, hips, torso } from "./geometry.js";
import { Landmarks } from "./landmarks.js";
import { say } from "../texts.js";

const GLANCES = 5; // pictures in which people are counted first
const MOST = 3; // people that are looked for: two can be used
const ROOM = 5.5; // torso lengths: the side of the window in which a person is followed
const PACE = 0.03; // of its side, by which a window moves from picture to picture
const LOST = 5; // pictures after which somebody who was not found is looked for everywhere

/**
 * Looks through the film in `video`. `detectors` are two, the second for a second person. `each(done, all, people, wanted)` hears of every picture, and `stopped()` says whether to stop.
 *
 * Returns the landmarks, or null where it was stopped; throws a FilmError for a film that cannot be used.
 */
export async function analyse(video, detectors, { each = () => {}, stopped = () => false } = {}) {
  const when = times(video);
  const seen = await lookAround(video, detectors[0], when, stopped);
  if (seen === null) return null;
  const count = countOf(seen);
  const followers = await follow(video, detectors, count, seen);
  const landmarks = new Landmarks(video.videoWidth, video.videoHeight);
  for (const [i, time] of when.entries()) {
    await seek(video, time);
    const found = await look(video, time, followers);
    if (stopped()) return null;
    landmarks.add(time - when[0], found);
    each(i + 1, when.length, found, count);
  }
  return landmarks;
}

/** Everybody in a few pictures: [[person, …], …]; null where it was stopped. */
async function lookAround(video, detector, when, stopped) {
  await detector.begin(MOST, { still: true });
  const { videoWidth: width, videoHeight: height } = video;
  const windows = [null]; // squares show people larger than the whole of a wide picture
  if (width > 1.2 * height) for (const x of [0, (width - height) / 2, width - height]) windows.push([x, 0, height, height]);
  const glances = [];
  for (let glance = 0; glance < GLANCES; glance++) {
    const time = when[Math.floor((glance / GLANCES) * when.length)];
    await seek(video, time);
    const found = [];
    for (const window of windows) {
      await hold(video, time);
      found.push(...(await detector.detect(video, time, window)));
      if (stopped()) return null;
    }
    glances.push(distinct(found, width, height));
  }
  return glances;
}

function countOf(glances) {
  const counts = glances.map((people) => people.length).sort();
  if (counts.at(-1) === 0)
    throw new FilmError(say("camera.nobody"));
  if (counts[1] > 2) throw new FilmError(say("camera.too_many"));
  return Math.min(Math.max(1, counts[Math.floor(GLANCES / 2)]), 2);
}

/** Who follows whom: one person in the whole picture, or two, each in a window without the other. */
async function follow(video, detectors, count, glances) {
  const chosen = detectors.slice(0, count);
  for (const detector of chosen) await detector.begin(1);
  const first = glances.find((people) => people.length >= count) ?? [];
  return chosen.map((detector, i) => ({ detector, person: count === 2 ? (first[i] ?? null) : null, window: null, lost: 0 }));
}

async function look(video, time, followers) {
  const pair = followers.length === 2;
  for (const [i, follower] of followers.entries()) {
    if (pair) follower.window = windowOf(follower, followers[1 - i], video);
  }
  const found = await Promise.all(followers.map(({ detector, window }) => detector.detect(video, time, window)));
  const people = found.map(([person]) => person ?? null);
  if (pair && people[0] && people[1] && distinct(people, video.videoWidth, video.videoHeight).length < 2) {
    // Both follow one person: who was further away lets go.
    const gone = people.map((person, i) => (followers[i].person ? away(person, followers[i].person) : Infinity));
    people[gone[0] > gone[1] ? 0 : 1] = null;
  }
  for (const [i, follower] of followers.entries()) {
    follower.lost = people[i] ? 0 : follower.lost + 1;
    follower.person = people[i] ?? (follower.lost > LOST ? null : follower.person);
  }
  return people.filter(Boolean);
}

function away(one, other) {
  const [a, b] = [hips(one), hips(other)];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** [x, y, width, height] in pixels around a follower's person, short of the other's body. */
function windowOf({ person, window }, other, { videoWidth: width, videoHeight: height }) {
  if (!person) return null;
  const size = Math.max(torso(person, width, height), height / 20);
  const [x, y] = [hips(person)[0] * width, hips(person)[1] * height];
  let [left, right] = [x - (ROOM / 2) * size, x + (ROOM / 2) * size];
  if (other.person) {
    const theirs = hips(other.person)[0] * width;
    if (theirs > x) right = Math.min(right, Math.max(theirs - 0.5 * size, x + size));
    else left = Math.max(left, Math.min(theirs + 0.5 * size, x - size));
  }
  left = Math.max(0, left);
  const top = Math.max(0, y - (ROOM / 2) * size);
  const wanted = [left, top, Math.min(right, width) - left, Math.min(y + (ROOM / 2) * size, height) - top];
  if (!window) return wanted;
  const most = PACE * ROOM * size; // a window that jumps would lose whom it follows
  return window.map((value, k) => value + Math.max(-most, Math.min(most, wanted[k] - value)));
}
