// The buttons, sliders and words around the scene: what they say is brought to what is true, and what is pressed
// is handed to the player.

import { actionFor, attach, belongsToControl } from "./input.js";
import { node } from "./node.js";
import { say } from "../texts.js";

export class Controls {
  constructor(root) {
    this.root = root;
    this.find = (selector) => root.querySelector(selector);
  }

  /** Hands what is pressed, dragged and typed to the player, which outlives none of these listeners. */
  listen(player) {
    const { root } = this;
    root.addEventListener("click", (event) => {
      const button = event.target.closest("button");
      if (button?.dataset.act) player.act(button.dataset.act);
      else if (button?.dataset.camera) player.act("camera", button.dataset.camera);
      else if (!event.target.closest(".pdd-help")) this.toggleHelp(false);
    });
    root.addEventListener("keydown", (event) => {
      if (belongsToControl(event)) return;
      const asked = actionFor(event);
      if (!asked) return;
      event.preventDefault();
      event.stopPropagation();
      player.act(...asked);
    });
    this.find(".pdd-tabs").addEventListener("keydown", (event) => {
      if (!event.key.startsWith("Arrow")) return;
      player.act("sample", event.key === "ArrowLeft" || event.key === "ArrowUp" ? -1 : 1);
      this.find(".pdd-tabs [aria-selected=true]").focus();
      event.preventDefault();
    });
    this.find(".pdd-tabs").addEventListener("click", (event) => {
      const tab = event.target.closest("[role=tab]");
      if (tab) player.act("sample", [...tab.parentElement.children].indexOf(tab) - player.sampleIndex);
    });
    this.find(".pdd-figure").addEventListener("change", (event) => player.act("figure", event.target.value));
    this.find(".pdd-range").addEventListener("input", (event) => player.seek(Number(event.target.value)));
    this.find(".pdd-speed select").addEventListener("change", (event) => player.actions.setSpeed(Number(event.target.value)));
    attach(this.find(".pdd-touch"), player.orbit, {
      changed: () => player.turned(),
      mayScroll: (event) => event.ctrlKey || root.contains(document.activeElement) || document.fullscreenElement === root,
    });
    let pressed = null;
    this.find(".pdd-touch").addEventListener("pointerdown", (event) => {
      root.focus({ preventScroll: true });
      pressed = [event.clientX, event.clientY];
    });
    this.find(".pdd-touch").addEventListener("click", ({ clientX, clientY }) => {
      const moved = pressed && Math.hypot(clientX - pressed[0], clientY - pressed[1]);
      if (!(moved < 5)) return;
      const cell = player.grid.at(clientX, clientY);
      if (cell >= 0) player.enlarge(cell);
    });
  }

  /** A title and a tab a sample for a decoded payload. */
  load({ title, samples }) {
    const line = this.find(".pdd-title");
    line.textContent = line.title = title;
    line.hidden = !title;
    const tabs = this.find(".pdd-tabs");
    tabs.hidden = samples.length < 2;
    tabs.replaceChildren(
      ...samples.map((sample, i) => {
        const tab = node("button", "", sample.label || String(i + 1));
        tab.setAttribute("role", "tab");
        tab.setAttribute("aria-label", say("player.sample", { number: sample.label || i + 1 }));
        return tab;
      }),
    );
  }

  /** Marks a sample's tab, and says what happens in it and how long it is. */
  select(sample, index) {
    const told = this.find(".pdd-told");
    told.hidden = !sample.told;
    if (told.textContent !== (sample.told ?? "")) told.textContent = sample.told ?? "";
    this.find(".pdd-range").max = String(sample.frames - 1);
    [...this.find(".pdd-tabs").children].forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === index));
      tab.tabIndex = i === index ? 0 : -1;
    });
  }

  /** The overlay while something is being made; "" takes it away. `progress` is 0..1, or less for none. */
  setBusy(text, progress = null) {
    this.find(".pdd-busy").hidden = !text;
    this.root.setAttribute("aria-busy", String(Boolean(text)));
    this.find(".pdd-busy-text").textContent = text || "";
    const meter = this.find(".pdd-meter");
    meter.hidden = !(Number.isFinite(progress) && progress >= 0);
    meter.firstElementChild.style.width = `${100 * Math.min(Math.max(progress || 0, 0), 1)}%`;
  }

  /** What is said while there is no motion: a line, and what comes after a line break smaller. */
  setEmptyText(text) {
    const [line, ...more] = text.split("\n");
    this.find(".pdd-empty-text").textContent = line;
    this.find(".pdd-empty-more").textContent = more.join(" ");
  }

  toggleHelp(open = this.find(".pdd-help").hidden) {
    this.find(".pdd-help").hidden = !open;
    this.find("[data-act=help]").setAttribute("aria-expanded", String(open));
  }

  /** Brings everything to what is true of the player now. */
  show({ clock, directing, framing, orbit, sample, show }) {
    const { root } = this;
    const frame = clock.shown;
    const range = this.find(".pdd-range");
    const at = String(Math.round(frame));
    if (range.value !== at) range.value = at;
    range.style.setProperty("--done", `${(100 * frame) / Math.max(clock.frames - 1, 1)}%`);
    range.setAttribute("aria-valuetext", say("player.time_heard", { now: clock.seconds.toFixed(1), all: clock.duration.toFixed(1) }));
    this.find(".pdd-time").textContent = sample
      ? say("player.time", { now: (frame / clock.fps).toFixed(2), all: clock.duration.toFixed(2), frame: Math.round(frame) + 1, frames: clock.frames }) : "";
    root.dataset.playing = String(clock.playing);
    root.dataset.figure = show.figure;
    this.find(`.pdd-figure [value=${show.figure}]`).checked = true;
    this.find(".pdd-play").setAttribute("aria-label", say(clock.playing ? "player.pause" : "player.play"));
    const speed = this.find(".pdd-speed select");
    if (speed.value !== String(clock.speed)) speed.value = String(clock.speed);
    const press = (name, on) => this.find(`[data-act=${name}]`).setAttribute("aria-pressed", String(on));
    press("loop", clock.loop);
    press("follow", orbit.following);
    press("ghosts", show.ghosts);
    press("pose", Boolean(directing.posing));
    press("draw", directing.drawing.on);
    press("fullscreen", document.fullscreenElement === root || root.classList.contains("pdd-full"));
    for (const button of root.querySelectorAll("[data-camera]")) button.setAttribute("aria-pressed", String(button.dataset.camera === framing.preset));
    this.showPart(sample, frame);
  }

  /** The mark over the scene: a live motion, or which part of it was given. */
  showPart(sample, frame) {
    const chip = this.find(".pdd-chip");
    const given = sample?.past_until;
    chip.hidden = !given && !sample?.live;
    if (sample?.live) {
      chip.dataset.part = "live";
      chip.textContent = [say("player.live"), sample.live.text].filter(Boolean).join(" · ");
    } else if (given) {
      chip.dataset.part = frame < given ? "given" : "predicted";
      chip.textContent = say(frame < given ? "player.given" : "player.predicted");
    }
  }
}
