// Things: what Python packs comes back, and moves as it says.

import assert from "node:assert/strict";
import test from "node:test";

import { decodeThing, poseOf, ThingFigure, Things } from "../../../static/player/things.js";

const text = (values) => Buffer.from(values.buffer).toString("base64");
const near = (found, wanted, message) => found.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) < 2e-3, `${message}: ${[...found]}`));

/** One triangle that moves by a metre along Y and turns by a quarter about Y. */
const stored = {
  kind: "own", name: "kite", frames: 2,
  vertices: text(new Float32Array([0, 0, 0, 1, 0, 0, 0, 0, -1])),
  faces: text(new Uint16Array([0, 1, 2])),
  face_colours: text(new Uint8Array([1])),
  palette: ["#000000", "#ff8000"],
  spots: [[1, 0, 0, 0.5]],
  places: text(new Float32Array([0, 0, 0, 0, 1, 0])),
  turns: text(new Int16Array([0, 0, 0, 32767, 0, 23170, 0, 23170])),
};

test("a thing is decoded with its colours and normals", () => {
  const thing = decodeThing(stored);
  near(thing.colors[thing.zones[thing.faceZones[0]]], [1, 128 / 255, 0], "colour");
  near(thing.normals.slice(0, 3), [0, 1, 0], "normal");
});

test("its pose lies between its frames and ends with the last", () => {
  const thing = decodeThing(stored);
  near(poseOf(thing, 0.5).place, [0, 0.5, 0], "place");
  near(poseOf(thing, 9).place, [0, 1, 0], "after the end");
  const { rotation } = poseOf(thing, 0.5);
  near(rotation, [Math.SQRT1_2, 0, Math.SQRT1_2, 0, 1, 0, -Math.SQRT1_2, 0, Math.SQRT1_2], "an eighth of a turn");
});

test("its surface is moved into the scene's axes, z, x, y, with what shades the floor", () => {
  const figure = new ThingFigure(decodeThing(stored));
  figure.move(1);
  near(figure.vertices, [0, 0, 1, -1, 0, 1, 0, -1, 1], "vertices");
  near(figure.spots[0], [-1, 0, 1, 0.5], "spot");
});

test("a thing of one frame is put elsewhere while a stream goes on", () => {
  const one = { ...stored, frames: 1, places: text(new Float32Array([0, 0, 0])), turns: text(new Int16Array([0, 0, 0, 32767])) };
  const figure = new ThingFigure(decodeThing(one));
  figure.place([0, 1, 0, 0, Math.SQRT1_2, 0, Math.SQRT1_2]);
  figure.move(57);
  const moved = new ThingFigure(decodeThing(stored));
  moved.move(1);
  near(figure.vertices, moved.vertices, "vertices");
});

test("the corners of a window at which somebody is are beside them, and of no other thing", () => {
  const at = (x, stands) => ({ ...stored, stands, frames: 1, places: text(new Float32Array([x, 0, 0])), turns: text(new Int16Array([0, 0, 0, 32767])) });
  const things = new Things([at(0, true), at(9, true), at(0, false)].map(decodeThing));
  const person = (x) => [[0, x, 1]]; // the scene's axes are z, x, y
  const found = things.beside([person(-1), person(5)], 0);
  assert.equal(found.length, 1);
  const ends = [0, 1, 2].map((k) => found[0].map((corner) => corner[k]));
  near(ends.map((values) => Math.min(...values)), [-1, 0, 0], "lowest");
  near(ends.map((values) => Math.max(...values)), [0, 1, 0], "highest");
  assert.equal(things.beside([person(-2)], 0).length, 0);
});
