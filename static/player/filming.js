// The film look: the camera goes slowly to and fro about the people, the floor fades into the sky, and the edges of
// the picture are darker. webdemo/view/filming.py is the same in Python, number for number (a test compares them).

import { reducedMotion } from "./orbit.js";

const ARC = 0.25; // radians to each side
const FASTEST = 0.12; // radians a second
const AWAY = 0.08; // by how much of its distance the camera is farther away at both ends of a motion
const EASE_SECONDS = 0.8;
const STILL = { yaw: 0, away: 1 };

/** How dark the edges are, of the darkest: [place, share], places from 0 in the middle to 1 in a corner. */
export const VIGNETTE = [[0.5, 0], [0.75, 0.3], [1, 1]];

/** Where the camera is at a share (0 to 1) of a motion of so many seconds: radians aside, and times its distance. */
export function move(share, seconds) {
  const around = 2 * Math.PI * share;
  const arc = Math.min(ARC, (FASTEST * seconds) / (2 * Math.PI));
  return { yaw: arc * Math.sin(around), away: 1 + (AWAY * (1 + Math.cos(around))) / 2 };
}

/** The colours of a theme in haze: the floor has gone over into the sky after a few metres. */
export const hazy = (theme) => ({ ...theme, far: theme.horizon, reach: theme.film.reach });

/** Darkens the edges of what was painted on a canvas, as the stage's own are (player.css). */
export function darkenEdges(context, width, height, { film }) {
  const half = Math.SQRT1_2;
  context.save();
  context.scale(width, height);
  const edge = context.createRadialGradient(0.5, 0.5, 0, 0.5, 0.5, half);
  for (const [place, share] of VIGNETTE) edge.addColorStop(place, `rgb(0 0 0 / ${share * film.vignette})`);
  context.fillStyle = edge;
  context.fillRect(0, 0, 1, 1);
  context.restore();
}

export class Filming {
  constructor(player) {
    this.player = player;
    this.on = false;
    this.chosen = null; // what the visitor wants; until they say so, what is there before their first motion has it
    this.weight = 0; // of the camera's move
  }

  /** The switch. The view without it is kept, so that a second press brings back exactly what was there. */
  toggle() {
    this.chosen = !this.on;
    this.set(this.chosen);
  }

  /** Another motion, or none; `greets` says whether it is what is there before anything is asked. */
  load(greets) {
    this.set(this.chosen ?? greets);
    this.step(0);
  }

  /** A hand has taken the camera, which stays where it is. */
  leave() {
    if (!this.on && !this.weight) return;
    this.weight = 0;
    this.chosen = false;
    this.set(false);
  }

  set(on) {
    if (on === this.on) return;
    this.on = on;
    const { player } = this;
    player.root.classList.toggle("pdd-film", on);
    this.dress();
    if (player.scene) player.refresh();
  }

  /** Tells the style sheet how dark the corners are in the present theme. */
  dress() {
    const { root, theme } = this.player;
    root.style.setProperty("--pdd-edge", theme.film.vignette);
  }

  /** How the present theme looks through the camera. */
  seen(theme) {
    return this.on ? (theme.hazy ??= hazy(theme)) : theme;
  }

  /** Whether the camera goes: not where the visitor wants rest, nor while nobody knows how long the motion will be. */
  get moves() {
    const { data, sample } = this.player;
    return this.on && Boolean(data) && !data.stream && !sample.live && !reducedMotion();
  }

  /** Moves the camera to where it is at this moment of the motion; `seconds` since the last call. */
  step(seconds) {
    const { clock, orbit } = this.player;
    const goal = Number(this.moves);
    const most = seconds / EASE_SECONDS;
    this.weight += Math.min(Math.max(goal - this.weight, -most), most);
    this.settled = this.weight === goal;
    if (!this.weight) {
      orbit.drift = STILL;
      return;
    }
    const { yaw, away } = move(clock.shown / Math.max(clock.frames - 1, 1), clock.duration);
    const ease = this.weight * this.weight * (3 - 2 * this.weight);
    orbit.drift = { yaw: ease * yaw, away: 1 + ease * (away - 1) };
  }
}
