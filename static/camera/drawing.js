// Whom the detector found, drawn over the picture.

const BONES = [
  [11, 12], [11, 23], [12, 24], [23, 24], [11, 13], [13, 15], [12, 14], [14, 16],
  [23, 25], [25, 27], [24, 26], [26, 28], [27, 31], [28, 32], [0, 11], [0, 12],
];
const COLOUR = "#6ca6ff";

/** Draws a person, or nobody, over a video's present picture. */
export function drawPerson(canvas, person, { videoWidth: width, videoHeight: height }) {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const pen = canvas.getContext("2d");
  pen.clearRect(0, 0, width, height);
  if (!person) return;
  pen.lineWidth = Math.max(3, height / 110);
  pen.lineCap = "round";
  pen.strokeStyle = COLOUR;
  for (const [from, to] of BONES) {
    pen.globalAlpha = Math.max(0.15, Math.min(person.seen[from], person.seen[to]));
    pen.beginPath();
    pen.moveTo(person.image[from][0] * width, person.image[from][1] * height);
    pen.lineTo(person.image[to][0] * width, person.image[to][1] * height);
    pen.stroke();
  }
  pen.globalAlpha = 1;
}
