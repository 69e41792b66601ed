// Keyboard keys of the player. They act only while the focus is inside it.

const CAMERAS = ["threequarter", "front", "side", "top", "a", "b"];

/** What a key asks for: [action, argument], or null for keys that are not ours. */
export function actionFor(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  const step = event.shiftKey ? 10 : 1;
  switch (event.key) {
    case " ": return ["play"];
    case "ArrowLeft": return ["step", -step];
    case "ArrowRight": return ["step", step];
    case "ArrowUp": return ["faster", 1];
    case "ArrowDown": return ["faster", -1];
    case "Home": return ["first"];
    case "End": return ["last"];
    case "Enter": return ["fullscreen"];
    case "Escape": return ["close"];
    case "?": return ["help"];
    case "[": return ["sample", -1];
    case "]": return ["sample", 1];
  }
  const letters = { f: "follow", t: "trails", g: "ghosts", l: "loop", p: "picture", s: "figure", e: "pose", d: "draw", h: "touch", c: "film" };
  const action = letters[event.key.toLowerCase()];
  if (action) return [action];
  const camera = CAMERAS[Number(event.key) - 1];
  return camera ? ["camera", camera] : null;
}

/** Whether the focused control wants this key for itself. */
export function belongsToControl(event) {
  const { target, key } = event;
  if (target.matches("select, input:not([type=range]), textarea")) return true;
  if (target.matches("button")) return key === " " || key === "Enter";
  if (target.matches("[role=tab]")) return key.startsWith("Arrow");
  return false;
}
