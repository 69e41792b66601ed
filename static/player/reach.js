// A pose that is pulled at: a hand, a foot, the hips or the head goes where it is asked to, as far as it reaches, and
// every bone keeps its length. Poses are SMPL22's joints, [x, y, z] each in scene axes (z up, the floor at 0).
//
// motion/ik.py fits whole clips over seconds of computing; a hand that is held by the pointer needs an answer within
// a frame, so arms and legs are solved in closed form (two bones and the plane they bend in), and the spine by cyclic
// coordinate descent with limits (Wang & Chen 1991). Nothing here knows the page.

import { SMPL22 } from "./decode.js";
import { apply, cross, dot, rotation, smoothStep, sub, swing, unit } from "./pose.js";

const UP = [0, 0, 1];
const FOLDED = 0.5; // radians between the bones of a limb that is bent as far as it goes
const BENT = [0.005, 0.03]; // metres of a middle joint off the straight line between which it knows where it points
const STRAIGHT = 0.9995; // of a limb's length
const SOLE = 0.02; // metres over the floor that toes keep
const HEEL = 0.05; // and ankles
const PALM = 0.04; // and wrists
const LOWEST_HIPS = 0.12;
const LIFTED = [0.12, 0.4]; // heights of an ankle between which its foot begins to turn with the shin
const TURNS = 24; // of the descent along the spine
const STEP = 0.12; // radians of one turn of one joint
const SPINE = [["neck", 0.6], ["spine3", 0.3], ["spine2", 0.3], ["spine1", 0.4], ["pelvis", 0.4]]; // most radians each

const AT = Object.fromEntries(SMPL22.map((name, i) => [name, i]));
const LEGS = ["hip", "knee", "ankle", "foot"].flatMap((part) => [AT[`left_${part}`], AT[`right_${part}`]]);
const TRUNK = SMPL22.map((_, i) => i).filter((i) => i && !LEGS.includes(i)); // all that the spine carries

/** What can be pulled at: [joint, what it is called]. */
export const HANDLES = [
  [AT.left_wrist, "left hand"], [AT.right_wrist, "right hand"], [AT.left_ankle, "left foot"],
  [AT.right_ankle, "right foot"], [AT.pelvis, "hips"], [AT.head, "head"],
];

const add = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);

/** The pose in which `joint`, one of HANDLES', is as near to `target` as it gets; `points` stays as it is. */
export function pull(points, joint, target) {
  const pose = points.map((p) => [...p]);
  if (joint === AT.pelvis) moveHips(pose, target);
  else if (joint === AT.head) moveHead(pose, target);
  else if (joint === AT.left_wrist || joint === AT.right_wrist) moveHand(pose, joint === AT.left_wrist ? "left" : "right", target);
  else moveFoot(pose, joint === AT.left_ankle ? "left" : "right", target);
  return pose;
}

/** The pose with the whole person elsewhere. */
export function carry(points, by) {
  const lowest = Math.min(...points.map((p) => p[2]));
  const down = Math.max(by[2], Math.min(SOLE - lowest, 0));
  return points.map((p) => add(p, [by[0], by[1], down]));
}

function moveHand(pose, side, target) {
  const [shoulder, elbow, wrist] = ["shoulder", "elbow", "wrist"].map((part) => AT[`${side}_${part}`]);
  const across = sub(pose[AT.left_shoulder], pose[AT.right_shoulder]);
  const ahead = unit(cross(across, sub(pose[AT.neck], pose[AT.pelvis])));
  const above = Math.max(target[2], Math.min(PALM, pose[wrist][2]));
  limb(pose, [shoulder, elbow, wrist], [target[0], target[1], above], add([0, 0, -1], ahead, -1)); // elbows point back and down
}

function moveFoot(pose, side, target) {
  const [hip, knee, ankle, foot] = ["hip", "knee", "ankle", "foot"].map((part) => AT[`${side}_${part}`]);
  const sole = sub(pose[foot], pose[ankle]);
  const shin = unit(sub(pose[ankle], pose[knee]));
  const ground = Math.min(SOLE, pose[foot][2]); // a foot that stands deeper may stay there
  const kept = Math.min(Math.max(HEEL, ground - sole[2]), pose[ankle][2]);
  limb(pose, [hip, knee, ankle], [target[0], target[1], Math.max(target[2], kept)], ahead(pose));
  const turned = apply(swing(shin, unit(sub(pose[ankle], pose[knee]))), sole);
  const share = smoothStep(pose[ankle][2], ...LIFTED);
  const mixed = unit(add(add([0, 0, 0], sole, 1 - share), turned, share));
  pose[foot] = add(pose[ankle], mixed, length(sole));
  level(pose, ankle, foot, ground);
}

