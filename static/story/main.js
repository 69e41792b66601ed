// Mounts the editor of a story in its component.

import { Editor } from "./editor.js";

/** `element` holds story.html; `props` are the component's, watched by `watch`; `trigger` tells the server. */
export function mount(element, props, watch, trigger) {
  const root = element.querySelector(".pds");
  const editor = new Editor(root, props, (story) => (props.value = story), () => trigger("input"));
  const sync = () => {
    editor.load(props.value);
    editor.lay(props.laid);
    editor.measure(props.lengths);
    editor.draw();
  };
  watch(["value", "laid", "lengths"], sync);
  sync();
  root.editor = editor;
}
