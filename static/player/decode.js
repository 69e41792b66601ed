// The browser's side of webdemo/view/payload.py: JSON in, typed arrays out.

import { decodeThing, Things } from "./things.js";

/** Undoes pack_positions: metres as Float32Array in (people, frames, joints, 3) order. */
export function unpackPositions(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const values = new Float32Array(bytes.length / 2);
  for (let i = 0; i < values.length; i++) {
    const axis = i % 3;
    values[i] = packed.min[axis] + packed.scale[axis] * view.getUint16(2 * i, true);
  }
  const [people, frames, joints] = packed.shape;
  return { values, people, frames, joints };
}

/**
 * The scene's axes for a world point: plotly turns its turntable about z, the world has Y up, and
 * (z, x, y) keeps the hand of the axes.
 */
export const toScene = (x, y, z) => [z, x, y];

/** Joint positions at a fractional frame: an array a person of [x, y, z] a joint, in scene axes. */
export function poseAt(motion, frame) {
  const { values, people, frames, joints } = motion;
  const last = frames - 1;
  const at = Math.min(Math.max(frame, 0), last);
  const before = Math.floor(at);
  const after = Math.min(before + 1, last);
  const t = at - before;
  const pose = [];
  for (let p = 0; p < people; p++) {
    const i0 = 3 * joints * (p * frames + before);
    const i1 = 3 * joints * (p * frames + after);
    const points = new Array(joints);
    for (let j = 0; j < joints; j++) {
      const [a, b] = [i0 + 3 * j, i1 + 3 * j];
      points[j] = toScene(
        values[a] + t * (values[b] - values[a]),
        values[a + 1] + t * (values[b + 1] - values[a + 1]),
        values[a + 2] + t * (values[b + 2] - values[a + 2]),
      );
    }
    pose.push(points);
  }
  return pose;
}

const UNSAID = ["man", "woman"]; // looks, motion/looks.py

const unpackSample = (sample) => ({
  ...sample,
  looks: sample.looks ?? UNSAID,
  motion: unpackPositions(sample.positions),
  things: new Things((sample.things ?? []).map(decodeThing)),
  ghostMotion: sample.ghost ? unpackPositions(sample.ghost) : null,
  cells: sample.cells?.map(unpackSample) ?? null,
});

/** A payload as the player keeps it. */
export function decode(payload) {
  const { id, title, joint_names: names, parents, live, stream, rounds, futures = null, samples } = payload;
  return {
    id, title: title || "", names, parents, live: Boolean(live), stream: Boolean(stream), rounds, futures,
    samples: samples.map(unpackSample),
  };
}
