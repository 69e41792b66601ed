// Eyes that turn to what is seen, as far as eyes do without the head: motion/body.py in the browser, number for number.

import { apply, smoothStep } from "./pose.js";

const ASIDE = (26 * Math.PI) / 180;
const UP = (8 * Math.PI) / 180;
const SEES = [55, 85].map((degrees) => (degrees * Math.PI) / 180); // beside where the face points

/** The eyes of a stored body whose vertices and faces are decoded, or null for one whose eyes do not turn. */
export function decodeEyes(middles, { vertices, faces, faceZones, zones }) {
  if (!middles) return null;
  const isEye = zones.map((zone) => zone === "eyes" || zone === "whites");
  const used = [...new Set(faces.filter((_, corner) => isEye[faceZones[(corner / 3) | 0]]))];
  return { middles, vertices: used, sides: used.map((v) => (vertices[3 * v] < 0 ? 1 : 0)) };
}

/** Rotation of both eyes to a place in the frame of binding, row by row. */
function turnTo(middles, place) {
  const [x, y, z] = [0, 1, 2].map((i) => place[i] - (middles[0][i] + middles[1][i]) / 2);
  const aside = Math.atan2(x, z);
  const share = 1 - smoothStep(Math.abs(aside), ...SEES);
  const yaw = share * ASIDE * Math.tanh(aside / ASIDE);
  const pitch = share * UP * Math.tanh(Math.atan2(y, Math.hypot(x, z)) / UP);
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return [cy, -sy * sp, sy * cp, 0, cp, sp, -sy, -cy * sp, cy * cp];
}

/** Writes the eyes, turned to a place in the frame of binding, into `vertices`, a copy of the body's as it is bound. */
export function turnEyes({ eyes, vertices: rest }, place, vertices) {
  const turn = turnTo(eyes.middles, place);
  eyes.vertices.forEach((v, e) => {
    const middle = eyes.middles[eyes.sides[e]];
    const out = apply(turn, [0, 1, 2].map((i) => rest[3 * v + i] - middle[i]));
    for (let i = 0; i < 3; i++) vertices[3 * v + i] = middle[i] + out[i];
  });
}
