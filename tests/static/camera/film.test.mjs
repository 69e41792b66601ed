// A picture of a film that the browser has let go of is sought again before it is looked at.
import assert from "node:assert/strict";
import { test } from "node:test";

import { hold } from "../../../static/camera/film.js";

class Video extends EventTarget {
  duration = 10;
  sought = [];

  constructor(readyState) {
    super();
    this.readyState = readyState;
  }

  set currentTime(time) {
    this.sought.push(time);
    queueMicrotask(() => {
      this.readyState = 2;
      this.dispatchEvent(new Event("seeked"));
    });
  }
}

test("a picture that is gone is sought again", async () => {
  const video = new Video(1);
  await hold(video, 4.2);
  assert.deepEqual(video.sought, [4.2]);
});

test("a picture that is there is left alone", async () => {
  const video = new Video(2);
  await hold(video, 4.2);
  assert.deepEqual(video.sought, []);
});
