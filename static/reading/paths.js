// Paths for the next run of the sentence, drawn on the stage beside it: they stand as chips under its plan. This is what
// directs the player, see ../player/directing.js.

import { chips } from "../player/paths/walks.js";
import { path } from "../story/edits.js";

export class Paths {
  /** `changed` is called when the paths are others, and `again` when a visitor has drawn one or taken one away. */
  constructor(root, changed, again) {
    this.root = root;
    this.list = root.parentElement.querySelector(".pdr-paths");
    this.changed = changed;
    this.again = again;
    this.paths = [];
    this.leaving = new AbortController();
    document.addEventListener("pdd-here", () => this.meet(), { signal: this.leaving.signal });
    this.meet();
  }

  /** Directs the player of the same tab once it is there; a root that has left the page, or was never on it, does not. */
  meet() {
    if (!this.root.isConnected) return this.leaving.abort();
    this.player?.directing.direct(this);
  }

  get player() {
    return this.root.closest(".pd-lab")?.querySelector(".pdd")?.player;
  }

  keepPath(person, points) {
    this.open(path({ paths: this.paths }, person, points).paths);
    this.again();
  }

  /** Shows other paths, such as those of a kept run. */
  open(paths) {
    this.paths = paths;
    chips(this.list, paths, (person) => {
      this.keepPath(person, []);
      (this.list.querySelector("button") ?? this.player?.root)?.focus({ preventScroll: true });
    });
    this.changed();
    this.player?.refresh();
  }
}
