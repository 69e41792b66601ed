// The colours of both themes as numbers. A is blue and B orange, a pair that all common kinds of colour-blindness
// keep apart. On skeletons left limbs are a lighter tint and right limbs a deeper shade of the same hue.
// Everything is greyer while a motion is given, before what was predicted.
//
// Of colours.json, which Python reads as well (motion/looks.py), `floor` is the floor at the camera's target, `far` the
// floor in the distance, `horizon` the sky right above it; `people` are the middle, left and right limbs of A's and B's
// skeletons, `given` those of a motion that is given.

import COLOURS from "./colours.json" with { type: "json" };

const REACH = 18; // metres from the camera's target after which the floor is as dim as it gets

export const mix = (a, b, t) => [0, 1, 2].map((i) => a[i] + t * (b[i] - a[i]));
export const smooth = (t) => t * t * (3 - 2 * t);
export const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
const each = (named, change) => Object.fromEntries(Object.entries(named).map(([name, value]) => [name, change(value)]));
const limbs = ([middle, left, right]) => each({ middle, left, right }, hex);
const greyer = (zones) => each(zones, (color) => {
  const grey = 0.3 * color[0] + 0.55 * color[1] + 0.15 * color[2];
  return mix(color, [grey, grey, grey].map((v) => 0.75 * v + 0.14), 0.72);
});

function theme({ shade, lamps, bodies, people, given, curve, ...plain }) {
  const worn = bodies.map((zones) => each(zones, hex));
  return {
    ...each(plain, hex), shade, lamps, curve,
    bodies: worn, givenBodies: worn.map(greyer),
    people: people.map(limbs), given: given.map(limbs),
  };
}

export const THEMES = each(COLOURS, theme);

/** The floor at a distance in metres from the camera's target: it grows dimmer towards the horizon. */
export const floorAt = (theme, metres) => mix(theme.floor, theme.far, smooth(Math.min(metres / REACH, 1)));

/** The sky at an angle in radians above the horizon. */
export const skyAt = (theme, angle) => mix(theme.horizon, theme.sky, smooth(Math.min(angle / 0.55, 1)));

export const css = (c) => `rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(",")})`;

/** Makes a page of our own dark or light as it is `asked` for, or else as the system is. */
export function follow(asked = null) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => {
    const on = document.body.classList.toggle("dark", asked === "dark" || (asked !== "light" && dark.matches));
    document.documentElement.style.colorScheme = on ? "dark" : "light";
  };
  dark.addEventListener("change", paint);
  paint();
}

/** Gradio marks its dark theme with a class on body. */
export const themeName = () => (document.body.classList.contains("dark") ? "dark" : "light");
