// What is known of the lens of the webcam and of a film's camera, kept by the browser from visit to visit.

const USUAL = 70; // degrees from corner to corner
const [NARROWEST, WIDEST] = [40, 130]; // as in motion/video/people.py
const key = (source) => `pasdedeux-lens-${source}`;

/** The lens of a source, "webcam" or "video", in degrees: what was set last, or the usual one. */
export function lensOf(source) {
  let kept = NaN;
  try {
    kept = Number.parseFloat(localStorage.getItem(key(source)));
  } catch {
    // a browser that keeps nothing
  }
  return kept >= NARROWEST && kept <= WIDEST ? kept : USUAL;
}

/** Keeps an input's value for a source; one that no lens has is put right first. */
export function keepLens(input, source) {
  const value = Number.parseFloat(input.value);
  input.value = Number.isFinite(value) ? Math.min(WIDEST, Math.max(NARROWEST, value)) : USUAL;
  try {
    localStorage.setItem(key(source), input.value);
  } catch {
    // a browser that keeps nothing
  }
}
