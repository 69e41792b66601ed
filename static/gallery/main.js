// The drawer of examples: scenes.json as cards that move. webdemo/ui/components/gallery.py takes the one that is pressed.

import { play } from "../notebook/thumbnail.js";

/** Fills a copy of the template with a scene; its words are set as text. */
function card(item, scene, take) {
  const button = item.querySelector("button");
  button.append(scene.prompt);
  button.addEventListener("click", () => take(scene));
  play(item.querySelector("canvas"), scene.thumbnail);
  return item;
}

/** Lets a button open the drawer, whose scenes are fetched when it first opens. */
export function mount(element, props, watch, trigger) {
  const dialog = element.querySelector("dialog");
  const list = element.querySelector("ul");
  const failed = element.querySelector(".pdx-failed");
  const made = element.querySelector("template");
  const take = ({ prompt, seconds, seed }) => {
    dialog.close();
    props.value = { prompt, seconds, seed };
    trigger("input");
  };
  const fill = async () => {
    try {
      const { scenes } = await (await fetch(new URL("scenes.json", import.meta.url))).json();
      list.replaceChildren(...scenes.map((scene) => card(made.content.firstElementChild.cloneNode(true), scene, take)));
    } catch {
      failed.hidden = false;
    }
  };
  element.querySelector(".pdx-open").addEventListener("click", () => {
    dialog.showModal();
    failed.hidden = true;
    if (!list.children.length) fill();
  });
  element.querySelector(".pdx-close").addEventListener("click", () => dialog.close());
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
}
