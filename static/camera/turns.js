// The panels of a page that use the camera and its detectors: one at a time.

const panels = new Set();

/** Makes a panel one of those that take turns; it has a method `rest()`. */
export function takesTurns(panel) {
  panels.add(panel);
}

/** Stops all other panels. */
export function takeTurn(panel) {
  for (const other of panels) if (other !== panel && other.busy) other.rest();
}
