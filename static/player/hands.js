// Finger shapes: motion/hands.py in the browser, number for number (a test compares the bodies).

import { fromBase64 } from "./base64.js";
import shapes from "./hands.json" with { type: "json" };
import { apply, multiply, rotation, smoothStep } from "./pose.js";

const FINGERS = 5;
const BLEND = 0.22; // seconds over which fingers go from one shape to another

/** Bends in radians, three a finger from the thumb on, and how far fingers are closed: 20 numbers a shape. */
export const SHAPES = Object.fromEntries(Object.entries(shapes).map(([name, { bends, close }]) => [
  name, Float64Array.from([...bends.flat().map((v) => (v * Math.PI) / 180), ...Array(FINGERS).fill(close)]),
]));
export const RELAXED = [SHAPES.relaxed, SHAPES.relaxed];

/** The shapes of a person's hands, left first, at a fractional frame; `grips` are [person, side, shape, start, stop]. */
export function shapesAt(grips, person, frame, fps) {
  if (!grips?.length) return RELAXED;
  const hands = RELAXED.map((each) => Float64Array.from(each));
  const half = (BLEND * fps) / 2;
  for (const [who, side, name, start, stop] of grips) {
    if (who !== person || !SHAPES[name]) continue;
    const rise = start === 0 ? 1 : (frame - start + half) / (2 * half);
    const share = smoothStep(Math.min(rise, (stop + half - frame) / (2 * half)), 0, 1);
    const hand = hands[side === "left" ? 0 : 1];
    for (let i = 0; i < hand.length; i++) hand[i] += share * (SHAPES[name][i] - hand[i]);
  }
  return hands;
}

/** The fingers of a body of static/bodies. */
export function decodeFingers(stored) {
  return {
    joints: stored.joints, flex: stored.flex, close: stored.close, normals: stored.normals,
    vertices: new Uint16Array(fromBase64(stored.vertices).buffer),
    bones: fromBase64(stored.bones),
    weights: Float32Array.from(fromBase64(stored.weights), (v) => v / 255),
  };
}

/** Rotation and place of each of the 30 joints in the pose of binding, for the shapes of both hands. */
function moves(fingers, hands) {
  const { joints, flex, close, normals } = fingers;
  const out = [];
  for (let side = 0; side < 2; side++) {
    for (let finger = 0; finger < FINGERS; finger++) {
      const first = 15 * side + 3 * finger;
      const closing = hands[side][15 + finger] * close[FINGERS * side + finger];
      let turn = rotation(normals[side].map((v) => closing * v));
      let place = joints[first];
      for (let k = 0; k < 3; k++) {
        const joint = first + k;
        if (k) {
          const bone = joints[joint].map((v, i) => v - joints[joint - 1][i]);
          place = apply(turn, bone).map((v, i) => v + out[joint - 1].place[i]);
        }
        turn = multiply(turn, rotation(flex[joint].map((v) => hands[side][3 * finger + k] * v)));
        out.push({ turn, place });
      }
    }
  }
  return out;
}

/** Writes the shaped hands into `vertices` and `normals`, which are copies of those of the body as it is bound. */
export function shapeHands(body, hands, vertices, normals) {
  const { fingers } = body;
  const found = moves(fingers, hands);
  fingers.vertices.forEach((vertex, h) => {
    const rest = [0, 1, 2].map((i) => body.vertices[3 * vertex + i]);
    const straight = [0, 1, 2].map((i) => body.normals[3 * vertex + i]);
    const at = [...rest];
    const facing = [...straight];
    for (let slot = 0; slot < 3; slot++) {
      const share = fingers.weights[3 * h + slot];
      if (!share) continue;
      const joint = fingers.bones[3 * h + slot];
      const { turn, place } = found[joint];
      const moved = apply(turn, rest.map((v, i) => v - fingers.joints[joint][i]));
      const turned = apply(turn, straight);
      for (let i = 0; i < 3; i++) {
        at[i] += share * (moved[i] + place[i] - rest[i]);
        facing[i] += share * (turned[i] - straight[i]);
      }
    }
    for (let i = 0; i < 3; i++) [vertices[3 * vertex + i], normals[3 * vertex + i]] = [at[i], facing[i]];
  });
}
