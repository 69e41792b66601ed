// A film that somebody chose or recorded, as a video element that can be stepped through.

import { say } from "../texts.js";

export const LONGEST = 60; // seconds
const SHORTEST = 0.5;
const LARGEST = 1e9; // bytes
const RATE = 15; // pictures a second that are looked at
const PATIENCE = 8000; // milliseconds for a seek

/** What is wrong with a film and what to do, in a sentence for the person. */
export class FilmError extends Error {}

/** Opens a file in a video element; throws a FilmError for what is no film or cannot be shown here. */
export async function openFilm(video, file) {
  if (file.type.startsWith("image/")) throw new FilmError(say("camera.photo"));
  if (file.size > LARGEST)
    throw new FilmError(say("camera.too_big", { size: (file.size / 1e9).toFixed(1), most: LONGEST }));
  const refuse = (key, facts) => {
    close(video);
    throw new FilmError(say(key, facts));
  };
  video.src = URL.createObjectURL(file);
  video.load();
  const opened = await first(video, { loadeddata: true, error: false }, 20000);
  if (!opened || !video.videoWidth) refuse("camera.codec");
  if (!Number.isFinite(video.duration)) await findEnd(video);
  const { duration } = video;
  if (!(duration >= SHORTEST)) refuse("camera.short");
  if (duration > LONGEST + 0.5) refuse("camera.long", { seconds: Math.round(duration), most: LONGEST });
}

/** Lets go of the film. */
export function close(video) {
  if (video.src.startsWith("blob:")) URL.revokeObjectURL(video.src);
  video.removeAttribute("src");
  video.load();
}

/** The times in seconds at which a film is looked at. */
export function times(video) {
  const count = Math.max(2, Math.floor(Math.min(video.duration, LONGEST) * RATE));
  return Array.from({ length: count }, (_, i) => (i + 0.25) / RATE);
}

/** Shows the picture at a time. */
export async function seek(video, time) {
  const there = first(video, { seeked: true, error: false }, PATIENCE);
  video.currentTime = Math.min(time, video.duration - 1e-3);
  let shown = await there;
  if (shown && video.readyState < 2) shown = await first(video, { canplay: true, error: false }, PATIENCE);
  if (!shown) throw new FilmError(say("camera.broken"));
}

/** A recording says its length only after its end was looked for. */
async function findEnd(video) {
  const found = first(video, { durationchange: true }, PATIENCE);
  video.currentTime = 1e7;
  await found;
  await seek(video, 0);
}

/** The value of the event that comes first; undefined after `patience` milliseconds. */
function first(target, events, patience) {
  return new Promise((resolve) => {
    const names = Object.keys(events);
    const done = (event) => {
      clearTimeout(timer);
      for (const name of names) target.removeEventListener(name, done);
      resolve(event && events[event.type]);
    };
    const timer = setTimeout(done, patience);
    for (const name of names) target.addEventListener(name, done);
  });
}
