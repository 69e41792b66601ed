// Saving what the stage shows: the scene, the names above heads and a line about the moment.

import { css } from "./palette.js";

export async function savePicture({ panes, stage, theme, caption, name }) {
  const images = await Promise.all(panes.map((pane) => pane.scene.picture()));
  const ratio = images[0].width / panes[0].host.clientWidth;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [ratio * stage.clientWidth, ratio * stage.clientHeight].map(Math.round);
  const context = canvas.getContext("2d");
  context.fillStyle = css(theme.background);
  context.fillRect(0, 0, canvas.width, canvas.height);
  images.forEach((image, i) => context.drawImage(image, ratio * panes[i].host.offsetLeft, ratio * panes[i].host.offsetTop));
  context.scale(ratio, ratio);
  const family = getComputedStyle(stage).fontFamily;
  const from = stage.getBoundingClientRect();
  context.textBaseline = "middle";
  context.textAlign = "center";
  context.font = `600 12px ${family}`;
  for (const label of panes.flatMap((pane) => pane.labels.labels)) {
    const box = label.getBoundingClientRect();
    context.fillStyle = getComputedStyle(label).backgroundColor;
    context.beginPath();
    context.roundRect(box.left - from.left, box.top - from.top, box.width, box.height, box.height / 2);
    context.fill();
    context.fillStyle = getComputedStyle(label).color;
    context.fillText(label.textContent, box.left - from.left + box.width / 2, box.top - from.top + box.height / 2 + 0.5);
  }
  context.textAlign = "left";
  context.font = `12px ${family}`;
  context.fillStyle = css(theme.ghost);
  context.fillText(caption, 14, stage.clientHeight - 16, stage.clientWidth - 28);
  const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
