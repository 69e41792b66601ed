// A motion that is still being made: what has come of the second person is put beside the first.

import { unpackPositions } from "./decode.js";

const AHEAD = 12; // frames that must be there before the clock starts, so that it need not wait for each message

/** Marks a sample of one person as one whose second person comes in messages. */
export function begin(sample) {
  const { values, frames, joints } = sample.motion;
  const both = new Float32Array(2 * values.length);
  both.set(values);
  both.set(values, values.length);
  sample.live = { known: 0, text: "", second: { values: both, people: 2, frames, joints } };
}

/**
 * Takes a message: frames from `start` on. Returns whether it is the first one. Messages repeat the last
 * frames of those before; where one was missed all the same, its frames are drawn between their neighbours.
 */
export function arrive(sample, message) {
  const { live } = sample;
  const { values: made, frames } = unpackPositions(message.frames);
  const { values, frames: all, joints } = live.second;
  const width = 3 * joints;
  const at = (frame) => width * (all + frame);
  const first = live.known === 0;
  values.set(made, at(message.start));
  const gap = message.start - live.known;
  if (first) sample.roles = [...sample.roles, "reactor"];
  else if (gap > 0) {
    const [from, to] = [at(live.known - 1), at(message.start)];
    for (let k = 1; k <= gap; k++) {
      for (let i = 0; i < width; i++) values[from + k * width + i] = values[from + i] + (k / (gap + 1)) * (values[to + i] - values[from + i]);
    }
  }
  const before = live.known;
  live.known = Math.max(before, message.start + frames);
  live.text = message.text;
  sample.motion = live.second;
  if (first) sample.curves = [{ key: "pelvis_distance", label: "Apart", unit: "m", values: [] }];
  for (let frame = before; frame < live.known; frame++) {
    const [a, b] = [width * frame, at(frame)]; // the roots, over the floor
    sample.curves[0].values.push(Math.hypot(values[a] - values[b], values[a + 2] - values[b + 2]));
  }
  return first;
}

/** The last frame that can be shown, or null while there is too little to start with. */
export function reach(sample) {
  const { known } = sample.live;
  return known >= Math.min(AHEAD, sample.frames) ? known - 1 : null;
}

/** What has come is all there is. */
export function end(sample) {
  const { live } = sample;
  sample.live = null;
  if (!live.known) return;
  const { values, frames, joints } = live.second;
  const width = 3 * joints;
  const cut = new Float32Array(2 * width * live.known);
  for (let person = 0; person < 2; person++) cut.set(values.subarray(width * frames * person, width * (frames * person + live.known)), width * live.known * person);
  Object.assign(sample, { frames: live.known, motion: { values: cut, people: 2, frames: live.known, joints } });
}
