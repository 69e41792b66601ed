// The cameraman: each view holds its own pair, equally large in all of them, large in the stage, and never cut.

import assert from "node:assert/strict";
import test from "node:test";

import { FIELD_OF_VIEW, Orbit } from "../../../static/player/orbit.js";
import { project } from "../../../static/player/overlay.js";
import { fit, heading, moments, preset } from "../../../static/player/views.js";

const BOX = { width: 1000, height: 620, inset: { top: 44, right: 24, bottom: 22, left: 24 } };
const PANE = { ...BOX, width: 500 };
const SKELETON = { head: 0, pelvis: 1, hips: [2, 3] };
const CROWN = 0.2; // metres of a head over its joint
const HEIGHTS = [1.6, 0.95, 0.9, 0.9, 0, 0];

/** A person standing at a place: head, pelvis, hips, feet. */
const standing = (x, y) => HEIGHTS.map((height, joint) => [x, y + [0, 0, 0.1, -0.1, 0.1, -0.1][joint], height]);
const pair = (x, y, apart = 0.8) => [standing(x - apart / 2, y), standing(x + apart / 2, y)];
const still = (people, box = PANE) => ({ now: people, soon: people, box });
const seen = (people, view, { width, height }) =>
  people.flatMap((points) => [...points, [points[0][0], points[0][1], points[0][2] + CROWN]].map((p) => project(p, view.matrix, width, height, FIELD_OF_VIEW)));
const ends = (values) => [Math.min(...values), Math.max(...values)];

function cut(pairs) {
  const orbit = new Orbit();
  Object.assign(orbit, preset("threequarter", heading(pairs[0].now, SKELETON)));
  orbit.cut(fit(pairs, SKELETON, orbit));
  return orbit;
}

test("pairs in different places stand in the middle of their own views", () => {
  const pairs = [pair(0, 0), pair(3, 5)];
  const orbit = cut(pairs.map((people) => still(people)));
  pairs.forEach((people, index) => {
    const [left, right] = ends(seen(people, orbit.view(index), PANE).map(([x]) => x));
    assert.ok(Math.abs((left + right) / 2 - PANE.width / 2) < 12, `${left} to ${right}`);
  });
});

test("people beside each other are equally large, whoever needs more room", () => {
  const pairs = [pair(0, 0), pair(3, 5, 3)];
  const orbit = cut(pairs.map((people) => still(people)));
  const alone = cut([still(pairs[0])]);
  assert.ok(orbit.distance > alone.distance + 0.5, "the wide pair needs more");
  const tall = pairs.map(([person], index) => {
    const view = orbit.view(index);
    const middle = view.target; // where both stand equally far from the eye
    const [low, high] = ends(seen([standing(middle[0], middle[1])], view, PANE).map(([, y]) => y));
    return { person, size: high - low };
  });
  assert.ok(Math.abs(tall[0].size / tall[1].size - 1) < 0.02, `${tall[0].size} and ${tall[1].size}`);
});

test("a pair fills about seven tenths of the stage's height", () => {
  const people = pair(2, -1);
  const [top, bottom] = ends(seen(people, cut([still(people, BOX)]).view(), BOX).map(([, y]) => y));
  const share = (bottom - top) / BOX.height;
  assert.ok(share > 0.66 && share < 0.85, `${share}`);
});

test("nobody is cut while two walk up to each other and away together, and what they left soon takes no room", () => {
  const clock = { frames: 240, fps: 30 };
  const at = (frame) => {
    const t = frame / clock.fps;
    return pair(1.3 * Math.max(t - 3, 0), 0, 0.8 + 1.6 * Math.max(2 - t, 0));
  };
  const wanted = (orbit, frame) => fit([{ now: at(frame), soon: moments(frame, clock).flatMap(at), box: BOX }], SKELETON, orbit);
  const orbit = new Orbit();
  Object.assign(orbit, preset("threequarter", 0));
  orbit.cut(wanted(orbit, 0));
  const shares = [];
  let fastest = 0;
  for (let frame = 0; frame < clock.frames; frame += 1) {
    const before = orbit.view().target;
    orbit.step(1 / clock.fps, wanted(orbit, frame));
    fastest = Math.max(fastest, Math.hypot(...orbit.view().target.map((v, i) => v - before[i])) * clock.fps);
    const spots = seen(at(frame), orbit.view(), BOX);
    const [[left, right], [top, bottom]] = [0, 1].map((axis) => ends(spots.map((spot) => spot[axis])));
    assert.ok(left > 0 && right < BOX.width && top > 0 && bottom < BOX.height, `frame ${frame}: ${[left, right, top, bottom]}`);
    shares.push((bottom - top) / BOX.height);
  }
  assert.ok(fastest < 1.6, `the camera goes no faster than who is followed: ${fastest} m/s`);
  assert.ok(shares[84] > 0.62, `close to each other for a second, they are large: ${shares[84]}`);
});

test("a view that has come since begins at its own pair", () => {
  const orbit = cut([still(pair(0, 0))]);
  const wanted = fit([still(pair(0, 0)), still(pair(3, 5))], SKELETON, orbit);
  assert.equal(orbit.settled(wanted), false);
  orbit.step(1 / 30, wanted);
  assert.deepEqual(orbit.view(1).target, wanted.targets[1]);
});

test("a window at which somebody is lies in the view as well", () => {
  const people = pair(0, 0);
  const window = [[-1.2, 2.5, 0], [1.2, 2.5, 2.2]];
  const inside = (view) => window.map((p) => project(p, view.matrix, PANE.width, PANE.height, FIELD_OF_VIEW)).every((at) => (
    at[2] > 0 && at[0] >= 0 && at[0] <= PANE.width && at[1] >= 0 && at[1] <= PANE.height
  ));
  assert.ok(inside(cut([{ now: people, soon: people, used: [window], box: PANE }]).view()));
  assert.ok(!inside(cut([still(people)]).view()), "it is not where nobody uses it");
});
