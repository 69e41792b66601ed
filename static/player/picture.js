// Saving what the stage shows: the scene, or the scenes of a grid.

import { node } from "./node.js";

export async function savePicture(panes, stage, name) {
  const images = await Promise.all(panes.map((pane) => pane.scene.picture()));
  const ratio = images[0].width / panes[0].host.clientWidth;
  const canvas = node("canvas");
  [canvas.width, canvas.height] = [ratio * stage.clientWidth, ratio * stage.clientHeight].map(Math.round);
  const context = canvas.getContext("2d");
  images.forEach((image, i) => context.drawImage(image, ratio * panes[i].host.offsetLeft, ratio * panes[i].host.offsetTop));
  Object.assign(node("a"), { href: canvas.toDataURL("image/png"), download: name }).click();
}
