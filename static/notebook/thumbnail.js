// Moving thumbnails: the browser's side of webdemo/view/thumbnail.py. Those in view move, ten times a second.

import { fromBase64 } from "../player/base64.js";
import colours from "../player/colours.json" with { type: "json" };

const JOINTS = 13;
const [PELVIS, NECK, HEAD, SHOULDERS, ELBOWS, WRISTS, KNEES, ANKLES] = [0, 1, 2, [3, 4], [5, 6], [7, 8], [9, 10], [11, 12]];
const PACE = 100; // ms between two moments

const seen = new Set();
let timer = null;
let moment = 0;

const watcher = new IntersectionObserver((changes) => {
  for (const { target, isIntersecting } of changes) isIntersecting ? seen.add(target) : seen.delete(target);
  if (seen.size && timer === null) timer = setInterval(step, PACE);
});

function step() {
  for (const canvas of seen) if (!canvas.isConnected) seen.delete(canvas);
  if (!seen.size) {
    clearInterval(timer);
    timer = null;
  } else if (!document.hidden) {
    moment += 1;
    for (const canvas of seen) draw(canvas, moment);
  }
}

/** Gives a canvas a thumbnail to play; "" leaves it empty. */
export function play(canvas, packed) {
  if (!packed) return;
  canvas.bytes = fromBase64(packed);
  const [people, frames] = canvas.bytes;
  const trunks = [];
  for (let i = 0; i < people * frames; i++) {
    const joints = jointsOf(canvas, Math.floor(i / frames), i % frames);
    trunks.push(Math.hypot(joints[NECK][0] - joints[PELVIS][0], joints[NECK][1] - joints[PELVIS][1]));
  }
  canvas.trunk = Math.max(...trunks);
  draw(canvas, 0);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) watcher.observe(canvas);
}

/** [x, y] of each joint of a person in pixels. */
function jointsOf(canvas, person, at) {
  const frames = canvas.bytes[1], from = 2 + 2 * JOINTS * (person * frames + (at % frames));
  return Array.from({ length: JOINTS }, (_, j) => [0, 1].map((k) => (canvas.width * canvas.bytes[from + 2 * j + k]) / 255));
}

function draw(canvas, at) {
  const pen = canvas.getContext("2d");
  pen.clearRect(0, 0, canvas.width, canvas.width);
  pen.lineCap = pen.lineJoin = "round";
  for (let person = 0; person < canvas.bytes[0]; person++) {
    drawBody(pen, jointsOf(canvas, person, at), canvas.trunk, colours.light.bodies[person % 2]);
  }
}

/** A dressed body on the joints; widths are shares of the trunk, which is about half a metre. */
function drawBody(pen, joints, trunk, worn) {
  const between = (from, to, share) => [0, 1].map((k) => from[k] + share * (to[k] - from[k]));
  const stroke = (points, width, colour) => {
    pen.lineWidth = width * trunk;
    pen.strokeStyle = colour;
    pen.beginPath();
    for (const point of points) pen.lineTo(...point);
    pen.stroke();
  };
  const dot = ([x, y], width, colour) => {
    pen.fillStyle = colour;
    pen.beginPath();
    pen.arc(x, y, 0.5 * width * trunk, 0, 2 * Math.PI);
    pen.fill();
  };
  const chest = between(joints[SHOULDERS[0]], joints[SHOULDERS[1]], 0.5);
  const hips = SHOULDERS.map((joint) => [0, 1].map((k) => joints[PELVIS][k] + 0.5 * (joints[joint][k] - chest[k])));
  const shaded = [1, 0.82]; // the right limbs are darker
  for (const side of [1, 0]) {
    pen.filter = `brightness(${shaded[side]})`;
    stroke([hips[side], joints[KNEES[side]], joints[ANKLES[side]]], 0.3, worn.trousers);
    dot(joints[ANKLES[side]], 0.28, worn.shoes);
  }
  pen.filter = "none";
  stroke([chest, joints[NECK], joints[HEAD]], 0.2, worn.skin);
  stroke([joints[SHOULDERS[0]], joints[SHOULDERS[1]], hips[1], hips[0], joints[SHOULDERS[0]]], 0.3, worn.top);
  pen.fillStyle = worn.top; // the outline is filled
  pen.fill();
  const skull = between(joints[NECK], joints[HEAD], 1.5);
  dot(skull, 0.46, worn.hair);
  dot(between(skull, joints[NECK], 0.35), 0.4, worn.skin);
  for (const side of [1, 0]) {
    pen.filter = `brightness(${shaded[side]})`;
    const [shoulder, elbow, wrist] = [SHOULDERS, ELBOWS, WRISTS].map((pair) => joints[pair[side]]);
    stroke([elbow, wrist], 0.17, worn.skin);
    stroke([shoulder, elbow, between(elbow, wrist, 0.45)], 0.22, worn.top);
  }
  pen.filter = "none";
}
