// What can be done to a story, as functions from one story to another; nothing here knows the page.

export const SHORTEST = 0.5;
export const LONGEST = 30;
const GUESS = 4; // seconds of a beat whose length has not been worked out yet

/** A story without anything. */
export const empty = () => ({ beats: [], paths: [], poses: [], loop: false, planned: true, span: null, ahead: false });

/** A story as the server gave it, with its own fields alone. */
export function read(given) {
  const story = empty();
  for (const key of Object.keys(story)) story[key] = given?.[key] ?? story[key];
  return story;
}

/** What is said in the beats, as a text that is the same where the words are. */
export const wordsOf = (story) => JSON.stringify((story?.beats ?? []).map(({ words, a, b }) => [words || "", a || "", b || ""]));

/** Seconds of a beat: as set, as worked out from its words, or a guess. */
export const lengthOf = (beat) => beat.seconds ?? beat.auto ?? GUESS;

/** Seconds at which the beats begin, and at which the last ends. */
export function edges(story) {
  const found = [0];
  for (const beat of story.beats) found.push(found.at(-1) + lengthOf(beat));
  return found;
}

/** The story with other beats, of which number i was number `origins[i]`, or is new (-1): poses stay with their beats.
 *
 * A pose keeps its time since its beat began, or comes to the beat's end where that is earlier now. A beat that is
 * deleted takes its poses along; those behind the last beat keep their time since its end.
 */
function withBeats(story, beats, origins = beats.map((_, i) => i)) {
  const [before, after] = [edges(story), edges({ beats })];
  const poses = story.poses.flatMap((found) => {
    const from = before.findLastIndex((start) => start <= found.seconds + 1e-4);
    if (from === before.length - 1) {
      return [{ ...found, seconds: momentOf(frameOf(found.seconds + after.at(-1) - before.at(-1))) }];
    }
    let to = origins.indexOf(from);
    if (to < 0) return [];
    let since = found.seconds - before[from];
    if (origins[to + 1] === from && since >= lengthOf(beats[to])) since -= lengthOf(beats[to++]); // it was split
    const latest = frameOf(after[to + 1]) - 1;
    return [{ ...found, seconds: momentOf(Math.min(frameOf(after[to] + since), latest)) }];
  });
  return { ...story, beats, poses: inOrder(poses) };
}

const numbers = (story) => story.beats.map((_, i) => i);

/** A beat of these words more, after the one of number `after`. */
export function add(story, after, words) {
  const beats = [...story.beats];
  beats.splice(after + 1, 0, { words, a: "", b: "", seconds: null, seed: null });
  return withBeats(story, beats, numbers(story).toSpliced(after + 1, 0, -1));
}

export function remove(story, index) {
  return withBeats(story, story.beats.toSpliced(index, 1), numbers(story).toSpliced(index, 1));
}

/** Two beats of half the length with the same words; nothing where the halves would be too short. */
export function split(story, index) {
  const beat = story.beats[index];
  const half = Math.round(5 * lengthOf(beat)) / 10;
  if (half < SHORTEST) return story;
  const beats = [...story.beats];
  beats.splice(index, 1, { ...beat, seconds: half }, { ...beat, seconds: half });
  return withBeats(story, beats, numbers(story).toSpliced(index, 1, index, index));
}

export function move(story, index, by) {
  const to = index + by;
  if (to < 0 || to >= story.beats.length) return story;
  const [beats, origins] = [[...story.beats], numbers(story)];
  for (const list of [beats, origins]) [list[index], list[to]] = [list[to], list[index]];
  return withBeats(story, beats, origins);
}

/** Sets fields of a beat; the length that follows from its words stays until the server has worked it out again. */
export function change(story, index, fields) {
  return withBeats(story, story.beats.map((beat, i) => (i === index ? { ...beat, ...fields } : beat)));
}

/** Lengths that follow from the words, as the server worked them out. */
export function measured(story, lengths) {
  return withBeats(story, story.beats.map((beat, i) => ({ ...beat, auto: lengths[i] })));
}

export function stretch(story, index, seconds) {
  const whole = Math.round(10 * Math.min(Math.max(seconds, SHORTEST), LONGEST)) / 10;
  return change(story, index, { seconds: whole });
}

/** The path of a person; without points it is gone. */
export function path(story, person, points) {
  const others = story.paths.filter((found) => found.person !== person);
  const paths = points.length ? [...others, { person, points }] : others;
  return { ...story, paths: paths.sort((p, q) => (p.person < q.person ? -1 : 1)) };
}

const FPS = 30;
const FRAME = 1e4; // moments are kept to a ten-thousandth of a second, as the server writes them
const AROUND = 1; // seconds on both sides of a pose that are made again with it

/** The moment of a frame, and the frame of a moment. */
export const momentOf = (frame) => Math.round((FRAME * frame) / FPS) / FRAME;
export const frameOf = (seconds) => Math.round(FPS * seconds);

const inOrder = (poses) => poses.sort((p, q) => p.seconds - q.seconds || (p.person < q.person ? -1 : 1));

/** A person's pose at a frame; another one that they had there is gone. */
export function pose(story, person, frame, positions) {
  const others = story.poses.filter((found) => found.person !== person || frameOf(found.seconds) !== frame);
  return { ...story, poses: inOrder([...others, { person, seconds: momentOf(frame), positions }]) };
}

export const poseAt = (story, person, frame) => story.poses.find((p) => p.person === person && frameOf(p.seconds) === frame);

export function movePose(story, index, frame) {
  const poses = story.poses.map((found, i) => (i === index ? { ...found, seconds: momentOf(Math.max(frame, 0)) } : found));
  return { ...story, poses: inOrder(poses) };
}

export function removePose(story, index) {
  return { ...story, poses: story.poses.filter((_, i) => i !== index) };
}

/** The span that is made again for a pose: a second on both sides, within a motion of so many seconds. */
export function spanAround(seconds, total) {
  const [from, to] = [Math.max(seconds - AROUND, 0), Math.min(seconds + AROUND, total)];
  return [Math.floor(10 * from) / 10, Math.min(Math.ceil(10 * to) / 10, total)];
}

/** Keeps what a story was, so that it can be undone and redone. */
export class Past {
  constructor() {
    this.before = [];
    this.after = [];
  }

  keep(story) {
    this.before.push(story);
    if (this.before.length > 200) this.before.shift();
    this.after = [];
  }

  /** Goes from the story of now to the one before it ("undo") or after it ("redo"), if there is one. */
  travel(way, now) {
    const [from, to] = way === "undo" ? [this.before, this.after] : [this.after, this.before];
    if (!from.length) return now;
    to.push(now);
    return from.pop();
  }
}
