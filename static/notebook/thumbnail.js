// Moving thumbnails: the browser's side of webdemo/view/thumbnail.py. Those in view move, ten times a second.

const BONES = [[0, 1], [1, 2], [1, 3], [1, 4], [3, 5], [4, 6], [5, 7], [6, 8], [0, 9], [0, 10], [9, 11], [10, 12]];
const JOINTS = 13;
const PACE = 100; // ms between two moments
const COLOURS = ["#2468d8", "#e07a10"];

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
  canvas.bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
  draw(canvas, 0);
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) watcher.observe(canvas);
}

function draw(canvas, at) {
  const [people, frames] = canvas.bytes;
  const pen = canvas.getContext("2d");
  const size = canvas.width;
  pen.clearRect(0, 0, size, size);
  pen.lineWidth = size / 40;
  pen.lineCap = "round";
  for (let person = 0; person < people; person++) {
    const from = 2 + 2 * JOINTS * (person * frames + (at % frames));
    const place = (joint) => [0, 1].map((k) => (size * canvas.bytes[from + 2 * joint + k]) / 255);
    pen.strokeStyle = pen.fillStyle = COLOURS[person % 2];
    pen.beginPath();
    for (const [a, b] of BONES) {
      pen.moveTo(...place(a));
      pen.lineTo(...place(b));
    }
    pen.stroke();
    pen.beginPath();
    pen.arc(...place(2), size / 26, 0, 2 * Math.PI);
    pen.fill();
  }
}
