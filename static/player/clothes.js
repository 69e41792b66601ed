// What the people of a player wear: bodies that ship, lighter ones where people are many and small, or an
// uploaded character. They stay skeletons where no body can be had, or plotly is too slow for them.

import { coarser, decodeBody } from "./body.js";
import { loadBody } from "./loader.js";

const GHOST_VERTICES = 2000; // of an uploaded character on each ghost of a future; light bodies have a thousand

const light = () => Promise.all(["a-small", "b-small"].map(loadBody));

export class Clothes {
  constructor(player) {
    this.player = player;
    this.bodies = null; // those that ship, [A's, B's]
    this.character = null; // an uploaded one, whom both people may wear
  }

  /** Fetches the bodies that ship and puts them on. */
  async open() {
    if (this.player.scene.mode !== "fast") return;
    const small = matchMedia("(max-width: 700px)").matches;
    try {
      this.bodies = await Promise.all(["a", "b"].map((name) => loadBody(small ? `${name}-small` : name)));
    } catch (error) {
      console.error(error);
      return;
    }
    await this.change();
    this.player.wake();
  }

  /** What a new pane puts on: the uploaded character's body or those that ship; null while there is none. */
  get worn() {
    return this.player.show.character ? [this.character.body, this.character.body] : this.bodies;
  }

  /** Dresses all panes anew. */
  async change() {
    const { panes, scene, show } = this.player;
    if (scene?.mode !== "fast") return;
    if (this.worn) for (const pane of panes) pane.dress(this.worn);
    if (!show.character) await this.dressGrid();
    await this.dressFutures();
  }

  /** What the ghosts of futures wear, once it is there: lighter than people, and the character where they do. */
  async dressFutures() {
    const { futures, show } = this.player;
    if (!this.bodies || !futures.samples.length) return;
    const lightBodies = await light();
    futures.dress(show.character ? [this.character.pale, this.character.pale] : lightBodies);
  }

  /** Lighter bodies for people who are seen small, many at a time. */
  async dressGrid() {
    const { grid, panes, show } = this.player;
    if (!this.bodies || show.character) return;
    const several = () => grid.cells.length > 0;
    const bodies = several() ? await light() : this.bodies;
    if (several() === (bodies !== this.bodies)) panes[0].dress(bodies);
  }

  /** Puts an uploaded character on both people, as motion/character.py packs it, or takes it off for null. */
  wear(stored) {
    const body = stored && decodeBody(stored);
    this.character = stored && { id: stored.id, body, pale: coarser(body, GHOST_VERTICES) };
    const shown = stored && { bodies: true, skeletons: false };
    Object.assign(this.player.show, { character: Boolean(stored), ...shown });
    this.change();
    this.player.refresh();
  }

  /** Bodies, skeletons, both and, where there is one, the uploaded character: each in its turn. */
  next() {
    const { show } = this.player;
    const { bodies, skeletons, character } = show;
    if (character || (bodies && skeletons && this.character)) {
      Object.assign(show, { character: !character, bodies: true, skeletons: false });
      this.change();
    } else if (bodies && skeletons) show.skeletons = false;
    else if (bodies) Object.assign(show, { bodies: false, skeletons: true });
    else show.bodies = true;
  }
}
