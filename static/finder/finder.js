// What the page's search finds: acts, controls, tabs and runs. Pure, so that Node tests it.

import { say, unmarked } from "../texts.js";

const MOST = 40; // entries that are listed
const KINDS = new Set(["button", "downloadbutton", "slider", "textbox", "number", "dropdown", "checkbox", "radio", "file", "accordion"]);

const plain = (text) => text.normalize("NFD").replace(/\p{Mn}/gu, "").toLowerCase();
const clean = (text) => text.replace(/[▼◀]/g, "").trim();

/** Tabs and controls of the page from Gradio's configuration: { kind, name, more, tab, folds, target } each. */
export function placesOf({ components, layout }) {
  const byId = new Map(components.map((component) => [component.id, component]));
  const found = [];
  const walk = (node, tab, folds) => {
    const { type, props = {} } = byId.get(node.id) ?? {};
    if (props.visible === false) return;
    if (type === "tabitem") {
      [tab, folds] = [unmarked(props.label), []];
      found.push({ kind: say("finder.tab"), name: tab, more: "", tab, folds, target: null });
    }
    const label = unmarked(props.label || (typeof props.value === "string" && /button$/.test(type) ? props.value : ""));
    if (tab && props.elem_id && KINDS.has(type) && label) {
      found.push({ kind: say("finder.control"), name: clean(label), more: tab, tab, folds, target: props.elem_id });
    }
    const inside = type === "accordion" && props.elem_id ? [...folds, props.elem_id] : folds;
    for (const child of node.children ?? []) walk(child, tab, inside);
  };
  walk(layout, null, []);
  return found;
}

/** The entries that have all words of `asked` in their names or what is said of them, the likeliest first. */
export function search(entries, asked) {
  const words = plain(asked).split(/\s+/).filter(Boolean);
  const scored = entries.flatMap((entry) => {
    const [name, more] = [plain(entry.name), plain(`${entry.kind} ${entry.more}`)];
    const scores = words.map((word) => {
      if (name.startsWith(word)) return 0;
      if (name.includes(` ${word}`)) return 1;
      if (name.includes(word)) return 2;
      return more.includes(word) ? 3 : Infinity;
    });
    const score = scores.reduce((sum, value) => sum + value, 0);
    return Number.isFinite(score) ? [{ entry, score }] : [];
  });
  return scored.sort((p, q) => p.score - q.score).slice(0, MOST).map(({ entry }) => entry);
}
