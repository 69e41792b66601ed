// What hands do on the stage: the mouse, fingers and keys.

const TURN = Math.PI; // radians for a drag as long as the stage is high

/**
 * Listens on `surface`. `orbit` is changed in place; `changed` is called after each change.
 * `mayScroll` says whether the wheel belongs to us.
 */
export function attach(surface, orbit, { changed, mayScroll }) {
  const pointers = new Map();
  let pinch = null;

  const at = ({ clientX, clientY }) => [clientX, clientY];
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { distance: Math.hypot(a[0] - b[0], a[1] - b[1]), x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
  };

  surface.addEventListener("pointerdown", (event) => {
    surface.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, at(event));
    pinch = pointers.size === 2 ? spread() : null;
  });

  surface.addEventListener("pointermove", (event) => {
    const now = at(event);
    const before = pointers.get(event.pointerId);
    if (!before) return;
    pointers.set(event.pointerId, now);
    const height = surface.clientHeight || 1;
    const [dx, dy] = [(now[0] - before[0]) / height, (now[1] - before[1]) / height];
    if (pointers.size === 2) {
      const next = spread();
      if (pinch?.distance > 0 && next.distance > 0) orbit.zoom(pinch.distance / next.distance);
      orbit.slide((next.x - pinch.x) / height, (pinch.y - next.y) / height);
      pinch = next;
    } else if (event.buttons & 6 || event.shiftKey) orbit.slide(dx, -dy);
    else orbit.turn(-TURN * dx, TURN * dy);
    changed();
  });

  const release = (event) => {
    pointers.delete(event.pointerId);
    pinch = pointers.size === 2 ? spread() : null;
  };
  surface.addEventListener("pointerup", release);
  surface.addEventListener("pointercancel", release);
  surface.addEventListener("contextmenu", (event) => event.preventDefault());
  surface.addEventListener(
    "wheel",
    (event) => {
      if (!mayScroll(event)) return;
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : 1;
      orbit.zoom(Math.exp((event.deltaY * lines) / 800));
      changed();
    },
    { passive: false },
  );
}

// What a key asks for: an action and its argument, steps are ten frames with Shift.
const KEYS = {
  ArrowLeft: ["step", -1], ArrowRight: ["step", 1], ArrowUp: ["faster", 1], ArrowDown: ["faster", -1],
  "[": ["sample", -1], "]": ["sample", 1], " ": ["play"], Home: ["first"], End: ["last"], Enter: ["fullscreen"],
  Escape: ["close"], "?": ["help"], f: ["follow"], g: ["ghosts"], l: ["loop"], p: ["picture"], s: ["figure"], e: ["pose"], d: ["draw"],
  1: ["camera", "threequarter"], 2: ["camera", "front"], 3: ["camera", "side"], 4: ["camera", "top"], 5: ["camera", "a"], 6: ["camera", "b"],
};

/** What a key asks for: [action, argument], or null for keys that are not ours. */
export function actionFor(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  const [action, argument] = KEYS[event.key] ?? KEYS[event.key.toLowerCase()] ?? [];
  return action ? [action, action === "step" && event.shiftKey ? 10 * argument : argument] : null;
}

/** Whether the focused control wants this key for itself. */
export function belongsToControl(event) {
  const { target, key } = event;
  if (target.matches("select, input:not([type=range]), textarea")) return true;
  if (target.matches("[role=tab]") && key.startsWith("Arrow")) return true;
  return target.matches("button") && (key === " " || key === "Enter");
}
