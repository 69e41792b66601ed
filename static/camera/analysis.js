// From a film to landmarks: where the person is in every picture.

import { FilmError, seek, times } from "./film.js";
import { Landmarks } from "./landmarks.js";
import { say } from "../texts.js";

/**
 * Looks through the film in `video`; `each(done, all, people)` hears of every picture, and `stopped()` says whether to
 * stop. Returns the landmarks, or null where it was stopped; throws a FilmError for a film without anybody.
 */
export async function analyse(video, detector, { each = () => {}, stopped = () => false } = {}) {
  const when = times(video);
  await detector.begin();
  const landmarks = new Landmarks(video.videoWidth, video.videoHeight);
  for (const [i, time] of when.entries()) {
    await seek(video, time);
    const found = await detector.detect(video, time);
    if (stopped()) return null;
    landmarks.add(time - when[0], found);
    each(i + 1, when.length, found);
  }
  if (!landmarks.people.length) throw new FilmError(say("camera.nobody"));
  return landmarks;
}
