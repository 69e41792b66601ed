// What the people stand on: a floor that runs to a horizon, a sky above it, and soft shadows on the floor.
//
// Floor and sky are one mesh of rings about the point that the camera follows. The shadow is a small picture
// that its texture multiplies onto the floor; beyond the picture's edge nothing is shaded.

import { floorAt, skyAt } from "./palette.js";

const SIDES = 40;
const RADII = [0, 0.6, 1.3, 2.1, 3, 4.2, 5.8, 8, 10, 12, 14, 16, 18, 30, 45];
const HEIGHTS = [0.7, 2, 4, 6, 8.5, 11.5, 15, 19, 24, 30]; // of the sky, at the last radius; the first is a soft edge
const SIZE = 192; // pixels of the shadow's picture, each way
const LEAST_SPAN = 5; // metres across it
const BELOW = 0.004; // metres by which the floor lies under the lines drawn on it
const SAMPLES = 3; // a bone
export const HIGHEST = 1.8; // metres over the floor from which nothing is shaded
const GAUSS = Float32Array.from({ length: 257 }, (_, i) => Math.exp(-4.5 * (i / 256))); // of d²/(3σ)², 0..1

/** Triangles of the ground about a point: positions, colours (4 a corner) and texture places (2 a corner). */
export class Ground {
  constructor() {
    const rings = RADII.length + HEIGHTS.length;
    this.corners = [];
    for (let ring = 0; ring + 1 < rings; ring++) {
      for (let side = 0; side < SIDES; side++) {
        const [a, b, c, d] = [[ring, side], [ring + 1, side], [ring + 1, side + 1], [ring, side + 1]];
        this.corners.push(a, b, c);
        if (ring) this.corners.push(a, c, d);
      }
    }
    this.positions = new Float32Array(3 * this.corners.length);
    this.colors = new Float32Array(4 * this.corners.length);
    this.places = new Float32Array(2 * this.corners.length);
    this.shadow = new Shadow();
  }

  /** Lays the ground out about `center` in a theme's colours. */
  lay(center, theme, scale) {
    const far = RADII[RADII.length - 1];
    const points = [];
    const shades = [];
    [...RADII, ...HEIGHTS].forEach((value, ring) => {
      const onFloor = ring < RADII.length;
      const [radius, height] = onFloor ? [value, -BELOW] : [far, value];
      shades.push(onFloor ? floorAt(theme, radius) : skyAt(theme, Math.atan2(height, far)));
      points.push([radius, height]);
    });
    this.corners.forEach(([ring, side], i) => {
      const [radius, height] = points[ring];
      const angle = (2 * Math.PI * side) / SIDES;
      const p = [center[0] + radius * Math.cos(angle), center[1] + radius * Math.sin(angle), height];
      for (let k = 0; k < 3; k++) {
        this.positions[3 * i + k] = p[k] * scale[k];
        this.colors[4 * i + k] = shades[ring][k];
      }
      this.colors[4 * i + 3] = 1;
    });
  }

  /** Where each corner finds itself in the shadow's picture, for the square it covers now. */
  place(scale) {
    const { origin, span } = this.shadow;
    for (let i = 0; i < this.corners.length; i++) {
      for (let k = 0; k < 2; k++) this.places[2 * i + k] = (this.positions[3 * i + k] / scale[k] - origin[k]) / span;
    }
  }
}

/** The shadow's picture: what hides the sky from each spot of the floor. */
export class Shadow {
  constructor() {
    this.size = SIZE;
    this.field = new Float32Array(SIZE * SIZE);
    this.pixels = new Uint8Array(4 * SIZE * SIZE).fill(255);
    this.origin = [0, 0];
    this.span = LEAST_SPAN;
  }

  /**
   * Shades the floor under poses of [x, y, z] a joint; `figures` (or none) press their soles on it.
   * `tint` [r, g, b] is what full shade multiplies the floor by; `shades` are [x, y, width, darkness] of things.
   */
  cast(poses, skeleton, figures, tint, shades = []) {
    const all = poses.flat();
    const low = [0, 1].map((i) => Math.min(...all.map((p) => p[i])) - 0.9);
    const high = [0, 1].map((i) => Math.max(...all.map((p) => p[i])) + 0.9);
    // The square grows in steps, so that the shade does not crawl over its pixels.
    this.span = Math.max(Math.ceil(Math.max(high[0] - low[0], high[1] - low[1])), LEAST_SPAN);
    const pixel = this.span / SIZE;
    this.origin = [0, 1].map((i) => Math.round(((low[i] + high[i]) / 2 - this.span / 2) / pixel) * pixel);
    this.field.fill(0);
    for (const points of poses) {
      for (const bone of skeleton.bones) {
        const [a, b] = [points[bone.from], points[bone.to]];
        for (let k = 0; k < SAMPLES; k++) {
          const t = (k + 0.5) / SAMPLES;
          const height = a[2] + t * (b[2] - a[2]);
          const long = Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) / SAMPLES;
          const fade = Math.max(1 - height / HIGHEST, 0);
          this.splat(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0.05 + 0.17 * Math.max(height, 0), 6 * bone.radius * long * fade * fade);
        }
      }
    }
    for (const spot of shades) this.splat(...spot);
    for (const figure of figures) this.press(figure);
    for (let i = 0; i < this.field.length; i++) {
      const dark = 1 - Math.exp(-this.field[i]);
      for (let c = 0; c < 3; c++) this.pixels[4 * i + c] = 255 * (1 - dark * (1 - tint[c]));
    }
    for (let k = 0; k < SIZE; k++) {
      for (const i of [k, SIZE * (SIZE - 1) + k, SIZE * k, SIZE * k + SIZE - 1]) this.pixels.fill(255, 4 * i, 4 * i + 4);
    }
  }

  /** What touches the floor, or nearly, darkens it right there. */
  press({ vertices }) {
    for (let i = 0; i < vertices.length; i += 3) {
      const height = vertices[i + 2];
      if (height < 0.07) this.splat(vertices[i], vertices[i + 1], 0.03, 0.0006 * Math.min(Math.exp(-height / 0.02), 1.2));
    }
  }

  splat(x, y, sigma, amount) {
    const pixel = this.span / SIZE;
    const [cx, cy] = [(x - this.origin[0]) / pixel - 0.5, (y - this.origin[1]) / pixel - 0.5];
    const reach = Math.max((3 * sigma) / pixel, 1.5);
    const peak = amount / (2 * Math.PI * sigma * sigma);
    const [x0, x1] = [Math.max(Math.ceil(cx - reach), 0), Math.min(Math.floor(cx + reach), SIZE - 1)];
    const [y0, y1] = [Math.max(Math.ceil(cy - reach), 0), Math.min(Math.floor(cy + reach), SIZE - 1)];
    const k = 256 / (reach * reach);
    for (let py = y0; py <= y1; py++) {
      for (let px = x0; px <= x1; px++) {
        const at = k * ((px - cx) ** 2 + (py - cy) ** 2);
        if (at < 256) this.field[SIZE * py + px] += peak * GAUSS[at | 0];
      }
    }
  }
}
