// What a visitor may change while somebody keeps it: `director` is such as a story or the reading of a prompt. Of these it
// has what it can keep:
//   posesAt(frame): each person's kept pose in world axes, or null; keepPoses(frame, [{ person: "a" or "b", positions }])
//   paths: [{ person, points }] of the next run; keepPath(person, points)

import { toScene } from "./decode.js";
import { Drawing } from "./paths/drawing.js";
import { Posing } from "./posing.js";

const TOOLS = { pose: "keepPoses", draw: "keepPath" };

export class Directing {
  constructor(player) {
    this.player = player;
    this.director = null;
    this.posing = null;
    this.drawing = new Drawing(player);
  }

  /** Lets a visitor change what `director` keeps. */
  direct(director) {
    const { player } = this;
    this.director = director;
    for (const [tool, needed] of Object.entries(TOOLS)) {
      for (const part of player.root.querySelectorAll(`[data-act=${tool}], [data-help=${tool}]`)) part.hidden = !director[needed];
    }
    if (player.data) player.refresh();
  }

  /** Whether one pair stands in the stage, whose motion is all there. */
  get alone() {
    const { player } = this;
    return Boolean(player.data) && !player.grid.cells.length && !player.sample.live;
  }

  /** Stops at the frame that is shown and lays handles over the people, or takes them away. */
  togglePosing() {
    if (this.posing) return this.endPosing();
    const { player } = this;
    if (!this.director?.keepPoses || !player.skeleton?.wears || !this.alone) return;
    this.drawing.toggle(false);
    const frame = Math.round(player.clock.shown);
    player.clock.pause();
    player.clock.seek(frame);
    this.posing = new Posing(player, this.posesAt(frame));
    player.refresh();
  }

  /** Begins to draw on the floor, or ends it. */
  toggleDrawing() {
    if (!this.director?.keepPath || !this.mayLeave()) return;
    this.drawing.toggle(this.alone && !this.drawing.on);
  }

  /** The poses that are kept at a frame: points [x, y, z] in scene axes, or null. */
  posesAt(frame) {
    return (this.director?.posesAt?.(frame) ?? []).map((points) => points && points.map((p) => toScene(...p)));
  }

  endPosing() {
    this.posing?.close();
    this.posing = null;
    if (this.player.data) this.player.refresh();
  }

  /** Ends all that was begun, as another motion comes. */
  end() {
    this.endPosing();
    this.drawing.toggle(false);
  }

  /** Whether another moment may be shown: not while a pose is neither kept nor given up. */
  mayLeave() {
    if (this.posing?.changed.some(Boolean)) this.posing.remind();
    else if (this.posing) this.endPosing();
    return !this.posing;
  }
}
