// Paths for the next run of the sentence, drawn on the stage beside it: they stand as chips under its plan. This is what
// directs the player, see ../player/directing.js.

import { chips } from "../player/paths/walks.js";
import { Past, path } from "../story/edits.js";

const SECONDS = 5; // where the page does not say how long the motion will be

export class Paths {
  /** `changed` is called when the paths are others, and `drawn` when a visitor has drawn one by hand. */
  constructor(root, changed, drawn) {
    this.root = root;
    this.list = root.parentElement.querySelector(".pdr-paths");
    this.changed = changed;
    this.drawn = drawn;
    this.past = new Past();
    this.given = { paths: [] };
    this.list.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
      event.preventDefault();
      this.undo();
    });
    this.leaving = new AbortController();
    document.addEventListener("pdd-here", () => this.meet(), { signal: this.leaving.signal });
    this.meet();
  }

  /** Directs the player of the same tab once it is there; a root that has left the page, or was never on it, does not. */
  meet() {
    if (!this.root.isConnected) return this.leaving.abort();
    this.root.closest(".pd-lab")?.querySelector(".pdd")?.player?.direct(this);
  }

  get player() {
    return this.root.closest(".pd-lab")?.querySelector(".pdd")?.player;
  }

  get paths() {
    return this.given.paths;
  }

  /** Seconds of the next run. */
  get seconds() {
    return Number(document.querySelector("#seconds input[type=number]")?.value) || SECONDS;
  }

  get mayUndo() {
    return this.past.before.length > 0;
  }

  keepPath(person, points) {
    this.past.keep(this.given);
    this.show(path(this.given, person, points));
  }

  undo() {
    this.show(this.past.undo(this.given));
  }

  /** The paths of a kept run. */
  open(paths) {
    this.past = new Past();
    this.show({ paths });
  }

  show(given) {
    this.given = given;
    this.draw();
    this.changed();
    this.player?.refresh();
  }

  draw() {
    chips(this.list, this.paths, (person) => {
      this.keepPath(person, []);
      (this.list.querySelector("button") ?? this.player?.root)?.focus({ preventScroll: true });
    });
  }
}
