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
  /** `tab` is the part of the page around the prompt, with a slider that begins with `usual` seconds, or with none. */
  constructor(host, tab, usual) {
    this.host = host;
    this.tab = tab;
    this.usual = this.own = usual;
    this.chosen = false; // by hand, by an example or a link: any value that is not our own
    this.typed = null;
    this.needed = null;
    tab.addEventListener("input", ({ target, isTrusted }) => {
      if (target.closest("#seconds")) this.draw(this.needed);
      else if (isTrusted && target.matches(".pd-ask textarea")) this.typed = target.value;
    });
    host.addEventListener("click", (event) => event.target.closest("button") && this.set(this.seconds));
  }

  /** The slider's field, which Gradio may put into the page after the prompt. */
  get number() {
    return this.tab.querySelector("#seconds input[type=number]");
  }

  /** A run begins: a length that comes after it is only advised, so that the settings stay those of the run. */
  leave() {
    this.typed = null;
  }

  /** Shows what acts need that take so many seconds, null where nothing is known of them, or lengthens the motion. */
  draw(needed, text = null) {
    this.needed = needed;
    const { number } = this;
    if (!number) return;
    const most = Number(number.max);
    if (Number(number.value) !== this.own) this.chosen = true;
    if (needed && !this.chosen && text !== null && text === this.typed) {
      const seconds = Math.min(Math.max(needed, this.usual), most);
      if (seconds !== this.own) this.set(seconds);
    }
    const found = needed ? advice(needed, Number(number.value), most) : null;
    this.host.hidden = !found;
    if (!found) return;
    this.host.querySelector("span").textContent = found.text;
    const button = this.host.querySelector("button");
    button.hidden = found.seconds === null;
    button.textContent = say("reading.make_it", { seconds: found.seconds });
    this.seconds = found.seconds;
  }

  set(seconds) {
    const { number } = this;
    this.own = seconds;
    number.value = String(seconds);
    for (const kind of ["input", "change", "blur"]) number.dispatchEvent(new Event(kind, { bubbles: true }));
  }
}
