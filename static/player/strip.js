// Under the scene: curves over time with a playhead, and the contacts as ticks that can be pressed.

import { node } from "./node.js";
import { say } from "../texts.js";

const TOO_MANY_TICKS = 60;

export class Strip {
  constructor(root, { onSeek }) {
    this.box = root.querySelector(".pdd-strip");
    this.canvas = root.querySelector(".pdd-curve");
    this.past = root.querySelector(".pdd-past");
    this.playhead = root.querySelector(".pdd-playhead");
    this.values = root.querySelector(".pdd-values");
    this.ticks = root.querySelector(".pdd-ticks");
    this.onSeek = onSeek;
    this.sample = null;
    const seek = (event) => {
      const box = this.canvas.getBoundingClientRect();
      const at = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
      if (this.sample) onSeek(Math.round(at * (this.sample.frames - 1)));
    };
    this.box.addEventListener("click", seek);
  }

  load(sample, colors) {
    this.sample = sample;
    this.colors = colors;
    this.box.hidden = !sample?.curves.length;
    this.readouts = [];
    this.values.replaceChildren();
    this.ticks.replaceChildren();
    if (!sample) return;
    sample.curves.forEach((curve, i) => {
      const name = node("dt", "", curve.label);
      name.style.setProperty("--key", colors[i % colors.length]);
      const value = node("dd");
      this.values.append(name, value);
      this.readouts.push(value);
    });
    const span = Math.max(sample.frames - 1, 1);
    const share = (frames) => `${(100 * Math.max(frames, 0)) / span}cqw`;
    sample.contacts.slice(0, TOO_MANY_TICKS).forEach((contact, i, { [i + 1]: next }) => {
      const tick = node("button", "pdd-tick");
      tick.dataset.kind = contact.kind;
      tick.style.setProperty("--from", share(contact.start));
      tick.style.setProperty("--length", share(contact.stop - 1 - contact.start));
      tick.style.setProperty("--room", share((next?.start ?? 1e6) - contact.start)); // until the next tick
      const text = say("player.contact", { label: contact.label, from: (contact.start / sample.fps).toFixed(1), to: (contact.stop / sample.fps).toFixed(1) });
      tick.title = text;
      tick.setAttribute("aria-label", text);
      tick.addEventListener("click", () => this.onSeek(contact.start));
      this.ticks.append(tick);
    });
    const given = sample.past_until;
    this.past.hidden = !given;
    if (given) this.past.style.width = `${(100 * Math.min(given, span)) / span}%`;
    this.paint();
  }

  /** Draws the curves; they share one scale from zero. */
  paint() {
    const { sample, canvas } = this;
    if (!sample || this.box.hidden || !canvas.clientWidth) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.clearRect(0, 0, width, height);
    const top = Math.max(...sample.curves.flatMap((c) => c.values), 1e-6) * 1.08;
    sample.curves.forEach((curve, i) => {
      const x = (frame) => (frame / Math.max(sample.frames - 1, 1)) * width;
      const y = (value) => height - 1.5 - (value / top) * (height - 4);
      const path = new Path2D();
      curve.values.forEach((value, frame) => (frame ? path.lineTo(x(frame), y(value)) : path.moveTo(x(0), y(value))));
      context.strokeStyle = this.colors[i % this.colors.length];
      context.lineWidth = i ? 1.5 : 2;
      context.lineJoin = "round";
      context.stroke(path);
      if (i === 0) {
        path.lineTo(x(curve.values.length - 1), height);
        path.lineTo(0, height);
        context.globalAlpha = 0.08;
        context.fillStyle = this.colors[0];
        context.fill(path);
        context.globalAlpha = 1;
      }
    });
  }

  show(frame) {
    if (!this.sample) return;
    const { curves } = this.sample;
    const at = Math.min(Math.round(frame), this.sample.frames - 1);
    // It is as wide as the strip: to move it by a transform costs no layout, and counts as no shift of one.
    this.playhead.style.transform = `translateX(${(100 * frame) / Math.max(this.sample.frames - 1, 1)}%)`;
    curves.forEach((curve, i) => {
      const text = `${curve.values[Math.min(at, curve.values.length - 1)].toFixed(2)} ${curve.unit}`;
      if (this.readouts[i].textContent !== text) this.readouts[i].textContent = text;
    });
  }
}
