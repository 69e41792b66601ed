// The film look: a slow move of the camera that keeps the view from which it is switched on.

import assert from "node:assert/strict";
import test from "node:test";

globalThis.matchMedia = () => ({ matches: globalThis.rest ?? false });

const { Filming, hazy, move } = await import("../../../static/player/filming.js");
const { Orbit } = await import("../../../static/player/orbit.js");
const { THEMES, floorAt, skyAt } = await import("../../../static/player/palette.js");

/** A player as far as the film look needs one, in the middle of four seconds. */
function lab() {
  const [classes, orbit] = [new Set(), new Orbit()];
  const root = { classList: { toggle: (name, on) => (on ? classes.add(name) : classes.delete(name)) }, style: { setProperty() {} } };
  const player = {
    root, orbit, classes, theme: THEMES.light, data: {}, sample: { live: null }, scene: { drawn: 0 },
    clock: { shown: 30, frames: 121, duration: 4 }, refresh: () => { player.scene.drawn += 1; },
  };
  player.filming = new Filming(player);
  player.wait = (seconds) => {
    for (let t = 0; t < seconds; t += 0.05) player.filming.step(0.05);
  };
  return player;
}

test("the camera begins where it ends, slowly, and comes nearer between", () => {
  for (const seconds of [1, 4, 10, 60]) {
    const at = (share) => move(share, seconds);
    assert.ok(Math.abs(at(0).yaw) < 1e-9 && Math.abs(at(1).yaw) < 1e-9);
    assert.ok(at(0).away > 1.05 && Math.abs(at(0.5).away - 1) < 1e-9);
    assert.ok(at(0.25).yaw > 0 && at(0.75).yaw < 0);
    for (let share = 0; share < 1; share += 0.01) {
      assert.ok(Math.abs(at(share + 0.01).yaw - at(share).yaw) / (0.01 * seconds) <= 0.1201, "radians a second");
      assert.ok(Math.abs(at(share).yaw) <= 0.25);
    }
  }
});

test("the same moment is always seen from the same place, and a second press brings back the view from before", () => {
  const player = lab();
  const before = player.orbit.view();
  player.filming.toggle();
  player.wait(2);
  assert.ok(player.filming.settled && player.classes.has("pdd-film"));
  const seen = player.orbit.view();
  assert.ok(Math.hypot(...seen.eye.map((v, i) => v - before.eye[i])) > 0.2, "it has moved");
  player.wait(1);
  assert.deepEqual(player.orbit.view(), seen, "it rests while the motion rests");
  player.filming.toggle();
  player.wait(2);
  assert.deepEqual(player.orbit.view(), before);
  assert.ok(!player.classes.has("pdd-film"));
});

test("a hand ends it and goes on from what is seen", () => {
  const player = lab();
  player.filming.load(true);
  player.wait(2);
  const seen = player.orbit.view();
  player.orbit.turn(0, 0);
  player.filming.leave();
  player.wait(0.1);
  const after = player.orbit.view();
  for (let i = 0; i < 3; i++) assert.ok(Math.abs(after.eye[i] - seen.eye[i]) < 1e-9);
  player.filming.load(true);
  assert.equal(player.filming.on, false, "the visitor's word stays");
});

test("the motion that greets has it, and the next has it only if a visitor wants it", () => {
  const player = lab();
  player.filming.load(true);
  assert.ok(player.filming.on);
  player.filming.load(false);
  assert.ok(!player.filming.on);
  player.filming.toggle();
  player.filming.load(false);
  assert.ok(player.filming.on);
});

test("the camera stays where rest is wanted, and while a motion comes in", () => {
  const player = lab();
  const before = player.orbit.view();
  globalThis.rest = true;
  player.filming.toggle();
  player.wait(2);
  assert.deepEqual(player.orbit.view(), before);
  assert.ok(player.filming.on && player.classes.has("pdd-film"), "the haze is there all the same");
  globalThis.rest = false;
  player.sample.live = {};
  player.wait(2);
  assert.deepEqual(player.orbit.view(), before);
});

test("in haze the floor goes over into the sky, nearer than without", () => {
  for (const theme of Object.values(THEMES)) {
    const haze = hazy(theme);
    assert.deepEqual(floorAt(haze, 0), theme.floor);
    floorAt(haze, haze.reach).forEach((v, i) => assert.ok(Math.abs(v - skyAt(haze, 0)[i]) < 1e-9));
    assert.ok(haze.reach < theme.reach);
  }
});
