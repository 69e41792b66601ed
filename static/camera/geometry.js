// Where bodies are in a picture, from their points as shares of its width and height.

const [LEFT_SHOULDER, RIGHT_SHOULDER, LEFT_HIP, RIGHT_HIP] = [11, 12, 23, 24];
const SAME = 0.6; // torso lengths: bodies whose middles are closer together are one

const middle = (person, a, b) => [0, 1].map((k) => (person.image[a][k] + person.image[b][k]) / 2);

/** The middle of the hips. */
export const hips = (person) => middle(person, LEFT_HIP, RIGHT_HIP);

/** Pixels from the middle of the shoulders to that of the hips. */
export function torso(person, width, height) {
  const [top, low] = [middle(person, LEFT_SHOULDER, RIGHT_SHOULDER), hips(person)];
  return Math.hypot((top[0] - low[0]) * width, (top[1] - low[1]) * height);
}

/** People without those found twice in one place. */
export function distinct(people, width, height) {
  const kept = [];
  for (const person of people) {
    const [size, [x, y]] = [torso(person, width, height), hips(person)];
    const same = (other) => {
      const [theirX, theirY] = hips(other);
      return Math.hypot((x - theirX) * width, (y - theirY) * height) < SAME * Math.max(size, torso(other, width, height));
    };
    if (!kept.some(same)) kept.push(person);
  }
  return kept;
}
