// Paths on the floor: what they say, who can walk them, and from the picture to the floor and back.

import assert from "node:assert/strict";
import test from "node:test";

import { floorUnder, lines, onFloor } from "../../../static/player/paths/walks.js";
import { inside, lengthOf, named, passing, timed, trouble } from "../../../static/player/paths/walks.js";
import { FIELD_OF_VIEW, Orbit } from "../../../static/player/orbit.js";
import { project } from "../../../static/player/overlay.js";

const L = [[0, 0, 0], [null, 3, 0], [null, 3, 1.8]];

test("a path has a length, a name and a time for each point", () => {
  assert.equal(lengthOf(L).toFixed(2), "4.80");
  assert.equal(named("a", L), "A’s path 4.8 m");
  assert.equal(named("b", [[1.5, 0, 0], [null, 1, 0]]), "B’s path 1.0 m from 1.5 s");
  assert.equal(named("b", [[2, 1, 1]]), "B is here at 2.0 s");
  const times = timed(L, 10).map(([seconds]) => Number(seconds.toFixed(2)));
  assert.deepEqual(times, [0, 2.5, 4], "at a walk");
  assert.equal(timed(L, 3).at(-1)[0].toFixed(2), "2.97", "at the latest when the motion ends");
  assert.deepEqual(inside([9.123, -8.4]), [8, -8]);
});

test("what nobody can walk is refused, and the reason names the way and the time", () => {
  assert.equal(trouble(L, 5), "");
  assert.match(trouble(L, 1), /^Nobody runs 4\.8 m from 0\.0 s on: draw it shorter/);
  assert.match(trouble([[0, 0, 0], [0.5, 3, 0]], 5), /^Nobody runs 3\.0 m in 0\.5 s/);
  assert.match(trouble([[4.9, 0, 0], [null, 0.5, 0], [null, 1, 0]], 5), /Nobody runs/);
});

test("a place at a moment joins a path in its order, and takes the place of another one there", () => {
  assert.deepEqual(passing([], 2, [1, 1], 5), [[2, 1, 1]]);
  const both = passing([[2, 1, 1]], 0, [0, 0], 5);
  assert.deepEqual(both, [[0, 0, 0], [2, 1, 1]]);
  assert.deepEqual(passing(both, 2.1, [1.5, 1], 5), [[0, 0, 0], [2.1, 1.5, 1]]);
  assert.deepEqual(passing([[0, 0, 0], [null, 2.4, 0]], 1, [1.2, 0.5], 5), [[0, 0, 0], [1, 1.2, 0.5], [2, 2.4, 0]]);
  assert.ok(passing([], 5, [0, 0], 5)[0][0] < 5, "within the motion");
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
