// The pace of a stream in the player: little is in hand, and it does not run dry.

import assert from "node:assert/strict";
import test from "node:test";

import { Clock } from "../../../static/player/clock.js";
import { Pace } from "../../../static/player/clock.js";

/** Mean frames in hand and the share of pictures with none, in the last six seconds of twelve. */
function simulated({ late = 0, ahead, paced = true }) {
  const clock = new Clock();
  const pace = new Pace();
  Object.assign(clock, { frames: 1e6, frame: 0, limit: ahead, playing: true, last: 0 });
  const lags = [];
  let known = ahead + 1;
  let dry = 0;
  // Two frames every fifteenth of a second, every fourth message late; drawn sixty times a second.
  const arrivals = Array.from({ length: 180 }, (_, i) => ((i + 1) * 1000) / 15 + (i % 4 === 3 ? late : 0));
  for (let tick = 1; tick < 720; tick += 1) {
    const now = (tick * 1000) / 60;
    clock.advance(now);
    while (arrivals.length && arrivals[0] <= now) {
      const hurry = pace.add(arrivals.shift(), known - 1 - clock.frame);
      if (paced) clock.hurry = hurry;
      known += 2;
      clock.limit = known - 1;
    }
    if (now < 6000) continue;
    lags.push(known - 1 - clock.frame);
    dry += clock.frame >= clock.limit;
  }
  return { lag: lags.reduce((a, b) => a + b) / lags.length, dry: dry / lags.length };
}

for (const ahead of [1, 4, 7]) {
  test(`with ${ahead} frames in hand at first, those that are not needed are caught up with`, () => {
    const found = simulated({ ahead });
    assert.ok(found.lag < 2.2, "two frames come at once, so that at least one is in hand on average");
    assert.ok(found.dry < 0.15);
  });
}

test("without the pace a stream stays behind", () => {
  assert.ok(simulated({ ahead: 7, paced: false }).lag > 6);
});

test("where messages come late, as much is kept in hand as that takes", () => {
  const [punctual, late] = [0, 60].map((ms) => simulated({ late: ms, ahead: 7 }));
  assert.ok(punctual.lag + 0.8 < late.lag && late.lag < 4.5);
  assert.ok(late.dry < 0.15);
});
