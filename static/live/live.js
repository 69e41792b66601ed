// Entry point: a panel in which somebody moves and a partner answers at once.

import { detectorOf } from "../camera/detector.js";
import { drawPeople } from "../camera/drawing.js";
import { FilmError } from "../camera/film.js";
import { takesTurns, takeTurn } from "../camera/turns.js";
import { Stream } from "../player/stream.js";
import { Connection, LiveError } from "./connection.js";
import { Person, Webcam } from "./sources.js";
import { say, translate } from "../texts.js";

const WAITING = 8; // messages that wait for the server; older ones are dropped
const TOGETHER = 6; // messages that are sent as one
const FIGURES = 500; // milliseconds between two updates of the figures
const NAMES = { agent: "agent", regennet: "reactor" };

/**
 * `element` holds live.html; `keep(text)` hands a stream to the page's Python side; `address` is that of the live
 * streams, `mediapipe` of the detector's files.
 */
export function mount(element, keep, { address, mediapipe }) {
  translate(element);
  new Panel(element, keep, address, mediapipe);
  for (const name of ["../camera/camera.css", "live.css"]) {
    const href = new URL(name, import.meta.url).href;
    if (document.querySelector(`link[href="${href}"]`)) continue;
    document.head.append(Object.assign(document.createElement("link"), { rel: "stylesheet", href }));
  }
}

class Panel {
  constructor(element, hand, address, mediapipe) {
    Object.assign(this, { element, hand, address, mediapipe, run: 0, last: null });
    this.root = element.querySelector(".pdlive");
    const find = (name) => this.root.querySelector(`.${name}`);
    for (const name of ["open", "body", "stage", "video", "drawing", "begin", "stop", "line"]) this[name] = find(`pdcam-${name}`);
    for (const name of ["source", "partner", "keep", "belief", "text", "chances", "figures"]) this[name] = find(`pdlive-${name}`);
    this.open.onclick = () => this.toggle();
    this.begin.onclick = () => this.start();
    this.stop.onclick = () => this.rest(`${say("live.stopped")} ${say("live.again")}`);
    this.keep.onclick = () => this.handOver();
    window.addEventListener("pagehide", () => this.rest());
    takesTurns(this);
    this.open.disabled = false; // before, nobody would hear
  }

  get busy() {
    return this.root.dataset.state !== "idle";
  }

  /** The player beside the panel. */
  get player() {
    const near = this.element.closest('[role="tabpanel"]') ?? document;
    return near.querySelector(".pdd")?.player ?? null;
  }

  toggle() {
    this.body.hidden = !this.body.hidden;
    this.open.setAttribute("aria-expanded", String(!this.body.hidden));
    if (this.body.hidden) this.rest();
  }

  say(text, tone = "") {
    this.line.textContent = text;
    this.line.dataset.tone = tone;
  }

  state(name) {
    this.root.dataset.state = name;
    this.begin.hidden = name !== "idle";
    this.stop.hidden = name === "idle";
    for (const input of [this.source, this.partner]) input.disabled = name !== "idle";
    this.keep.hidden = !this.last?.long;
  }

  /** Ends the stream and lets go of camera and film. */
  rest(text = "", tone = "") {
    this.run++;
    this.live?.source.end();
    this.live?.connection.close();
    this.live?.stream?.end();
    this.live = null;
    this.stage.hidden = this.belief.hidden = true;
    this.state("idle");
    this.say(text, tone);
  }

  async start() {
    this.last = null;
    this.rest();
    takeTurn(this);
    const run = this.run;
    const over = () => run !== this.run;
    this.state("live");
    this.figures.textContent = "";
    try {
      const { player } = this;
      if (!player) throw new FilmError(say("live.no_view"));
      const source = this.source.value === "clip" ? new Person(player) : new Webcam(this.video, detectorOf(this.mediapipe));
      const partner = this.partner.value;
      const connection = new Connection(this.address, { partner }, {
        lost: (gone) => this.say(say(gone ? "live.lost" : "live.connected"), gone ? "error" : ""),
      });
      this.live = { source, connection, stream: null };
      this.say(say(source.video ? "live.opening_both" : "live.opening"));
      await source.begin(); // takes seconds, in which nothing could be sent
      if (over()) return;
      const payload = await connection.open();
      if (over()) return;
      this.live.stream = this.last = new Stream(player, payload, ["you", NAMES[partner]]);
      this.last.partner = partner;
      if (source.video) {
        this.stage.hidden = false;
        this.stage.classList.add("pdcam-mirror");
        drawPeople(this.drawing, [], source.video.videoWidth, source.video.videoHeight);
        this.say(say("live.stand"));
      }
      await this.follow(over);
    } catch (error) {
      if (over()) return;
      const known = error instanceof FilmError || error instanceof LiveError;
      if (!known) console.error(error);
      this.rest(known ? error.message : say("live.broke"), "error");
    }
  }

