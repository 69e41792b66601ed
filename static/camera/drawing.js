// What was found, drawn over the picture, and how sure it is, along the time line.

const BONES = [
  [11, 12], [11, 23], [12, 24], [23, 24], [11, 13], [13, 15], [12, 14], [14, 16],
  [23, 25], [25, 27], [24, 26], [26, 28], [27, 31], [28, 32], [0, 11], [0, 12],
];
const BODY = [11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28];
const COLOURS = ["#6ca6ff", "#f5a152", "#f87171"];

/** Draws people over a picture of a size. */
export function drawPeople(canvas, people, width, height) {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const pen = canvas.getContext("2d");
  pen.clearRect(0, 0, width, height);
  pen.lineWidth = Math.max(3, height / 110);
  pen.lineCap = "round";
  people.forEach((person, n) => {
    pen.strokeStyle = COLOURS[n % COLOURS.length];
    for (const [from, to] of BONES) {
      pen.globalAlpha = Math.max(0.15, Math.min(person.seen[from], person.seen[to]));
      pen.beginPath();
      pen.moveTo(person.image[from][0] * width, person.image[from][1] * height);
      pen.lineTo(person.image[to][0] * width, person.image[to][1] * height);
      pen.stroke();
    }
  });
  pen.globalAlpha = 1;
}

/** How surely a person is seen, 0 to 1. */
export function sureness(person) {
  return BODY.reduce((sum, point) => sum + person.seen[point], 0) / BODY.length;
}

/** Adds a picture to the strip: green where the person is seen well, grey where nobody is. */
export function drawSureness(canvas, done, all, people) {
  if (done === 1) canvas.width = all;
  const sure = people.length ? sureness(people[0]) : 0;
  const pen = canvas.getContext("2d");
  pen.fillStyle = sure < 0.05 ? "#9ca3af" : `hsl(${Math.round(20 + 130 * Math.max(0, (sure - 0.4) / 0.6))} 65% 45%)`;
  pen.fillRect(done - 1, 0, 1, canvas.height);
}
