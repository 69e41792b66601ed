// The things the player needs beside its modules, each loaded once a page and from our own server only.

import { decodeBody } from "./body.js";

const once = new Map();

function load(key, make) {
  if (!once.has(key)) {
    const pending = make();
    pending.catch(() => once.delete(key)); // so that a later mount may try again
    once.set(key, pending);
  }
  return once.get(key);
}

/** plotly.js with its 3D charts alone, see static/plotly. */
export function loadPlotly(url) {
  return load(url, () =>
    window.Plotly?.newPlot ? Promise.resolve(window.Plotly) : new Promise((resolve, reject) => {
      const script = document.createElement("script");
      script.src = url;
      script.onload = () => resolve(window.Plotly);
      script.onerror = () => reject(new Error("plotly.js did not load"));
      document.head.append(script);
    }),
  );
}

export function loadStyles(url) {
  return load(url, () =>
    new Promise((resolve, reject) => {
      const link = document.createElement("link");
      link.rel = "stylesheet";
      link.href = url;
      link.onload = resolve;
      link.onerror = () => reject(new Error("The player's styles did not load"));
      document.head.append(link);
    }),
  );
}

/** A body of static/bodies by the name of its file, as motion/looks.py has them, or a smaller one of each. */
export function loadBody(name) {
  const url = new URL(`../bodies/${name}.json`, import.meta.url).href;
  return load(url, async () => {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`The body ${name} did not load`);
    return decodeBody(await answer.json());
  });
}
