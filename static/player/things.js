// Things beside the people: chairs and cups, drawn as bodies are, but stiff. webdemo/view/things.py packs them.

import { fromBase64 } from "./base64.js";
import { Figure, normalsOf } from "./body.js";
import { HIGHEST } from "./ground.js";
import { hex } from "./palette.js";

const SHADE = 0.3; // darkness of the shadow for each square metre of surface, as in webdemo/view/theme.py
const AT = 1.5; // metres from a window or the like within which somebody is at it, as in webdemo/view/camera.py

/** A thing of a payload, as typed arrays in world axes. */
export function decodeThing(stored) {
  const vertices = new Float32Array(fromBase64(stored.vertices).buffer);
  const faces = new Uint16Array(fromBase64(stored.faces).buffer);
  const zones = stored.palette;
  return {
    kind: stored.kind, frames: stored.frames, stands: stored.stands,
    vertices, faces, zones,
    normals: normalsOf(vertices, faces),
    faceZones: fromBase64(stored.face_colours),
    colors: Object.fromEntries(zones.map((zone) => [zone, hex(zone)])),
    sky: new Float32Array(vertices.length / 3).fill(1),
    joints: [], spots: stored.spots,
    places: new Float32Array(fromBase64(stored.places).buffer),
    turns: Float32Array.from(new Int16Array(fromBase64(stored.turns).buffer), (v) => v / 32767),
  };
}

/** Rotation, 9 numbers row by row, and place of a thing at a fractional frame, in world axes. */
export function poseOf(thing, frame) {
  const { frames, places, turns } = thing;
  const at = Math.min(Math.max(frame, 0), frames - 1);
  const before = Math.floor(at);
  const after = Math.min(before + 1, frames - 1);
  const t = at - before;
  const between = (values, width) => Array.from({ length: width }, (_, i) => values[width * before + i] * (1 - t) + values[width * after + i] * t);
  const q = between(turns, 4);
  const n = Math.hypot(...q) || 1;
  const [x, y, z, w] = q.map((v) => v / n);
  const rotation = [
    1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
  ];
  return { rotation, place: between(places, 3) };
}

/** A thing's surface at a moment, lit as a body is. */
export class ThingFigure extends Figure {
  /** Puts a thing that has one frame elsewhere: x, y, z and its rotation as x, y, z, w. */
  place(pose) {
    this.body.places.set(pose.slice(0, 3));
    this.body.turns.set(pose.slice(3));
  }

  /** Its place and the corners of its box, in the scene's axes, of a thing that stands where it is. */
  get box() {
    this.measured ??= this.measure();
    return this.measured;
  }

  measure() {
    const { rotation: r, place: [east, up, south] } = poseOf(this.body, 0);
    const { vertices } = this.body;
    const ends = [0, 1, 2].map((k) => {
      const values = vertices.filter((_, i) => i % 3 === k);
      return [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
    });
    const corners = Array.from({ length: 8 }, (_, n) => {
      const [x, y, z] = ends.map((pair, k) => pair[(n >> k) & 1]);
      const [a, b, c] = [0, 3, 6].map((i) => r[i] * x + r[i + 1] * y + r[i + 2] * z);
      return [c + south, a + east, b + up];
    });
    return { place: [south, east], corners };
  }

  /** Brings the surface to a frame; axes become the scene's, (z, x, y). */
  move(frame) {
    const { body, vertices, normals } = this;
    const { rotation: r, place } = poseOf(body, frame);
    const { vertices: rest, normals: straight } = body;
    const spin = (from, to, shift) => {
      for (let i = 0; i < from.length; i += 3) {
        const [x, y, z] = [from[i], from[i + 1], from[i + 2]];
        to[i] = r[6] * x + r[7] * y + r[8] * z + shift[2];
        to[i + 1] = r[0] * x + r[1] * y + r[2] * z + shift[0];
        to[i + 2] = r[3] * x + r[4] * y + r[5] * z + shift[1];
      }
    };
    spin(rest, vertices, place);
    spin(straight, normals, [0, 0, 0]);
    this.spots = body.spots.map(([x, y, z, area]) => {
      const [east, up, south] = [0, 3, 6].map((i) => r[i] * x + r[i + 1] * y + r[i + 2] * z);
      return [south + place[2], east + place[0], up + place[1], area];
    });
  }
}

/** All things of a motion as one mesh. */
export class Things {
  constructor(things) {
    this.figures = things.map((thing) => new ThingFigure(thing));
    const corners = this.figures.reduce((sum, { body }) => sum + body.faces.length, 0);
    this.positions = new Float32Array(3 * corners);
    this.colors = new Float32Array(4 * corners);
  }

  /** Places and lights them all: { positions, colors } for Scene.setTriangles(). */
  at(frame, lamps, lens, scale) {
    let first = 0;
    for (const figure of this.figures) {
      figure.move(frame);
      figure.shade(figure.body.colors, lamps, lens, scale);
      this.positions.set(figure.positions, 3 * first);
      this.colors.set(figure.colors, 4 * first);
      first += figure.body.faces.length;
    }
    return { positions: this.positions, colors: this.colors };
  }

  /** The corners of each window or the like at which one of some people is: what a camera holds beside them. */
  beside(people, root) {
    return this.figures.filter(({ body }) => body.stands).map(({ box }) => box).filter(({ place: [x, y] }) => (
      people.some((points) => Math.hypot(points[root][0] - x, points[root][1] - y) < AT)
    )).map(({ corners }) => corners);
  }

  /** What shades the floor: [x, y, width, darkness] of each spot. */
  get shades() {
    return this.figures.flatMap(({ spots }) => spots.map(([x, y, z, area]) => {
      const height = Math.max(z, 0);
      return [x, y, 0.05 + 0.17 * height, SHADE * area * Math.max(1 - height / HIGHEST, 0) ** 2];
    }));
  }
}
