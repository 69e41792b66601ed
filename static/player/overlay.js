// HTML over the scene: names above heads and the tip that tells about a joint. Text only, never markup.

const REACH_PX = 16;

/** Scene point to CSS pixels in the stage: [x, y, depth in metres]. */
export function project(point, matrix, width, height, fieldOfView) {
  const [x, y, z] = point;
  const at = (row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row];
  const depth = -at(2);
  const scale = height / 2 / Math.tan(fieldOfView / 2) / Math.max(depth, 1e-3);
  return [width / 2 + scale * at(0), height / 2 - scale * at(1), depth];
}

/** "A · actor", or "A" alone where the role says no more. */
export function roleText(person, role) {
  const letter = "AB"[person];
  return !role || role.toLowerCase() === letter.toLowerCase() ? letter : `${letter} · ${role}`;
}

export class Labels {
  constructor(host) {
    this.host = host;
    this.labels = [];
  }

  load(roles) {
    this.host.replaceChildren();
    this.labels = roles.map((role, person) => {
      const label = document.createElement("span");
      label.className = `pdd-label pdd-label-${"ab"[person]}`;
      label.textContent = roleText(person, role);
      this.host.append(label);
      return label;
    });
  }

  /** Puts each label over its spot; `spots` are project() results. The nearer one lies on top. */
  place(spots) {
    this.labels.forEach((label, i) => {
      const [x, y, depth] = spots[i];
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
      label.style.visibility = depth > 0.1 ? "visible" : "hidden";
      label.style.zIndex = String(1000 - Math.round(10 * Math.min(depth, 99)));
    });
  }
}

export class Tip {
  constructor(host) {
    this.host = host;
  }

  /** Shows the tip for the joint nearest to the pointer: spots[person][joint] are project() results. */
  show(pointer, spots, describe) {
    let best = null;
    spots.forEach((person, p) =>
      person.forEach(([x, y, depth], j) => {
        const distance = Math.hypot(x - pointer[0], y - pointer[1]);
        if (distance < REACH_PX && (!best || distance + 4 * depth < best.score)) best = { p, j, x, y, score: distance + 4 * depth };
      }),
    );
    this.host.hidden = !best;
    if (!best) return;
    this.host.textContent = describe(best.p, best.j);
    this.host.style.transform = `translate(${best.x + 14}px, ${best.y - 14}px)`;
  }

  hide() {
    this.host.hidden = true;
  }
}
