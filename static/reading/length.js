// The length of the motion beside what its acts take: it follows a sentence that is typed until somebody sets it, and
// a line and a button say where acts need more.

import { say } from "../texts.js";

/**
 * The line for acts that take `needed` seconds in a motion of `seconds`, at most `most`: { text, seconds }, or null where
 * they fit; `seconds` is null where the motion can be no longer.
 */
export function advice(needed, seconds, most) {
  if (!(needed > seconds)) return null;
  const longer = needed > most ? ` ${say("reading.scene")}` : "";
  const text = say("reading.takes", { needed, seconds }) + longer;
  return { text, seconds: seconds < most ? Math.min(needed, most) : null };
}

export class Length {
  /** `field` is the page's slider of seconds, if the prompt has one, and `prompt` its field of text. */
  constructor(host, field, prompt) {
    this.host = host;
    this.number = field?.querySelector("input[type=number]") ?? null;
    this.most = Number(field?.querySelector("input[type=range]")?.max ?? 0);
    this.usual = this.own = Number(this.number?.value);
    this.chosen = false; // by hand, by an example or a link: any value that is not our own
    this.typed = null;
    this.needed = null;
    prompt?.addEventListener("input", (event) => event.isTrusted && (this.typed = event.target.value));
    field?.addEventListener("input", () => this.draw(this.needed));
    host.addEventListener("click", (event) => event.target.closest("button") && this.set(this.seconds));
  }

  /** A run begins: a length that comes after it is only advised, so that the settings stay those of the run. */
  leave() {
    this.typed = null;
  }

  /** Shows what acts need that take so many seconds, null where nothing is known of them, or lengthens the motion. */
  draw(needed, text = null) {
    this.needed = needed;
    if (this.number && Number(this.number.value) !== this.own) this.chosen = true;
    if (this.number && needed && !this.chosen && text !== null && text === this.typed) {
      const seconds = Math.min(Math.max(needed, this.usual), this.most);
      if (seconds !== this.own) this.set(seconds);
    }
    const found = this.number && needed ? advice(needed, Number(this.number.value), this.most) : null;
    this.host.hidden = !found;
    if (!found) return;
    this.host.querySelector("span").textContent = found.text;
    const button = this.host.querySelector("button");
    button.hidden = found.seconds === null;
    button.textContent = say("reading.make_it", { seconds: found.seconds });
    this.seconds = found.seconds;
  }

  set(seconds) {
    this.own = seconds;
    this.number.value = String(seconds);
    for (const kind of ["input", "change", "blur"]) this.number.dispatchEvent(new Event(kind, { bubbles: true }));
  }
}
