// A body from static/bodies, posed by joint positions and lit: motion/body.py's skin in the browser.

import { decodeFingers, RELAXED, shapeHands } from "./hands.js";
import { fromBase64 } from "./base64.js";
import { apply, dot, multiply, Poser, smoothStep, unit } from "./pose.js";

const GAMMA = 2.2;
const STEPS = 1024;
const ENCODED = Float32Array.from({ length: STEPS + 1 }, (_, i) => (i / STEPS) ** (1 / GAMMA));
const linear = (color) => color.map((v) => v ** GAMMA);

/** What is stored of a body, as typed arrays in world axes; shared by everybody who wears it. */
export function decodeBody(stored) {
  const levels = new Uint16Array(fromBase64(stored.vertices).buffer);
  const vertices = Float32Array.from(levels, (v, i) => stored.min[i % 3] + stored.scale[i % 3] * v);
  const faces = new Uint16Array(fromBase64(stored.faces).buffer);
  return {
    vertices, faces,
    faceZones: fromBase64(stored.face_zones),
    zones: stored.zones,
    normals: normalsOf(vertices, faces),
    sky: Float32Array.from(fromBase64(stored.sky), (v) => v / 255),
    bones: fromBase64(stored.bones),
    weights: Float32Array.from(fromBase64(stored.weights), (v) => v / 255),
    joints: stored.joints,
    turns: stored.turns.map((rows) => rows.flat()),
    fingers: decodeFingers(stored.fingers),
    poser: new Poser(stored.joint_names, stored.rest),
  };
}

/** Unit normals of a surface's vertices. */
export function normalsOf(vertices, faces) {
  const out = new Float32Array(vertices.length);
  const at = (i) => [vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]];
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [at(faces[f]), at(faces[f + 1]), at(faces[f + 2])];
    const [u, v] = [b.map((x, i) => x - a[i]), c.map((x, i) => x - a[i])];
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (let k = 0; k < 3; k++) for (let i = 0; i < 3; i++) out[3 * faces[f + k] + i] += n[i];
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    for (let k = 0; k < 3; k++) out[i + k] /= length;
  }
  return out;
}

/** One person's body: where its vertices are now, and how bright. Scene axes (z, x, y of the world). */
export class Figure {
  constructor(body) {
    this.body = body;
    const count = body.vertices.length;
    const corners = body.faces.length;
    this.vertices = new Float32Array(count);
    this.normals = new Float32Array(count);
    this.light = new Float32Array(count);
    this.positions = new Float32Array(3 * corners); // of each triangle's three corners
    this.colors = new Float32Array(4 * corners);
    this.moves = new Float32Array(12 * body.joints.length);
  }

  /** The surface as it is bound, with its hands in other shapes. */
  shape(hands) {
    const { body } = this;
    if (this.hands && hands.every((hand, side) => hand.every((v, i) => v === this.hands[side][i]))) return;
    this.hands = hands;
    this.bound ??= { vertices: Float32Array.from(body.vertices), normals: Float32Array.from(body.normals) };
    shapeHands(body, hands, this.bound.vertices, this.bound.normals);
  }

