// Up to nine motions from one side and on one clock, all drawn by the one scene of the player's first view.
//
// Browsers allow about sixteen WebGL contexts, so a cell has none: the scene, as large as a cell and out of sight, draws
// each cell in its turn, and the picture is copied into the cell's own canvas.

import { poseAt } from "./decode.js";
import { node } from "./node.js";

/** One motion of a grid; the player paints it as it paints a pane. */
class Cell {
  constructor(sample, pane) {
    this.sample = sample;
    this.pane = pane;
    this.spots = [];
    this.host = node("div", "pdd-cell");
    this.canvas = node("canvas");
    this.scene = { setStill: (...given) => pane.scene.setStill(...given), picture: async () => this.canvas };
    this.host.title = sample.caption;
    this.host.append(this.canvas);
  }

  poseAt(frame) {
    return poseAt(this.sample.motion, frame);
  }

  paint(pose, context) {
    const { pane } = this;
    pane.sample = this.sample;
    pane.paint(pose, context);
    const drawn = pane.find("canvas");
    if (!drawn?.width) return;
    if (this.canvas.width !== drawn.width || this.canvas.height !== drawn.height) {
      [this.canvas.width, this.canvas.height] = [drawn.width, drawn.height];
    }
    this.canvas.getContext("2d").drawImage(drawn, 0, 0);
  }
}

export class Grid {
  /** `host` holds the cells; `pane` draws them. */
  constructor(host, pane) {
    this.host = host;
    this.pane = pane;
    this.cells = [];
  }

  /**
   * Lays out a sample's cells with the names of its columns above and of its rows beside them; none for null.
   * Says whether the scene needs another size.
   */
  load(sample) {
    const before = this.cells.length;
    this.cells = (sample?.cells ?? []).map((cell) => new Cell(cell, this.pane));
    this.host.hidden = !this.cells.length;
    this.pane.host.classList.toggle("pdd-behind", !this.host.hidden);
    this.host.replaceChildren();
    if (this.host.hidden) {
      Object.assign(this.pane.host.style, { flex: "", width: "", height: "" });
      return before > 0;
    }
    const { columns, rows } = sample;
    if (!columns.some(Boolean)) for (const cell of this.cells) cell.host.append(node("div", "pdd-cell-text", cell.sample.caption));
    this.host.style.gridTemplateColumns = `${rows.some(Boolean) ? "auto" : "0"} repeat(${columns.length}, minmax(0, 1fr))`;
    this.host.style.gridTemplateRows = `${columns.some(Boolean) ? "auto" : "0"} repeat(${rows.length}, minmax(0, 1fr))`;
    this.host.append(node("div"), ...columns.map((name) => node("div", "pdd-head", name)));
    rows.forEach((name, row) => {
      const line = this.cells.slice(row * columns.length, (row + 1) * columns.length);
      this.host.append(node("div", "pdd-head pdd-side", name), ...line.map((cell) => cell.host));
    });
    return true;
  }

  /** Makes the scene as large as a cell. */
  fit() {
    if (!this.cells.length) return;
    const { clientWidth, clientHeight } = this.cells[0].host;
    Object.assign(this.pane.host.style, { flex: "none", width: `${clientWidth}px`, height: `${clientHeight}px` });
  }

  /** The number of the cell at a point of the window, or -1. */
  at(x, y) {
    return this.cells.findIndex(({ host }) => {
      const box = host.getBoundingClientRect();
      return x >= box.left && x < box.right && y >= box.top && y < box.bottom;
    });
  }
}
