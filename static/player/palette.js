// Colours of both themes. A is blue and B orange, a pair that all common kinds of colour-blindness
// keep apart; left limbs are a lighter tint and right limbs a deeper shade of the same hue. Both are
// greyer while a motion is given, before what was predicted.

const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
const person = (middle, left, right) => ({ middle: hex(middle), left: hex(left), right: hex(right) });

export const THEMES = {
  light: {
    background: hex("#f4f6fa"),
    grid: hex("#cdd5e1"),
    gridStrong: hex("#a9b5c7"),
    shadow: hex("#d5dce7"),
    shadowCore: hex("#c3ccda"),
    outline: hex("#ffffff"),
    ghost: hex("#8e99aa"),
    people: [person("#2468d8", "#5c9cf5", "#17479e"), person("#e07a10", "#f7a944", "#b25606")],
    given: [person("#7186ab", "#9fb2d2", "#566a8c"), person("#b09070", "#cdb498", "#8c7053")],
    curve: ["#475569", "#94a3b8"],
  },
  dark: {
    background: hex("#12161e"),
    grid: hex("#262e3b"),
    gridStrong: hex("#3a4658"),
    shadow: hex("#0b0e14"),
    shadowCore: hex("#06080c"),
    outline: hex("#0c1017"),
    ghost: hex("#667389"),
    people: [person("#4f94f7", "#8fc0ff", "#2f6bd0"), person("#f2933a", "#ffc27a", "#c96a14")],
    given: [person("#7f92b5", "#a9bad6", "#64769a"), person("#b59a7d", "#d0bba2", "#93795e")],
    curve: ["#cbd5e1", "#64748b"],
  },
};

export const mix = (a, b, t) => [0, 1, 2].map((i) => a[i] + t * (b[i] - a[i]));
export const css = (c) => `rgb(${c.slice(0, 3).map((v) => Math.round(255 * v)).join(",")})`;

/** Gradio marks its dark theme with a class on body. */
export const themeName = () => (document.body.classList.contains("dark") ? "dark" : "light");
