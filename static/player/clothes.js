// What the people of a player wear: the bodies that ship, as each motion says, lighter ones where people are many and
// small, or an uploaded character. They stay skeletons where no body can be had.

import { coarser, decodeBody } from "./body.js";
import { loadBody } from "./loader.js";
import { keepFigure } from "./remember.js";

const FIGURES = ["both", "character", "body", "skeleton"];
const GHOST_VERTICES = 2000; // of an uploaded character on each ghost of a future; light bodies have a thousand

const light = (looks) => Promise.all(looks.map((look) => loadBody(`${look}-small`)));

export class Clothes {
  constructor(player) {
    this.player = player;
    this.bodies = new Map(); // those that ship and are here, by the names of their files
    this.character = null; // an uploaded one, whom both people may wear
    this.phone = matchMedia("(max-width: 700px)").matches;
  }

  /** What somebody wears whose looks have this name; null while it is not here. */
  body(look) {
    if (this.player.show.character) return this.character.body;
    return this.bodies.get(this.file(look)) ?? null;
  }

  file(look) {
    return this.light ? `${look}-small` : look;
  }

  /** Whether people are seen small: on a phone, or many at a time. */
  get light() {
    return this.phone || this.player.grid.cells.length > 0;
  }

  /** Fetches what the people of the present motions wear, and dresses everybody anew. */
  async change() {
    const { player } = this;
    if (!player.scene) return;
    const files = looksOf(player.data).map((look) => this.file(look));
    try {
      await Promise.all(files.map(async (name) => this.bodies.set(name, await loadBody(name))));
    } catch (error) {
      console.error(error);
    }
    player.pane.dress((look) => this.body(look));
    await this.dressFutures();
    player.wake();
  }

  /** What the ghosts of futures wear, once it is there: lighter than people, and the character where they do. */
  async dressFutures() {
    const { futures, show } = this.player;
    if (!this.bodies.size || !futures.samples.length) return;
    const lightBodies = await light(futures.samples[0].looks);
    futures.dress(show.character ? [this.character.pale, this.character.pale] : lightBodies);
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

  /** How people are drawn: "both", the uploaded "character", "body" or "skeleton". */
  get figure() {
    const { bodies, skeletons, character } = this.player.show;
    return character ? "character" : bodies ? (skeletons ? "both" : "body") : "skeleton";
  }

  /** Draws people so, or as comes next where no figure is named. */
  choose(figure) {
    const { show } = this.player;
    const known = FIGURES.filter((each) => each !== "character" || this.character);
    const next = figure ?? known[(known.indexOf(this.figure) + 1) % known.length];
    const changed = show.character !== (next === "character");
    Object.assign(show, { character: next === "character", bodies: next !== "skeleton", skeletons: next === "both" || next === "skeleton" });
    if (changed) this.change();
    if (!show.character) keepFigure(show);
  }
}

/** The names of all looks in a decoded payload. */
function looksOf(data) {
  const samples = (data?.samples ?? []).flatMap((sample) => [sample, ...(sample.cells ?? [])]);
  return [...new Set(samples.flatMap((sample) => sample.looks))];
}
