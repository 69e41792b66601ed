// Whom a partner answers: the webcam's picture, or a person of the player.

import { toBase64 } from "../player/base64.js";
import { FilmError } from "../camera/film.js";
import { Landmarks } from "../camera/landmarks.js";
import { closeWebcam, openWebcam } from "../camera/webcam.js";
import { say } from "../texts.js";

const FASTEST = 33; // milliseconds from picture to picture
const BATCH = 2; // poses of a clip in a message
const nap = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** The webcam's pictures in a video element, looked at as fast as can be. */
export class Webcam {
  constructor(video, detector) {
    Object.assign(this, { video, detector });
    this.latest = -1;
  }

  async begin() {
    await openWebcam(this.video);
    if (this.over) return closeWebcam(this.video);
    await this.detector.begin();
    await this.detector.detect(this.video, 0); // the first picture takes seconds
    this.began = performance.now() - 100;
  }

  /** The next picture: who is in it, and at what second; null after the last one. */
  async next() {
    const { video } = this;
    while (!this.over) {
      if (!video.srcObject?.active) return null; // it was unplugged
      const wait = FASTEST - (performance.now() - (this.at ?? -FASTEST));
      if (wait > 0) await nap(wait);
      if (video.readyState >= 2 && video.currentTime !== this.latest) break;
      await nap(5);
    }
    if (this.over) return null;
    this.latest = video.currentTime;
    this.at = performance.now();
    const time = (this.at - this.began) / 1000;
    const people = await this.detector.detect(video, time);
    if (this.over) return null;
    return { people, time };
  }

  /** The message about several pictures. */
  pack(seen) {
    const landmarks = new Landmarks(this.video.videoWidth, this.video.videoHeight);
    for (const { time, people } of seen) landmarks.add(time, people);
    return landmarks.pack();
  }

  end() {
    this.over = true;
    closeWebcam(this.video);
  }
}

/** A person of the player, pose by pose at the pace of their motion. */
export class Person {
  waits = true; // for a slow server: of a recording nothing is left out

  constructor(player) {
    const sample = player?.sample;
    if (!sample || sample.live || !sample.motion) throw new FilmError(say("live.nobody_chosen"));
    Object.assign(this, { motion: sample.motion, fps: sample.fps, place: 0 });
  }

  async begin() {}

  /** The next poses, from one frame to another; null after the last ones. */
  async next() {
    const { frames } = this.motion;
    this.began ??= performance.now(); // once the server hears
    if (this.over || this.place >= frames) return null;
    const last = Math.min(this.place + BATCH, frames);
    const due = this.began + (1000 * (last - 1)) / this.fps;
    const wait = due - performance.now();
    if (wait > 0) await nap(wait);
    if (this.over) return null;
    const from = this.place;
    this.place = last;
    return { from, to: last };
  }

  /** The message about poses that follow each other: in millimetres and world axes. */
  pack(seen) {
    const [from, to] = [seen[0].from, seen.at(-1).to];
    const width = 3 * this.motion.joints;
    const metres = this.motion.values.subarray(width * from, width * to);
    const poses = Int16Array.from(metres, (value) => Math.max(-32767, Math.min(32767, Math.round(1000 * value))));
    return { times: Array.from({ length: to - from }, (_, i) => (from + i) / this.fps), poses: toBase64(poses) };
  }

  end() {
    this.over = true;
  }
}
