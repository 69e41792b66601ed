// Entry point: a panel that turns a video or the webcam's picture into landmarks for the server.

import { analyse } from "./analysis.js";
import { detectorOf } from "./detector.js";
import { drawPeople } from "./drawing.js";
import { close, FilmError, LONGEST, openFilm } from "./film.js";
import { takesTurns, takeTurn } from "./turns.js";
import { closeWebcam, countDown, openWebcam, record } from "./webcam.js";
import { say, translate } from "../texts.js";

/** `element` holds camera.html; `send(text)` hands landmarks to the page's Python side. */
export async function mount(element, send, { folder }) {
  translate(element);
  new Panel(element.querySelector(".pdcam"), send, detectorOf(folder));
  const address = new URL("camera.css", import.meta.url).href;
  if (document.querySelector(`link[href="${address}"]`)) return;
  const link = Object.assign(document.createElement("link"), { rel: "stylesheet", href: address });
  document.head.append(link);
}

class Panel {
  constructor(root, send, detector) {
    this.send = send;
    this.detector = detector;
    this.run = 0; // number of what is being done: a later one stops it
    const find = (name) => root.querySelector(`.pdcam-${name}`);
    for (const name of ["open", "body", "choose", "record", "file", "stage", "video", "drawing", "count", "progress", "begin", "stop", "cancel", "line"])
      this[name] = find(name);
    this.root = root;
    this.open.onclick = () => this.toggle();
    this.choose.onclick = () => this.file.click();
    this.file.onchange = () => {
      const [file] = this.file.files;
      this.file.value = "";
      if (file) this.attempt(() => this.read(file, file.name));
    };
    this.record.onclick = () => this.attempt(() => this.prepare());
    this.begin.onclick = () => this.attempt(() => this.film(), false);
    this.cancel.onclick = () => {
      this.rest();
      this.say(say("camera.cancelled"));
    };
    takesTurns(this);
    this.open.disabled = false; // before, nobody would hear
  }

  toggle() {
    this.body.hidden = !this.body.hidden;
    this.open.setAttribute("aria-expanded", String(!this.body.hidden));
    if (this.body.hidden) this.rest();
  }

  get busy() {
    return this.root.dataset.state !== "idle";
  }

  say(text, tone = "") {
    this.line.textContent = text;
    this.line.dataset.tone = tone;
  }

  /** Shows the buttons of a state: idle, ready (the webcam is on), recording or reading. */
  state(name) {
    this.root.dataset.state = name;
    this.choose.hidden = this.record.hidden = name !== "idle";
    this.begin.hidden = name !== "ready";
    this.stop.hidden = name !== "recording";
    this.cancel.hidden = name === "idle";
    this.progress.hidden = name !== "reading";
  }

  /** Stops whatever is done and lets go of camera and film. */
  rest() {
    this.run++;
    closeWebcam(this.video);
    close(this.video);
    this.stage.hidden = true;
    this.count.textContent = "";
    this.state("idle");
  }

  async attempt(job, fresh = true) {
    if (fresh) this.rest();
    takeTurn(this);
    const run = ++this.run;
    try {
      await job();
    } catch (error) {
      if (run !== this.run) return;
      if (!(error instanceof FilmError)) console.error(error);
      this.rest();
      this.say(error instanceof FilmError ? error.message : say("camera.unread"), "error");
    }
  }

  async prepare() {
    this.say(say("camera.opening"));
    const run = this.run;
    await openWebcam(this.video);
    if (run !== this.run) return closeWebcam(this.video);
    this.show(true);
    this.say(say("camera.step_back", { most: LONGEST }));
    this.state("ready");
  }

  async film() {
    const run = this.run;
    const stopped = () => run !== this.run;
    this.state("counting");
    if (!(await countDown((left) => (this.count.textContent = left || ""), stopped))) return;
    const { film, stop } = record(this.video.srcObject);
    this.state("recording");
    this.say(say("camera.recording"));
    this.stop.onclick = stop;
    const file = await film;
    if (stopped()) return;
    closeWebcam(this.video);
    await this.read(file, "Webcam");
  }

  async read(file, name) {
    const run = this.run;
    const stopped = () => run !== this.run;
    this.say(say("camera.opening_video"));
    this.state("reading");
    this.progress.value = 0;
    await openFilm(this.video, file);
    if (stopped()) return;
    this.show(false);
    this.say(say("camera.looking"));
    const began = performance.now();
    const landmarks = await analyse(this.video, this.detector, {
      stopped,
      each: (done, all, people) => {
        this.progress.value = done / all;
        drawPeople(this.drawing, people, this.video.videoWidth, this.video.videoHeight);
        const left = ((performance.now() - began) / done) * (all - done) / 1000;
        this.say(say("camera.reading", { done, all }) + (left > 3 ? say("camera.left", { seconds: Math.ceil(left / 5) * 5 }) : ""));
      },
    });
    if (!landmarks) return;
    this.state("idle");
    this.say(say("camera.sent"));
    this.send(landmarks.pack({ name }));
  }

  show(mirrored) {
    this.stage.hidden = false;
    this.stage.classList.toggle("pdcam-mirror", mirrored);
    drawPeople(this.drawing, [], this.video.videoWidth, this.video.videoHeight);
  }
}
