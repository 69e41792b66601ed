// What is said of the joint under the pointer.

import { Tip } from "./overlay.js";
import { say } from "../texts.js";

export class Hover {
  constructor(player) {
    this.player = player;
    this.tip = new Tip(player.find(".pdd-tip"));
    this.pointer = null;
  }

  /** Where the pointer is over the scene, [x, y], or null. */
  at(pointer) {
    this.pointer = pointer;
    this.show();
  }

  show() {
    const { player, pointer } = this;
    if (!pointer || !player.data || player.posing) return this.tip.hide();
    const shifted = ({ host, spots }) => spots.map((points) => points.map(([x, y, depth]) => [x + host.offsetLeft, y, depth]));
    this.tip.show(pointer, player.shown.flatMap(shifted), (person, joint) => {
      const { clock, data } = player;
      const [now, soon] = [clock.shown, Math.min(clock.shown + 1, clock.frames - 1)].map((f) => player.everybody(f)[person][joint]);
      const speed = Math.hypot(...now.map((v, i) => soon[i] - v)) * clock.fps;
      return say("player.joint", {
        person: "AB"[person % 2], joint: data.names[joint].replaceAll("_", " "), height: now[2].toFixed(2), speed: speed.toFixed(1),
      });
    });
  }
}
