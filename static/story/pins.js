// Poses as pins on the time line, in the lane of their person: a click goes to the frame, a drag moves the pose in time,
// Delete takes it away.

import * as edits from "./edits.js";
import { say } from "../texts.js";

const FPS = 30;
const SLACK = 3; // pixels that a press may move and still be a click

export class Pins {
  constructor(editor) {
    this.editor = editor;
    this.held = null;
  }

  /** The pins of a lane's person. */
  of(person, total) {
    return this.editor.story.poses.flatMap((pose, index) => (pose.person === person ? [this.pin(pose, index, total)] : []));
  }

  pin({ person, seconds }, index, total) {
    const pin = document.createElement("button");
    pin.type = "button";
    pin.className = "pds-pin";
    pin.dataset.pose = index;
    pin.dataset.key = `pin ${index}`;
    pin.style.left = `${(100 * seconds) / total}%`;
    pin.title = say("story.pin", { person: person.toUpperCase(), seconds: seconds.toFixed(2) });
    pin.setAttribute("aria-label", say("story.pin_keys", { pin: pin.title }));
    pin.addEventListener("pointerdown", (event) => this.begin(event, pin, index));
    pin.addEventListener("click", (event) => {
      if (event.detail === 0) this.goTo(index); // Enter or Space; begin() knows the pointer's clicks from its drags
    });
    return pin;
  }

  goTo(index) {
    this.editor.player?.act("pause");
    this.editor.player?.seek(edits.frameOf(this.editor.story.poses[index].seconds));
  }

  begin(event, pin, index) {
    if (event.button || this.held) return;
    event.preventDefault();
    event.stopPropagation();
    pin.focus({ preventScroll: true });
    pin.setPointerCapture(event.pointerId);
    const { story, total } = this.editor;
    const frames = (FPS * total) / this.editor.find(".pds-lanes").clientWidth; // a pixel
    const before = edits.frameOf(story.poses[index].seconds);
    const last = Math.ceil(FPS * total) - 1;
    let frame = before;
    const listening = new AbortController();
    const { signal } = listening;
    const end = (keep) => {
      listening.abort();
      this.held = null;
      if (keep && frame !== before) this.editor.edit(edits.movePose(story, index, frame));
      else this.editor.draw();
      this.editor.focusPin(story.poses[index].person, keep ? frame : before);
    };
    this.held = { end };
    pin.addEventListener("pointermove", (moved) => {
      const by = moved.clientX - event.clientX;
      if (Math.abs(by) < SLACK && frame === before) return;
      frame = Math.min(Math.max(before + Math.round(by * frames), 0), last);
      pin.style.left = `${(100 * frame) / FPS / total}%`;
      this.editor.find(".pds-hint").textContent = say("story.pin_at", { person: story.poses[index].person.toUpperCase(), seconds: (frame / FPS).toFixed(2) });
    }, { signal });
    pin.addEventListener("pointerup", () => {
      const still = frame === before;
      end(true);
      if (still) this.goTo(index);
    }, { signal });
    pin.addEventListener("pointercancel", () => end(false), { signal });
    window.addEventListener("keydown", (pressed) => {
      if (pressed.key !== "Escape") return;
      pressed.preventDefault();
      pressed.stopPropagation();
      end(false);
    }, { signal, capture: true });
  }

  /** Whether a key on a pin was for it. */
  key(event) {
    const pin = event.target.closest?.(".pds-pin");
    if (!pin || this.held) return false;
    const index = Number(pin.dataset.pose);
    const { story } = this.editor;
    const { person, seconds } = story.poses[index];
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === "Delete" || event.key === "Backspace") this.editor.edit(edits.removePose(story, index));
    else if (by) {
      const frame = Math.max(edits.frameOf(seconds) + by * (event.shiftKey ? 10 : 1), 0);
      this.editor.edit(edits.movePose(story, index, frame));
      this.editor.focusPin(person, frame);
    } else return false;
    return true;
  }
}
