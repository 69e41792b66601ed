// How each bone is turned, from joint positions alone: motion/body.py's bone_rotations in the browser, number
// for number (a test compares them). World axes, Y up; a rotation is 9 numbers, row by row.

const LEAST_AHEAD = 0.25; // of the neck's length
const MOST_YAW = 1.2;
const MOST_LEVEL = 0.4;
const MOST_SHIN = 0.9;
const MOST_ROLL = 0.6;
const ARM_BEND = [0.2, 0.55]; // sines of a hinge's bend between which its axis begins to count and counts in full
const LEG_BEND = [0.2, 0.5];
const LOW_FOOT = [0.03, 0.1]; // metres
const LOW_HAND = [0.07, 0.13];
const STEEP_ARM = [0.25, 0.6]; // sines of a forearm's way down
const UP = [0, 1, 0];

export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const times = (a, k) => [k * a[0], k * a[1], k * a[2]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => times(a, 1 / Math.max(norm(a), 1e-9));
const clip = (v, low, high) => Math.min(Math.max(v, low), high);

export function multiply(a, b) {
  const out = new Array(9);
  for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  return out;
}

export const transpose = (m) => [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
export const apply = (m, v) => [m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2], m[6] * v[0] + m[7] * v[1] + m[8] * v[2]];
const column = (m, i) => [m[i], m[3 + i], m[6 + i]];

export function smoothStep(value, low, high) {
  const t = clip((value - low) / (high - low), 0, 1);
  return t * t * (3 - 2 * t);
}

/** Rotation by the length of a vector about its direction (Rodrigues). */
export function rotation(vector) {
  const angle = norm(vector);
  const [x, y, z] = times(vector, 1 / Math.max(angle, 1e-12));
  const [s, c] = [Math.sin(angle), 1 - Math.cos(angle)];
  return [
    1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y,
    c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x,
    c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y),
  ];
}

/** The inverse of rotation(), for less than half a turn. */
function rotationVector(m) {
  const axis = [m[7] - m[5], m[2] - m[6], m[3] - m[1]];
  const sine = norm(axis) / 2;
  return times(axis, Math.atan2(sine, (m[0] + m[4] + m[8] - 1) / 2) / Math.max(2 * sine, 1e-9));
}

