// Entry point: a panel that turns a video or the webcam's picture into landmarks for the server.

import { detector } from "./detector.js";
import { drawPerson } from "./drawing.js";
import { close, FilmError, LONGEST, openFilm, seek, times } from "./film.js";
import { Landmarks } from "./landmarks.js";
import { Panel } from "./panel.js";
import { closeWebcam, countDown, openWebcam, record } from "./webcam.js";
import { loadStyles } from "../player/loader.js";
import { say } from "../texts.js";

/** `element` holds camera.html; landmarks become the value of `props`, and `trigger` tells the page's Python side. */
export function mount(element, props, watch, trigger) {
  loadStyles(new URL("camera.css", import.meta.url).href);
  new CameraPanel(element.querySelector(".pdcam"), (text) => {
    props.value = text;
    trigger("submit");
  });
}

class CameraPanel extends Panel {
  constructor(root, send) {
    super(root, ["choose", "record", "file", "count", "progress", "cancel"]);
    this.send = send;
    this.detector = detector();
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
    this.takeTurn();
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
      each: (done, all, [person]) => {
        this.progress.value = done / all;
        drawPerson(this.drawing, person, this.video);
        const left = ((performance.now() - began) / done) * (all - done) / 1000;
        this.say(say("camera.reading", { done, all }) + (left > 3 ? say("camera.left", { seconds: Math.ceil(left / 5) * 5 }) : ""));
      },
    });
    if (!landmarks) return;
    this.state("idle");
    this.say(""); // the tab says what comes of it
    this.send(JSON.stringify({ name, ...landmarks.pack() }));
  }

  show(mirrored) {
    this.stage.hidden = false;
    this.stage.classList.toggle("pdcam-mirror", mirrored);
    drawPerson(this.drawing, null, this.video);
  }
}

/**
 * Looks through the film in `video`; `each(done, all, people)` hears of every picture, and `stopped()` says whether to
 * stop. Returns the landmarks, or null where it was stopped; throws a FilmError for a film without anybody.
 */
export async function analyse(video, detector, { each = () => {}, stopped = () => false } = {}) {
  const when = times(video);
  await detector.begin();
  const landmarks = new Landmarks(video.videoWidth, video.videoHeight);
  for (const [i, time] of when.entries()) {
    await seek(video, time);
    const people = await detector.detect(video, time);
    if (stopped()) return null;
    landmarks.add(time - when[0], people);
    each(i + 1, when.length, people);
  }
  if (!landmarks.people.length) throw new FilmError(say("camera.nobody"));
  return landmarks;
}
