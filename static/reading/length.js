// The length of the motion beside what its acts take: a line and a button where they need more.

import { say } from "../texts.js";

/** The line for acts that take `needed` seconds in a motion of `seconds`, at most `most`: { text, seconds }, or null. */
export function advice(needed, seconds, most) {
  const length = Math.min(needed, most);
  if (!(length > seconds)) return null;
  const longer = needed > most ? ` ${say("reading.scene")}` : "";
  return { text: say("reading.takes", { needed, seconds }) + longer, seconds: length };
}

export class Length {
  /** `field` is the page's slider of seconds, if the prompt has one. */
  constructor(host, field) {
    this.host = host;
    this.number = field?.querySelector("input[type=number]") ?? null;
    this.most = Number(field?.querySelector("input[type=range]")?.max ?? 0);
    this.needed = null;
    field?.addEventListener("input", () => this.draw(this.needed));
    host.addEventListener("click", (event) => event.target.closest("button") && this.take());
  }

  /** Shows what acts need that take so many seconds; null where nothing is known of them. */
  draw(needed) {
    this.needed = needed;
    const found = this.number && needed ? advice(needed, Number(this.number.value), this.most) : null;
    this.host.hidden = !found;
    if (!found) return;
    this.host.querySelector("span").textContent = found.text;
    this.host.querySelector("button").textContent = say("reading.make_it", { seconds: found.seconds });
    this.seconds = found.seconds;
  }

  take() {
    this.number.value = String(this.seconds);
    for (const kind of ["input", "change", "blur"]) this.number.dispatchEvent(new Event(kind, { bubbles: true }));
  }
}
