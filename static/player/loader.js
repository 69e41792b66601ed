// The things the player needs beside its modules, each loaded once a page and from our own server only.

import { decodeBody } from "./body.js";

const kept = new Map();

function once(key, make) {
  if (!kept.has(key)) {
    const pending = make();
    pending.catch(() => kept.delete(key)); // so that a later mount may try again
    kept.set(key, pending);
  }
  return kept.get(key);
}

/** Puts an element into the page's head; resolves once it has loaded. */
function append(tag, attributes) {
  return new Promise((onload, reject) => {
    const onerror = () => reject(new Error(`${Object.values(attributes).at(-1)} did not load`));
    document.head.append(Object.assign(document.createElement(tag), attributes, { onload, onerror }));
  });
}

/** plotly.js with its 3D charts alone, see static/plotly. */
export const loadPlotly = () => once("plotly", async () => {
  const src = new URL("../plotly/plotly-gl3d.min.js", import.meta.url).href;
  if (!window.Plotly?.newPlot) await append("script", { src });
  return window.Plotly;
});

export const loadStyles = (href) => once(href, () => append("link", { rel: "stylesheet", href }));

/** A body of static/bodies by the name of its file, as motion/looks.py has them, or a smaller one of each. */
export function loadBody(name) {
  const url = new URL(`../bodies/${name}.json`, import.meta.url).href;
  return once(url, async () => {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`The body ${name} did not load`);
    return decodeBody(await answer.json());
  });
}