  /** Brings the surface to joints [x, y, z] in scene axes; `hands` are the finger shapes of the left and the right. */
  pose(points, hands = RELAXED) {
    this.shape(hands);
    const { body, moves, vertices, normals } = this;
    const world = points.map(([z, x, y]) => [x, y, z]);
    body.poser.rotations(world).forEach((rotation, joint) => {
      const m = multiply(rotation, body.turns[joint]);
      const start = apply(m, body.joints[joint]);
      [2, 0, 1].forEach((axis, row) => { // rows in the scene's order
        for (let i = 0; i < 3; i++) moves[12 * joint + 4 * row + i] = m[3 * axis + i];
        moves[12 * joint + 4 * row + 3] = world[joint][axis] - start[axis];
      });
    });
    const { bones, weights } = body;
    const { vertices: rest, normals: straight } = this.bound;
    const m = new Float32Array(12);
    for (let v = 0, i = 0; i < rest.length; v += 4, i += 3) {
      const first = 12 * bones[v];
      if (weights[v] > 0.999) for (let k = 0; k < 12; k++) m[k] = moves[first + k];
      else {
        for (let k = 0; k < 12; k++) m[k] = weights[v] * moves[first + k];
        for (let b = 1; b < 4; b++) {
          const share = weights[v + b];
          if (!share) continue;
          const from = 12 * bones[v + b];
          for (let k = 0; k < 12; k++) m[k] += share * moves[from + k];
        }
      }
      const [x, y, z, nx, ny, nz] = [rest[i], rest[i + 1], rest[i + 2], straight[i], straight[i + 1], straight[i + 2]];
      vertices[i] = m[0] * x + m[1] * y + m[2] * z + m[3];
      vertices[i + 1] = m[4] * x + m[5] * y + m[6] * z + m[7];
      vertices[i + 2] = m[8] * x + m[9] * y + m[10] * z + m[11];
      normals[i] = m[0] * nx + m[1] * ny + m[2] * nz;
      normals[i + 1] = m[4] * nx + m[5] * ny + m[6] * nz;
      normals[i + 2] = m[8] * nx + m[9] * ny + m[10] * nz;
    }
  }

  /**
   * Lights the surface as in a studio whose lamps go with the camera, and hands out each triangle's corners.
   * `colors` [r, g, b] a zone's name, `lamps` of the theme, `lens` the view, `scale` the scene's.
   */
  shade(colors, lamps, lens, scale) {
    const { body, vertices, normals, light } = this;
    const { forward, eye } = lens;
    const right = unit([forward[1], -forward[0], 0]);
    const lamp = (ahead, aside, up) => unit([0, 1, 2].map((i) => ahead * -forward[i] * (i < 2 ? 1 : 0) + aside * right[i] + (i === 2 ? up : 0)));
    const key = lamp(0.75, -0.75, 0.95);
    const rim = lamp(-0.8, 0.9, 0.55);
    for (let v = 0, i = 0; i < vertices.length; v++, i += 3) {
      const n = [normals[i], normals[i + 1], normals[i + 2]];
      const length = Math.hypot(n[0], n[1], n[2]) || 1;
      n[0] /= length; n[1] /= length; n[2] /= length;
      const open = body.sky[v];
      const above = 0.5 + 0.5 * n[2];
      const facing = dot(n, key);
      const front = Math.max((facing + 0.25) / 1.25, 0);
      const toEye = unit([eye[0] - vertices[i], eye[1] - vertices[i + 1], eye[2] - vertices[i + 2]]);
      const edge = 1 - Math.max(dot(n, toEye), 0);
      const behind = Math.max(dot(n, rim), 0) * edge * edge;
      const shine = Math.max(dot(unit([toEye[0] + key[0], toEye[1] + key[1], toEye[2] + key[2]]), n), 0) ** 22;
      const grounded = smoothStep(vertices[i + 2], -0.05, 0.5);
      const shadowed = open * open;
      for (let c = 0; c < 3; c++) {
        const ambient = (lamps.ground[c] * (1 - above) * (0.4 + 0.6 * grounded) + lamps.sky[c] * above) * shadowed;
        light[i + c] = ambient + lamps.key[c] * front * (0.35 + 0.65 * open) + lamps.rim[c] * behind * open;
      }
      this.shine ??= new Float32Array(vertices.length / 3);
      this.shine[v] = lamps.shine * shine * open;
    }
    this.expand(colors, scale);
  }

  expand(colors, scale) {
    const { body, vertices, light, shine, positions, colors: out } = this;
    const { faces, faceZones, zones } = body;
    const palette = zones.map((zone) => linear(colors[zone] ?? colors.top));
    for (let corner = 0, p = 0, q = 0; corner < faces.length; corner++, p += 3, q += 4) {
      const v = faces[corner];
      const base = palette[faceZones[(corner / 3) | 0]];
      for (let c = 0; c < 3; c++) {
        positions[p + c] = vertices[3 * v + c] * scale[c];
        const value = base[c] * light[3 * v + c] + shine[v];
        out[q + c] = ENCODED[value < 1 ? (STEPS * value) | 0 : STEPS];
      }
      out[q + 3] = 1;
    }
  }
}
