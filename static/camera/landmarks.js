// What is sent to the server of a film: landmarks as small whole numbers, never a picture.
// motion/video/landmarks.py reads it.

import { toBase64 } from "../player/base64.js";

const POINTS = 33;
const clamp = (value, most) => Math.max(-most, Math.min(most, Math.round(value)));

export class Landmarks {
  /** `width` and `height` of the film in pixels. */
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.times = [];
    this.counts = [];
    this.people = [];
  }

  add(time, people) {
    this.times.push(time);
    this.counts.push(people.length);
    this.people.push(...people);
  }

  /** The fields that go to the server. */
  pack() {
    const { people } = this;
    const world = new Int16Array(3 * POINTS * people.length);
    const image = new Int16Array(2 * POINTS * people.length);
    const seen = new Uint8Array(POINTS * people.length);
    people.forEach((person, n) => {
      person.world.forEach((point, i) => point.forEach((metres, k) => (world[3 * (POINTS * n + i) + k] = clamp(1000 * metres, 32767))));
      person.image.forEach((point, i) => point.forEach((share, k) => (image[2 * (POINTS * n + i) + k] = clamp(8000 * share, 32767))));
      person.seen.forEach((share, i) => (seen[POINTS * n + i] = Math.round(255 * Math.max(0, Math.min(1, share)))));
    });
    return {
      landmarks: 1,
      width: this.width,
      height: this.height,
      times: toBase64(new Uint32Array(this.times.map((seconds) => Math.round(1000 * seconds)))),
      counts: toBase64(new Uint8Array(this.counts)),
      world: toBase64(world),
      image: toBase64(image),
      seen: toBase64(seen),
    };
  }
}
