// What is sent to the server of a film: landmarks as small whole numbers, never a picture.
// motion/video/landmarks.py reads it.

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

  /** The text that goes to the server; `known` is what else is known of the film. */
  pack(known = {}) {
    const { people } = this;
    const world = new Int16Array(3 * POINTS * people.length);
    const image = new Int16Array(2 * POINTS * people.length);
    const seen = new Uint8Array(POINTS * people.length);
    people.forEach((person, n) => {
      person.world.forEach((point, i) => point.forEach((metres, k) => (world[3 * (POINTS * n + i) + k] = clamp(1000 * metres, 32767))));
      person.image.forEach((point, i) => point.forEach((share, k) => (image[2 * (POINTS * n + i) + k] = clamp(8000 * share, 32767))));
      person.seen.forEach((share, i) => (seen[POINTS * n + i] = Math.round(255 * Math.max(0, Math.min(1, share)))));
    });
    return JSON.stringify({
      ...known,
      landmarks: 1,
      width: this.width,
      height: this.height,
      times: encode(new Uint32Array(this.times.map((seconds) => Math.round(1000 * seconds)))),
      counts: encode(new Uint8Array(this.counts)),
      world: encode(world),
      image: encode(image),
      seen: encode(seen),
    });
  }
}

function encode(array) {
  const bytes = new Uint8Array(array.buffer);
  let text = "";
  for (let start = 0; start < bytes.length; start += 8192) text += String.fromCharCode(...bytes.subarray(start, start + 8192));
  return btoa(text);
}
