// Paths on the floor: what they say, and from the picture to the floor and back.

import assert from "node:assert/strict";
import test from "node:test";

import { floorUnder, inside, lengthOf, lines, named, onFloor } from "../../../static/player/paths/walks.js";
import { FIELD_OF_VIEW, Orbit } from "../../../static/player/orbit.js";
import { project } from "../../../static/player/overlay.js";

const L = [[0, 0, 0], [null, 3, 0], [null, 3, 1.8]];

test("a path has a length and a name", () => {
  assert.equal(lengthOf(L).toFixed(2), "4.80");
  assert.equal(named("a", L), "A’s path 4.8 m");
  assert.equal(named("b", [[1.5, 0, 0], [null, 1, 0]]), "B’s path 1.0 m from 1.5 s");
  assert.equal(named("b", [[2, 1, 1]]), "B is here at 2.0 s");
  assert.deepEqual(inside([9.123, -8.4]), [8, -8]);
});

test("a place in the picture is the place of the floor that is seen there", () => {
  const orbit = new Orbit();
  const { yaw, elevation, eye } = orbit;
  const [width, height] = [960, 640];
  for (const place of [[0, 0], [1.2, -0.7], [-2, 1.5]]) {
    const spot = project([place[1], place[0], 0], orbit.view().matrix, width, height, FIELD_OF_VIEW);
    floorUnder(spot, { yaw, elevation, eye }, width, height).forEach((v, i) => assert.ok(Math.abs(v - place[i]) < 1e-6));
  }
  assert.equal(floorUnder([480, 0], { yaw, elevation: 0.05, eye }, width, height), null, "the sky");
});

test("lines are drawn where the path is, in the colour of their person", () => {
  const drawn = lines([{ person: "b", points: [[0, 1, 2], [null, 3, 4]] }], [], ["blue", "orange"]);
  assert.deepEqual(drawn.points[0], onFloor([1, 2]));
  assert.ok(drawn.colors.every((color) => color === "orange"));
  assert.equal(drawn.points.length, drawn.sizes.length);
});
