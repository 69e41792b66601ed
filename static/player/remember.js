// What outlasts a page: the figure that a visitor chose, and the moment and camera that a link names.

/** Calls a method of the browser's storage of some kind; null where the browser keeps nothing. */
function kept(kind, method, ...given) {
  try {
    return globalThis[kind][method](...given);
  } catch {
    return null;
  }
}

/** Marks this tab as one that has made something, which a reload then brings back (ui/tabs/history.py). */
export const remember = () => kept("sessionStorage", "setItem", "pas-de-deux-made", "1");

export const FIGURES = ["both", "body", "skeleton"];
const FIGURE = "pas-de-deux-figure";

/** How people are drawn, one of FIGURES, as the visitor left it. */
export function figureAtFirst() {
  const figure = kept("localStorage", "getItem", FIGURE);
  return FIGURES.includes(figure) ? figure : FIGURES[0];
}

/** Keeps how people are drawn. */
export const keepFigure = (figure) => kept("localStorage", "setItem", FIGURE, figure);

let used = false; // the first motion that is opened is the address' own

/** Brings a player that has just loaded a motion to the moment and the view of the page's address, once. */
export function aim(player) {
  const asked = new URLSearchParams(window.location.search);
  if (used || !asked.has("run") || !asked.has("frame")) return;
  used = true;
  const number = (name) => {
    const value = parseFloat(asked.get(name));
    return Number.isFinite(value) ? value : undefined;
  };
  player.select(Math.round(number("sample") ?? 0));
  player.clock.pause();
  player.clock.seek(Math.round(number("frame") ?? 0));
  player.orbit.jump(player.framing.wanted().targets);
  player.orbit.goTo({ yaw: number("yaw"), elevation: number("elevation"), distance: number("distance") });
  player.orbit.framing = !asked.has("distance");
  player.framing.preset = null;
}
