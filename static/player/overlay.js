// Words over the picture: names above heads.

import { node } from "./node.js";
import { say } from "../texts.js";

const LABEL_PX = 25; // height of a label with room
const SPACE_PX = 8;

/** Scene point to CSS pixels in the stage: [x, y, depth in metres]. */
export function project(point, matrix, width, height, fieldOfView) {
  const [x, y, z] = point;
  const at = (row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row];
  const depth = -at(2);
  const scale = height / 2 / Math.tan(fieldOfView / 2) / Math.max(depth, 1e-3);
  return [width / 2 + scale * at(0), height / 2 - scale * at(1), depth];
}

/** Puts an element with its middle, or its foot, at a place that project() gave; the nearer of two lies on top. */
export function put(element, [x, y, depth], foot = false) {
  element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, ${foot ? -100 : -50}%)`;
  element.style.zIndex = String(1000 - Math.round(10 * Math.min(depth, 99)));
  element.style.visibility = depth > 0.1 ? "" : "hidden"; // "visible" would show it where all are hidden
}

const ROLES = { given: "player.given", generated: "player.generated", "acts first": "player.acts_first", answers: "player.answers" };

/** "A · actor", or "A" alone where the role says no more. */
function roleText(person, role) {
  const letter = "AB"[person];
  if (!role || role.toLowerCase() === letter.toLowerCase()) return letter;
  return `${letter} · ${role in ROLES ? say(ROLES[role]) : role}`;
}

export class Labels {
  constructor(host) {
    this.host = host;
    this.labels = [];
  }

  load(roles) {
    this.host.replaceChildren();
    this.widths = null; // measured when first placed
    this.labels = roles.map((role, person) => {
      const label = node("span", `pdd-label pdd-label-${"ab"[person]}`, roleText(person, role));
      label.style.visibility = "hidden"; // it has no place yet
      this.host.append(label);
      return label;
    });
  }

  /** Puts each label over its spot; `spots` are project() results. The nearer one lies on top and low. */
  place(spots) {
    this.widths ??= this.labels.map((label) => label.offsetWidth);
    const lifted = spots.map(([x, y]) => [x, y]);
    if (spots.length === 2) {
      const [near, far] = spots[0][2] < spots[1][2] ? [0, 1] : [1, 0];
      const gap = Math.abs(spots[0][0] - spots[1][0]) - (this.widths[0] + this.widths[1]) / 2 - SPACE_PX;
      const overlap = LABEL_PX - (lifted[near][1] - lifted[far][1]);
      // The lift sets in gradually while two labels come close, so that none of them jumps.
      if (overlap > 0 && overlap < 2 * LABEL_PX) lifted[far][1] -= overlap * Math.min(Math.max(-gap / SPACE_PX, 0), 1);
    }
    this.labels.forEach((label, i) => {
      const half = this.widths[i] / 2;
      const x = Math.min(Math.max(lifted[i][0], half), Math.max(this.host.clientWidth - half, half));
      const y = Math.max(lifted[i][1], LABEL_PX); // never above the stage, as over a shoulder
      put(label, [x, y, spots[i][2]], true);
    });
  }
}