/** The smallest rotation of one unit vector onto another. */
export function swing(from, to) {
  const axis = cross(from, to);
  const cosine = dot(from, to);
  if (cosine < -1 + 1e-8) {
    const helper = Math.abs(from[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    return rotation(times(unit(cross(from, helper)), Math.PI));
  }
  const [x, y, z] = axis;
  const k = 1 / Math.max(1 + cosine, 1e-8);
  return [
    1 - k * (y * y + z * z), k * x * y - z, k * x * z + y,
    k * x * y + z, 1 - k * (x * x + z * z), k * y * z - x,
    k * x * z - y, k * y * z + x, 1 - k * (x * x + y * y),
  ];
}

/** Rotation whose Y column is `up` and whose X column is `across` made square to it. */
function frame(up, across) {
  const y = unit(up);
  const x = unit(sub(across, times(y, dot(across, y))));
  const z = cross(x, y);
  return [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
}

/** Signed angle about a unit axis from one vector to another. */
function angleAbout(axis, start, end) {
  const a = sub(start, times(axis, dot(start, axis)));
  const b = sub(end, times(axis, dot(end, axis)));
  return Math.atan2(dot(axis, cross(a, b)), dot(a, b));
}

const bendOf = (first, second, span) => smoothStep(norm(cross(first, second)), ...span);

function hingeTwist(first, second, hinge, span) {
  const angle = angleAbout(first, hinge, cross(first, second));
  return angle * bendOf(first, second, span) * (1 - smoothStep(Math.abs(angle), 2.4, 3.0));
}

/** A hand in line with its forearm, or flat on the floor where it is put there. */
function flatHand(height, forearm, sign) {
  const palm = times(column(forearm, 1), -1);
  const axis = cross(palm, [0, -1, 0]);
  const steep = smoothStep(sign * forearm[3], ...STEEP_ARM);
  const bent = steep * (1 - smoothStep(height, ...LOW_HAND)) * Math.atan2(norm(axis), -palm[1]);
  return multiply(rotation(times(unit(axis), bent)), forearm);
}

/** `rest`: places of SMPL22's joints in the T-pose; `names` its joints. */
export class Poser {
  constructor(names, rest) {
    this.at = Object.fromEntries(names.map((name, i) => [name, i]));
    this.restAt = rest;
  }

  /** World rotations of all bones for points [x, y, z] in world axes. */
  rotations(points) {
    const { at, restAt } = this;
    const world = new Array(points.length);
    const toward = (a, b) => unit(sub(points[at[b]], points[at[a]]));
    const rest = (a, b) => unit(sub(restAt[at[b]], restAt[at[a]]));
    const follow = (base, a, b) => multiply(swing(apply(base, rest(a, b)), toward(a, b)), base);
    const middle = (from) => times([0, 1, 2].map((i) => from[at.left_hip][i] + from[at.right_hip][i]), 0.5);
    const twisted = (angle, axis, base) => multiply(rotation(times(axis, angle)), base);

    const ofPelvis = (from) => frame(sub(from[at.spine1], middle(from)), unit(sub(from[at.left_hip], from[at.right_hip])));
    const ofChest = (from) => frame(unit(sub(from[at.neck], from[at.spine3])), unit(sub(from[at.left_collar], from[at.right_collar])));
    const pelvis = (world[at.pelvis] = multiply(ofPelvis(points), transpose(ofPelvis(restAt))));
    const chest = (world[at.spine3] = multiply(ofChest(points), transpose(ofChest(restAt))));
    const between = rotationVector(multiply(transpose(pelvis), chest));
    world[at.spine1] = follow(multiply(pelvis, rotation(times(between, 1 / 3))), "spine1", "spine2");
    world[at.spine2] = follow(multiply(pelvis, rotation(times(between, 2 / 3))), "spine2", "spine3");

    const ahead = apply(transpose(chest), toward("neck", "head"));
    const yaw = clip(Math.atan2(ahead[0], Math.max(ahead[2], LEAST_AHEAD)), -MOST_YAW, MOST_YAW);
    world[at.neck] = follow(multiply(chest, rotation([0, 0.5 * yaw, 0])), "neck", "head");
    world[at.head] = follow(multiply(chest, rotation([0, yaw, 0])), "neck", "head");
    const pitch = -Math.asin(clip(world[at.head][5], -1, 1)); // people who bend their necks go on looking ahead
    world[at.head] = multiply(world[at.head], rotation([-MOST_LEVEL * Math.tanh((0.6 * pitch) / MOST_LEVEL), 0, 0]));

    for (const [side, sign] of [["left", -1], ["right", 1]]) {
      const [collar, shoulder, elbow, wrist] = ["collar", "shoulder", "elbow", "wrist"].map((n) => `${side}_${n}`);
      world[at[collar]] = follow(chest, collar, shoulder);
      const arm = follow(world[at[collar]], shoulder, elbow);
      const upper = toward(shoulder, elbow);
      const turn = hingeTwist(upper, toward(elbow, wrist), apply(arm, [0, sign, 0]), ARM_BEND);
      world[at[shoulder]] = twisted(0.5 * turn, upper, arm);
      world[at[elbow]] = follow(twisted(turn, upper, arm), elbow, wrist);
      world[at[wrist]] = flatHand(points[at[wrist]][1], world[at[elbow]], sign);

      const [hip, knee, ankle, foot] = ["hip", "knee", "ankle", "foot"].map((n) => `${side}_${n}`);
      const leg = follow(pelvis, hip, knee);
      const [thigh, shin, sole] = [toward(hip, knee), toward(knee, ankle), toward(ankle, foot)];
      const byFoot = (base) => clip(angleAbout(shin, apply(base, rest(ankle, foot)), sole), -MOST_SHIN, MOST_SHIN);
      const byKnee = clip(hingeTwist(thigh, shin, apply(leg, [1, 0, 0]), LEG_BEND), -1.2, 1.2);
      const outward = byKnee + (1 - bendOf(thigh, shin, LEG_BEND)) * 0.6 * byFoot(follow(leg, knee, ankle));
      world[at[hip]] = twisted(outward, thigh, leg);
      const lower = follow(world[at[hip]], knee, ankle);
      world[at[knee]] = twisted(byFoot(lower), shin, lower);
      const loose = follow(world[at[knee]], ankle, foot);
      const low = 1 - smoothStep(points[at[foot]][1], ...LOW_FOOT);
      const roll = clip(angleAbout(sole, column(loose, 1), UP), -MOST_ROLL, MOST_ROLL);
      world[at[ankle]] = twisted(low * roll, sole, loose);
      const raised = Math.asin(clip(-world[at[ankle]][5], 0, 0.9)); // the heel above the toes
      world[at[foot]] = multiply(world[at[ankle]], rotation([-low * raised, 0, 0]));
    }
    return world;
  }
}
