// What buttons and keys ask for, by name: play, step, sample, camera, picture, … (input.js and player.html).

import { node } from "./node.js";

const SPEEDS = [0.25, 0.5, 1, 1.5, 2];
const MOVES = new Set(["play", "step", "first", "last", "sample"]); // to another moment or motion

export class Actions {
  constructor(player) {
    this.player = player;
  }

  do(action, argument) {
    const { player } = this;
    const { clock } = player;
    if (action === "grid" || (action === "close" && player.focus !== null)) return player.enlarge(null);
    if (action === "help" || action === "close") return player.controls.toggleHelp(action === "help" ? undefined : false);
    if (player.data) player.data.rounds = null; // a visitor is at hand: it goes on
    if (action === "fullscreen") return this.toggleFullscreen();
    if (!player.data) return;
    if (action === "pose") return player.directing.togglePosing();
    if (action === "draw") return player.directing.toggleDrawing();
    if (MOVES.has(action) && !player.directing.mayLeave()) return;
    if (action === "pause") clock.pause();
    else if (action === "play") clock.playing ? clock.pause() : clock.play();
    else if (action === "loop") clock.loop = !clock.loop;
    else if (action === "step") {
      clock.pause();
      clock.seek(Math.round(clock.shown) + argument);
    } else if (action === "first") clock.seek(0);
    else if (action === "last") clock.seek(clock.frames - 1);
    else if (action === "faster") this.setSpeed(SPEEDS[Math.min(Math.max(SPEEDS.indexOf(clock.speed) + argument, 0), SPEEDS.length - 1)]);
    else if (action === "sample") player.select(player.sampleIndex + argument);
    else if (action === "camera") player.framing.goTo(argument);
    else if (action === "picture") this.savePicture();
    else if (action === "follow") player.orbit.following = !player.orbit.following;
    else if (action === "figure") player.clothes.choose(argument);
    else if (action === "ghosts") player.show.ghosts = !player.show.ghosts;
    player.refresh();
  }

  setSpeed(speed) {
    this.player.clock.speed = speed;
    this.player.controls.show(this.player);
  }

  async toggleFullscreen() {
    const { root } = this.player;
    if (document.fullscreenElement === root) await document.exitFullscreen();
    else if (root.requestFullscreen) await root.requestFullscreen().catch(() => this.fillWindow());
    else this.fillWindow(); // phones without the interface
  }

  fillWindow() {
    this.player.root.classList.toggle("pdd-full");
    this.player.refresh();
  }

  /** Saves the scene that the stage shows, or the scenes of a grid. */
  async savePicture() {
    const { clock, shown, stage, sampleIndex } = this.player;
    const images = await Promise.all(shown.map((pane) => pane.scene.picture()));
    const ratio = images[0].width / shown[0].host.clientWidth;
    const canvas = node("canvas");
    [canvas.width, canvas.height] = [ratio * stage.clientWidth, ratio * stage.clientHeight].map(Math.round);
    const context = canvas.getContext("2d");
    images.forEach((image, i) => context.drawImage(image, ratio * shown[i].host.offsetLeft, ratio * shown[i].host.offsetTop));
    const download = `pas-de-deux-${sampleIndex + 1}-frame-${Math.round(clock.shown)}.png`;
    Object.assign(node("a"), { href: canvas.toDataURL("image/png"), download }).click();
  }
}