/** The trunk goes along, feet stay where they stand for as long as legs reach. */
function moveHips(pose, target) {
  const by = sub([target[0], target[1], Math.max(target[2], LOWEST_HIPS)], pose[AT.pelvis]);
  const hint = ahead(pose);
  for (const joint of [AT.pelvis, ...TRUNK]) pose[joint] = add(pose[joint], by);
  for (const side of ["left", "right"]) {
    const [hip, knee, ankle, foot] = ["hip", "knee", "ankle", "foot"].map((part) => AT[`${side}_${part}`]);
    const [stood, sole] = [pose[ankle], sub(pose[foot], pose[ankle])];
    const lowest = Math.min(SOLE, pose[foot][2]);
    const bend = [sub(pose[knee], pose[hip]), sub(pose[ankle], pose[hip])];
    const lengths = [length(bend[0]), length(sub(pose[ankle], pose[knee]))];
    pose[hip] = add(pose[hip], by);
    bendLimb(pose, [hip, knee, ankle], stood, lengths, bend, hint);
    pose[foot] = add(pose[ankle], sole);
    level(pose, ankle, foot, lowest);
  }
}

/** Turns a foot up that points below `lowest`. */
function level(pose, ankle, foot, lowest) {
  const sole = sub(pose[foot], pose[ankle]);
  const long = length(sole);
  const deep = Math.min(Math.max(lowest - pose[ankle][2], -long), long);
  if (sole[2] >= deep) return;
  const flat = unit([sole[0], sole[1], 0]);
  pose[foot] = add(pose[ankle], add([0, 0, deep], flat, Math.sqrt(long * long - deep * deep)));
}

function moveHead(pose, target) {
  const turned = Object.fromEntries(SPINE.map(([name]) => [name, [0, 0, 0]])); // what each joint has been turned by so far
  for (let turn = 0; turn < TURNS && length(sub(pose[AT.head], target)) > 1e-3; turn++) {
    for (const [name, most] of SPINE) {
      const pivot = pose[AT[name]];
      const [axis, angle] = between(sub(pose[AT.head], pivot), sub(target, pivot));
      bendSpine(pose, turned, name, most, add(turned[name], axis, Math.min(angle, STEP)));
    }
  }
}

/** Axis and angle of the smallest turn of one direction into another. */
function between(from, to) {
  const axis = cross(unit(from), unit(to));
  return [unit(axis), Math.atan2(length(axis), dot(unit(from), unit(to)))];
}

/** Turns what a joint of the spine carries so that its turns come to `wanted`, or to `most` radians of it. */
function bendSpine(pose, turned, name, most, wanted) {
  const k = Math.min(1, most / (length(wanted) || 1));
  const by = sub(wanted.map((v) => k * v), turned[name]); // small turns add up like vectors
  if (length(by) < 1e-6) return;
  turned[name] = add(turned[name], by);
  const [m, pivot] = [rotation(by), pose[AT[name]]];
  for (const joint of carriedBy(name)) pose[joint] = add(pivot, apply(m, sub(pose[joint], pivot)));
}

/** Joints that a joint of the spine carries. */
function carriedBy(name) {
  if (name === "neck") return [AT.head];
  const below = { pelvis: [], spine1: ["spine1"], spine2: ["spine1", "spine2"], spine3: ["spine1", "spine2", "spine3"] }[name];
  return TRUNK.filter((joint) => !below.includes(SMPL22[joint]));
}

/** Where a body faces, level with the floor. */
function ahead(pose) {
  return unit(cross(sub(pose[AT.left_hip], pose[AT.right_hip]), UP));
}

function limb(pose, chain, target, hint) {
  const [root, middle, end] = chain.map((joint) => pose[joint]);
  const bend = [sub(middle, root), sub(end, root)];
  bendLimb(pose, chain, target, [length(bend[0]), length(sub(end, middle))], bend, hint);
}

/**
 * Puts the end of two bones, of `lengths`, at `target` or as near as it reaches. The middle joint stays in the plane
 * in which it was bent, which turns along with the limb; `hint` says where it points where the limb was straight.
 * `bend` holds what led from the root to the middle and to the end.
 */
function bendLimb(pose, [root, middle, end], target, [upper, lower], bend, hint) {
  const way = sub(target, pose[root]);
  const least = Math.sqrt(upper * upper + lower * lower - 2 * upper * lower * Math.cos(FOLDED));
  const d = Math.min(Math.max(length(way), least), STRAIGHT * (upper + lower));
  const along = length(way) > 1e-6 ? unit(way) : unit(bend[1]);
  const before = unit(bend[1]);
  const out = add(bend[0], before, -dot(bend[0], before));
  const vague = 0.01 * (1 - smoothStep(length(out), ...BENT));
  const turned = apply(swing(before, along), add(out, unit(hint), vague));
  const aside = unit(add(turned, along, -dot(turned, along)));
  const forth = (d * d + upper * upper - lower * lower) / (2 * d);
  const high = Math.sqrt(Math.max(upper * upper - forth * forth, 0));
  pose[middle] = add(add(pose[root], along, forth), aside, high);
  pose[end] = add(pose[root], along, d);
}
