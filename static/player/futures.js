// Several continuations from a moment: the samples of such a payload share what came before it. From then on the one
// that is chosen stands there as ever, and the others as ghosts in tints of their own. Its number over it or the
// number's key takes one, and the player's director hears of it.

import { Figure } from "./body.js";
import { poseAt } from "./decode.js";
import { FIELD_OF_VIEW } from "./orbit.js";
import { project } from "./overlay.js";
import { FUTURES, css, mix } from "./palette.js";
import { say } from "../texts.js";

const ALPHA = 0.34;
const TINTED = 0.72; // of a ghost's colours
const OVER = [0.2, 80]; // metres and pixels from heads to numbers: names lie between
const APART = 34; // pixels between numbers at least

export class Futures {
  constructor(player) {
    this.player = player;
    this.host = player.find(".pdd-futures");
    this.samples = [];
    this.ghosts = [];
    this.host.addEventListener("click", (event) => {
      const number = event.target.closest("[data-future]");
      if (number) this.take(Number(number.dataset.future));
    });
  }

  /** Takes over the samples of a decoded payload, where they are futures. */
  load(data) {
    const open = data?.futures != null && data.samples.length > 1;
    this.samples = open ? data.samples : [];
    this.from = open ? data.futures : null;
    this.host.hidden = true;
    this.host.replaceChildren(...this.samples.map((_, i) => {
      const number = document.createElement("button");
      number.type = "button";
      number.textContent = String(i + 1);
      number.dataset.future = i;
      number.title = say("player.take_title", { number: i + 1 });
      number.setAttribute("aria-label", say("player.take", { number: i + 1 }));
      number.style.background = css(FUTURES[i % FUTURES.length]);
      return number;
    }));
  }

  /** Bodies for ghosts, A's and B's. */
  dress(bodies) {
    this.ghosts = this.samples.map(() => bodies.map((body) => new Figure(body)));
    this.player.refresh();
  }

  /** Ghosts at a frame: [{ index, people }], and none before the moment. */
  at(frame) {
    if (!this.samples.length || frame < this.from || this.player.posing) return [];
    return this.samples.flatMap((sample, index) => (
      index === this.player.sampleIndex ? [] : [{ index, people: poseAt(sample.motion, frame) }]
    ));
  }

  /** One mesh of all ghosts for a scene: what setTriangles() takes, or null where they have no bodies. */
  mesh(found, theme, lens, scale) {
    if (!found.length || !this.ghosts.length) return null;
    const parts = found.flatMap(({ index, people }) => people.map((points, person) => {
      const ghost = this.ghosts[index][person];
      ghost.pose(points);
      ghost.shade(tinted(theme.bodies[person], index), theme.lamps, lens, scale, ALPHA);
      return ghost;
    }));
    return { positions: joined(parts.map((p) => p.positions)), colors: joined(parts.map((p) => p.colors)), alpha: ALPHA };
  }

  /** Puts the numbers over the heads of their pairs. */
  place(frame, matrix) {
    const { player, samples } = this;
    this.host.hidden = !samples.length || frame < this.from || Boolean(player.posing);
    if (this.host.hidden) return;
    const { clientWidth: width, clientHeight: height } = player.pane.host;
    const { head } = player.skeleton;
    const wanted = samples.map((sample, index) => {
      const people = poseAt(sample.motion, frame);
      const middle = [0, 1, 2].map((i) => people.reduce((sum, points) => sum + points[head][i], 0) / people.length);
      return { index, at: project([middle[0], middle[1], middle[2] + OVER[0]], matrix, width, height, FIELD_OF_VIEW) };
    });
    let right = -Infinity;
    const inOrder = [...wanted].sort((p, q) => p.at[0] - q.at[0]);
    const crowd = inOrder.map(({ at }) => (right = Math.max(at[0], right + APART)));
    const middleOf = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;
    const back = middleOf(crowd) - middleOf(inOrder.map(({ at }) => at[0]));
    inOrder.forEach(({ index, at }, i) => {
      const x = Math.min(Math.max(crowd[i] - back, 18), width - 18);
      const number = this.host.children[index];
      number.style.transform = `translate(${x.toFixed(1)}px, ${Math.max(at[1] - OVER[1], 18).toFixed(1)}px) translate(-50%, -50%)`;
      number.setAttribute("aria-pressed", String(index === player.sampleIndex));
    });
  }

  /** What a key asks for: 1, 2, … take a future while there are some. */
  actionFor(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || this.player.posing) return null;
    const index = Number(event.key) - 1;
    return index in this.samples && event.key !== " " ? ["take", index] : null;
  }

  take(index) {
    const { player } = this;
    if (!(index in this.samples)) return;
    player.select(index);
    player.director?.takeFuture?.(index);
  }
}

const tinted = (zones, index) => Object.fromEntries(
  Object.entries(zones).map(([zone, color]) => [zone, mix(color, FUTURES[index % FUTURES.length], TINTED)]),
);

function joined(arrays) {
  const out = new Float32Array(arrays.reduce((sum, a) => sum + a.length, 0));
  let at = 0;
  for (const array of arrays) {
    out.set(array, at);
    at += array.length;
  }
  return out;
}
