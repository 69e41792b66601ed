// What the panels that use the camera have in common: they unfold, say a line, and one of them is busy at a time.

const panels = new Set();

export class Panel {
  /** `root` is the panel's element; each of `names` becomes a property with the part of that name. */
  constructor(root, names) {
    this.root = root;
    this.run = 0; // number of what is being done: a later one stops it
    for (const name of ["open", "body", "stage", "video", "drawing", "begin", "stop", "line", ...names])
      this[name] = root.querySelector(`.pdcam-${name}, .pdlive-${name}`);
    const { body } = this;
    this.open.onclick = () => {
      body.hidden = !body.hidden;
      this.open.setAttribute("aria-expanded", String(!body.hidden));
      if (body.hidden) this.rest();
    };
    root.closest(".pd-ask")?.addEventListener("click", ({ target }) => {
      if (!body.contains(target) && !this.busy) this.say(""); // something else is asked
    });
    panels.add(this);
    this.open.disabled = false; // before, nobody would hear
  }

  get busy() {
    return this.root.dataset.state !== "idle";
  }

  /** Stops all other panels. */
  takeTurn() {
    for (const other of panels) if (other !== this && other.busy) other.rest();
  }

  say(text, tone = "") {
    this.line.textContent = text;
    this.line.dataset.tone = tone;
  }
}
