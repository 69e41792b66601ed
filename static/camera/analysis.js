// From a film to landmarks: who is in it, then where everybody is in every picture.

import { FilmError, seek, times } from "./film.js";
import { Landmarks } from "./landmarks.js";

const GLANCES = 5; // pictures in which people are counted first
const MOST = 3; // people that are looked for: two can be used

/**
 * Looks through the film in `video`. `people` is 1, 2, or 0 to find out; `each(done, all, people, wanted)` hears of every
 * picture, and `stopped()` says whether to stop.
 *
 * Returns the landmarks, or null where it was stopped; throws a FilmError for a film that cannot be used.
 */
export async function analyse(video, detector, { people = 0, each = () => {}, stopped = () => false } = {}) {
  const when = times(video);
  const count = people || (await countPeople(video, detector, when, stopped));
  if (count === null) return null;
  await detector.begin(count);
  const landmarks = new Landmarks(video.videoWidth, video.videoHeight);
  for (const [i, time] of when.entries()) {
    await seek(video, time);
    const found = await detector.detect(video, time);
    if (stopped()) return null;
    landmarks.add(time - when[0], found.slice(0, MOST));
    each(i + 1, when.length, found, count);
  }
  return landmarks;
}

async function countPeople(video, detector, when, stopped) {
  const counts = [];
  await detector.begin(MOST);
  for (let glance = 0; glance < GLANCES; glance++) {
    const time = when[Math.floor(((glance + 0.5) / GLANCES) * when.length)];
    await seek(video, time);
    const found = await detector.detect(video, time);
    if (stopped()) return null;
    counts.push(distinct(found).length);
  }
  counts.sort();
  if (counts.at(-1) === 0)
    throw new FilmError("Nobody was found in the video: film one or two people from head to feet, in good light.");
  if (counts[1] > 2) throw new FilmError("There are three people or more in the video: film one or two.");
  return Math.min(Math.max(1, counts[Math.floor(GLANCES / 2)]), 2);
}

const TORSO = [11, 12, 23, 24]; // shoulders and hips

/** People without those found twice in one place. */
export function distinct(people) {
  const kept = [];
  for (const person of people) {
    const size = Math.hypot(...[0, 1].map((k) => person.image[11][k] + person.image[12][k] - person.image[23][k] - person.image[24][k])) / 2;
    const same = (other) => {
      const away = TORSO.map((i) => Math.hypot(...[0, 1].map((k) => person.image[i][k] - other.image[i][k])));
      return away.reduce((sum, value) => sum + value, 0) / TORSO.length < 0.25 * size;
    };
    if (!kept.some(same)) kept.push(person);
  }
  return kept;
}
