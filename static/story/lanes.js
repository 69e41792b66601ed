// The parts of the line that show and do nothing else than to be pressed: blocks of beats, pins of poses, the ruler.

import * as edits from "./edits.js";
import { node } from "../player/node.js";
import { say } from "../texts.js";

/** A beat in a lane; `stretch(event, index)` begins to change its length. */
export function block(beat, index, { lane, name, starts, total, selected, stretch }) {
  const box = node("div", "pds-block");
  box.style.left = `${(100 * starts[index]) / total}%`;
  box.style.width = `${(100 * edits.lengthOf(beat)) / total}%`;
  const words = beat[lane] ?? "";
  const cell = node("button", `pds-cell${words ? "" : " pds-none"}`, words || "+");
  cell.dataset.beat = index;
  cell.dataset.lane = lane;
  cell.dataset.key = `${lane} ${index}`;
  cell.title = words;
  cell.setAttribute("aria-label", say("story.cell", { number: index + 1, lane: name, words: words || say("story.no_words") }));
  if (selected) cell.classList.add("pds-selected");
  box.append(cell);
  if (lane === "words") {
    const handle = node("span", "pds-handle");
    handle.addEventListener("pointerdown", (event) => stretch(event, index));
    box.append(handle);
  }
  return box;
}

/** A pose of somebody as a pin at its moment; `index` is its number in the story. */
export function pin({ person, seconds }, index, total) {
  const made = node("button", "pds-pin");
  made.dataset.pose = index;
  made.dataset.key = `pin ${index}`;
  made.style.left = `${(100 * seconds) / total}%`;
  made.title = say("story.pin", { person: person.toUpperCase(), seconds: seconds.toFixed(2) });
  made.setAttribute("aria-label", say("story.pin_keys", { pin: made.title }));
  return made;
}

/** Seconds over the line. */
export function drawRuler(ruler, total) {
  ruler.replaceChildren();
  const wide = (ruler.clientWidth || 600) / total; // pixels a second
  const step = [1, 2, 5].find((seconds) => seconds * wide > 24) ?? 10;
  for (let second = 0; (total - second) * wide > 20; second += step) {
    const mark = node("span", "", String(second));
    mark.style.left = `${(100 * second) / total}%`;
    ruler.append(mark);
  }
}
