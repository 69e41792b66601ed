// A recorded person begins with the first pose that is asked for, and a webcam that is unplugged ends.

import assert from "node:assert/strict";
import test from "node:test";

import { Person, Webcam } from "../../../static/live/sources.js";

test("a person's clock starts once the server hears", async () => {
  const motion = { frames: 10, joints: 1, values: new Float32Array(30) };
  const person = new Person({ sample: { motion, fps: 30 } });
  await person.begin();
  await new Promise((done) => setTimeout(done, 400));
  const began = performance.now();
  while (await person.next());
  assert.ok(performance.now() - began > 250, "the motion is sent at its own pace");
});

test("a webcam without a picture any more ends", async () => {
  const webcam = new Webcam({ readyState: 4, currentTime: -1, srcObject: { active: false } }, null);
  assert.equal(await webcam.next(), null);
});