  /** Looks and sends until the source is at its end. */
  async follow(over) {
    const { source } = this.live;
    const waiting = [];
    this.tally = { taken: [], delays: [], lost: 0, shown: 0 };
    let wake = () => {};
    let room = () => {};
    let ended = false;
    const sending = (async () => {
      while (!over() && !(ended && !waiting.length)) {
        if (!waiting.length) await new Promise((resolve) => (wake = resolve));
        else await this.exchange(waiting.splice(0, TOGETHER), over);
        room();
      }
    })();
    sending.catch(() => {}).then(() => {
      ended = true; // an error is thrown where it is awaited below
      room();
    });
    while (!over() && !ended) {
      const seen = await source.next();
      if (!seen) break;
      if (!this.root.offsetParent) return this.rest(say("live.left"));
      if (seen.people) drawPeople(this.drawing, seen.people, source.video.videoWidth, source.video.videoHeight);
      waiting.push(seen);
      if (source.waits) {
        wake();
        while (waiting.length >= WAITING && !ended && !over()) await new Promise((resolve) => (room = resolve));
      } else if (waiting.length > WAITING) {
        waiting.shift();
        this.tally.lost++;
      }
      wake();
    }
    ended = true;
    wake();
    await sending;
    if (over()) return;
    if (!this.live.stream.known) throw new FilmError(say("live.nobody"));
    this.rest(`${say("live.ended")} ${say("live.again")}`);
  }

  /** Ends the stream, where it still runs, and makes its last minute a result of the page. */
  handOver() {
    const { last } = this;
    this.rest();
    if (!last?.shown) return this.say(say("live.replaced"), "error");
    this.hand(JSON.stringify({ partner: last.partner, positions: last.pack() }));
    this.last = null;
    this.keep.hidden = true;
    this.say(say("live.kept"));
  }

  /** Sends what has been seen, and shows what is answered. */
  async exchange(seen, over) {
    const { connection, stream } = this.live;
    const answer = await connection.send(together(seen.map(({ message }) => message)));
    if (over()) return;
    if (!answer) return; // the stream was opened anew
    if (!stream.shown) return this.rest(say("live.gone"));
    const now = performance.now();
    const { tally } = this;
    tally.taken.push(...seen.map(({ taken }) => taken));
    if (answer.frames) {
      stream.add(answer.frames, answer.belief.state === "answers" ? "answers" : "", answer);
      tally.delays.push(now - seen.at(-1).taken + (1000 * stream.lag) / 30);
    }
    this.keep.hidden = !stream.long;
    this.believe(answer.belief);
    this.say(answer.hint || (stream.known ? say("live.live") : say("live.stand")), answer.hint ? "error" : "");
    this.measure(now);
  }

  believe({ state, text, chances }) {
    this.belief.hidden = !text;
    this.belief.dataset.state = state;
    if (this.text.textContent !== text) this.text.textContent = text;
    this.chances.replaceChildren(
      ...chances.map(([label, chance]) => {
        const item = document.createElement("li");
        item.style.setProperty("--share", `${100 * chance}%`);
        for (const part of [label, `${Math.round(100 * chance)} %`]) item.append(Object.assign(document.createElement("span"), { textContent: part }));
        return item;
      }),
    );
  }

  measure(now) {
    const { tally } = this;
    if (now - tally.shown < FIGURES) return;
    tally.shown = now;
    tally.taken = tally.taken.slice(-60);
    tally.delays = tally.delays.slice(-30);
    const { taken, delays } = tally;
    const span = (taken.at(-1) - taken[0]) / 1000;
    const rate = span > 0 ? (taken.length - 1) / span : 0;
    const delay = median(delays);
    const missed = this.live.source.missed + tally.lost;
    const parts = [
      say("live.rate", { rate: rate.toFixed(0) }),
      delay === undefined ? "" : say("live.delay", { ms: Math.round(delay) }),
      missed ? say("live.missed", { count: missed }) : "",
    ];
    this.figures.textContent = parts.filter(Boolean).join(" · ");
  }
}

/** The middle value; undefined for an empty list. */
function median(values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}

/** Several messages as one: the pictures or poses one after the other. */
function together(messages) {
  if (messages.length === 1) return messages[0];
  const joined = { ...messages[0] };
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  for (const name of ["times", "counts", "world", "image", "seen", "poses"]) {
    const values = messages.map((message) => message[name]);
    if (Array.isArray(values[0])) joined[name] = values.flat();
    else if (values[0] !== undefined) {
      const parts = values.map(bytes);
      joined[name] = btoa(parts.map((part) => String.fromCharCode(...part)).join(""));
    }
  }
  return joined;
}
