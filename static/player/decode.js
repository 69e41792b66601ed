// From a payload of webdemo/view/payload.py to motions as typed arrays, and what is known of their skeleton.

import { fromBase64 } from "./base64.js";
import { decodeThing, Things } from "./things.js";

/** Undoes pack_positions: metres as Float32Array in (people, frames, joints, 3) order. */
export function unpackPositions(packed) {
  const bytes = fromBase64(packed.data);
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

export const UNSAID = ["man", "woman"]; // looks, motion/looks.py

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
  const { id, title, joint_names: names, parents, stream, rounds, samples } = payload;
  return {
    id, title: title || "", names, parents, stream: Boolean(stream), rounds,
    samples: samples.map(unpackSample),
  };
}

// Half the width of the limb about the bone that ends in a joint, metres; the first pattern that matches wins.
const RADII = [[/spine|torso|chest|pelvis/, 0.08], [/hip|knee/, 0.066], [/./, 0.045]];
export const SMPL22 = [
  "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle", "spine3",
  "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder", "right_shoulder",
  "left_elbow", "right_elbow", "left_wrist", "right_wrist",
];

const sideOf = (name) => (/left|^l[_A-Z]/.test(name) ? "left" : /right|^r[_A-Z]/.test(name) ? "right" : "middle");
const radiusOf = (name) => RADII.find(([pattern]) => pattern.test(name.toLowerCase()))[1];
const find = (names, ...patterns) => {
  for (const pattern of patterns) {
    const at = names.findIndex((name) => pattern.test(name.toLowerCase()));
    if (at >= 0) return at;
  }
  return -1;
};

/** Bones, joints and those that the player names, from names and parents. */
export function describe(names, parents) {
  const bones = [];
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    const fromTrunk = sideOf(names[parent]) === "middle"; // limbs begin at the collar and the hip
    bones.push({ from: parent, to: joint, side: fromTrunk ? "middle" : sideOf(names[joint]), radius: radiusOf(names[joint]) });
  });
  const joints = names.map((name) => ({ side: sideOf(name) }));
  const pelvis = Math.max(find(names, /pelvis|hips$/, /base_of_spine/, /torso/), 0);
  return {
    wears: names.join() === SMPL22.join(), // whether bodies fit
    bones, joints, pelvis,
    head: find(names, /^head$/, /head/), neck: find(names, /neck/),
    hips: [find(names, /left_?hip|l_?hip/), find(names, /right_?hip|r_?hip/)],
  };
}
