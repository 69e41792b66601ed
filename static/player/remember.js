// What a browser tab keeps for a reload, and a browser for the next visit.

/** Marks this tab as one that has made something, which a reload then brings back (ui/tabs/history.py). */
export function remember() {
  try {
    sessionStorage.setItem("pas-de-deux-made", "1");
  } catch {
    // a browser may keep nothing; a reload then begins anew
  }
}

const FIGURE = "pas-de-deux-figure";

/** How people are drawn, as the visitor left it: { bodies, skeletons }, both at first. */
export function figureAtFirst() {
  try {
    const kept = localStorage.getItem(FIGURE);
    return { bodies: kept !== "skeleton", skeletons: kept !== "body" };
  } catch {
    return { bodies: true, skeletons: true };
  }
}

/** Keeps how people are drawn. */
export function keepFigure({ bodies, skeletons }) {
  try {
    localStorage.setItem(FIGURE, bodies ? (skeletons ? "both" : "body") : "skeleton");
  } catch {
    // a browser may keep nothing
  }
}
