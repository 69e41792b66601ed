// What the people of a player wear: the bodies that ship, as each motion says, and lighter ones where people are many
// and small. They stay skeletons where no body can be had.

import { UNSAID } from "./decode.js";
import { loadBody } from "./loader.js";
import { FIGURES, keepFigure } from "./remember.js";

const onPhone = () => matchMedia("(max-width: 700px)").matches;
const fileOf = (look, light) => (light ? `${look}-small` : look);

/** Fetches what people wear whose looks nobody has said. */
export function warmBodies() {
  for (const look of UNSAID) loadBody(fileOf(look, onPhone()));
}

export class Clothes {
  constructor(player) {
    this.player = player;
    this.bodies = new Map(); // those that ship and are here, by the names of their files
    this.phone = onPhone();
  }

  /** What somebody wears whose looks have this name; null while it is not here. */
  body(look) {
    return this.bodies.get(this.file(look)) ?? null;
  }

  file(look) {
    return fileOf(look, this.light);
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
    player.refresh();
  }

  /** Draws people so, or as comes next where no figure is named. */
  choose(figure) {
    const { show } = this.player;
    show.figure = figure ?? FIGURES[(FIGURES.indexOf(show.figure) + 1) % FIGURES.length];
    keepFigure(show.figure);
  }
}

/** The names of all looks in a decoded payload. */
function looksOf(data) {
  const samples = (data?.samples ?? []).flatMap((sample) => [sample, ...(sample.cells ?? [])]);
  return [...new Set(samples.flatMap((sample) => sample.looks))];
}
