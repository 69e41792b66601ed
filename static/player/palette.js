// Colours of both themes. A is blue and B orange, a pair that all common kinds of colour-blindness
// keep apart. On skeletons left limbs are a lighter tint and right limbs a deeper shade of the same hue.
// Everything is greyer while a motion is given, before what was predicted.

export const mix = (a, b, t) => [0, 1, 2].map((i) => a[i] + t * (b[i] - a[i]));
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
const person = (middle, left, right) => ({ middle: hex(middle), left: hex(left), right: hex(right) });
const worn = (top, trousers, shoes, skin, hair, eyes) => {
  const all = { top, trousers, shoes, skin, hair, eyes };
  return Object.fromEntries(Object.entries(all).map(([zone, color]) => [zone, hex(color)]));
};
const greyer = (zones) => Object.fromEntries(Object.entries(zones).map(([zone, color]) => {
  const grey = 0.3 * color[0] + 0.55 * color[1] + 0.15 * color[2];
  return [zone, mix(color, [grey, grey, grey].map((v) => 0.75 * v + 0.14), 0.72)];
}));

const BODIES = [
  worn("#2a6bdc", "#1f3c7d", "#16233f", "#dfd3cb", "#28375a", "#10141d"),
  worn("#e87a1c", "#7d421a", "#3f2413", "#e6d3c3", "#5d3a22", "#140f0c"),
];
const DARK_BODIES = [
  worn("#3f86ff", "#2a4f9c", "#1d2f57", "#dfd3cb", "#314674", "#10141d"),
  worn("#ff912e", "#94501f", "#54301a", "#e6d3c3", "#714829", "#140f0c"),
];

export const THEMES = {
  light: {
    background: hex("#f1f4f9"),
    sky: hex("#dfe7f2"), horizon: hex("#f4f6fa"), floor: hex("#e3e8f0"),
    grid: hex("#cad2de"),
    gridStrong: hex("#b6c1d1"),
    shade: [0.55, 0.59, 0.68],
    ghost: hex("#8e99aa"),
    lamps: { key: [0.78, 0.75, 0.7], sky: [0.4, 0.43, 0.48], ground: [0.2, 0.2, 0.21], rim: [0.5, 0.53, 0.58], shine: 0.07 },
    bodies: BODIES,
    givenBodies: BODIES.map(greyer),
    people: [person("#2468d8", "#5c9cf5", "#17479e"), person("#e07a10", "#f7a944", "#b25606")],
    given: [person("#7186ab", "#9fb2d2", "#566a8c"), person("#b09070", "#cdb498", "#8c7053")],
    curve: ["#475569", "#94a3b8"],
  },
  dark: {
    background: hex("#10141c"),
    sky: hex("#0b0e14"), horizon: hex("#222a37"), floor: hex("#1b212c"),
    grid: hex("#2c3543"),
    gridStrong: hex("#3d4a5d"),
    shade: [0.3, 0.32, 0.38],
    ghost: hex("#667389"),
    lamps: { key: [0.84, 0.82, 0.79], sky: [0.3, 0.34, 0.42], ground: [0.14, 0.15, 0.17], rim: [1.0, 1.05, 1.15], shine: 0.08 },
    bodies: DARK_BODIES,
    givenBodies: DARK_BODIES.map(greyer),
    people: [person("#4f94f7", "#8fc0ff", "#2f6bd0"), person("#f2933a", "#ffc27a", "#c96a14")],
    given: [person("#7f92b5", "#a9bad6", "#64769a"), person("#b59a7d", "#d0bba2", "#93795e")],
    curve: ["#cbd5e1", "#64748b"],
  },
};

/** Tints of futures that stand side by side; apart from both people's, and from each other for all common eyes. */
export const FUTURES = ["#1f9d72", "#b13fc9", "#c2a40a"].map(hex);

export const css = (c) => `rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(",")})`;

/** Gradio marks its dark theme with a class on body. */
export const themeName = () => (document.body.classList.contains("dark") ? "dark" : "light");
