// Entry point: a panel in which somebody moves and a partner answers at once.

import { detector } from "../camera/detector.js";
import { drawPerson } from "../camera/drawing.js";
import { FilmError } from "../camera/film.js";
import { Panel } from "../camera/panel.js";
import { loadStyles } from "../player/loader.js";
import { node } from "../player/node.js";
import { Stream } from "../player/stream.js";
import { Connection, LiveError } from "./connection.js";
import { Person, Webcam } from "./sources.js";
import { say } from "../texts.js";

const WAITING = 8; // pictures that wait for the server; older ones are dropped
const TOGETHER = 6; // pictures that are sent as one message

/** `element` holds live.html; a stream to be kept becomes the value of `props`, and `trigger` tells the page's Python side. */
export function mount(element, props, watch, trigger) {
  for (const name of ["../camera/camera.css", "live.css"]) loadStyles(new URL(name, import.meta.url).href);
  new LivePanel(element, (text) => {
    props.value = text;
    trigger("submit");
  });
}

class LivePanel extends Panel {
  constructor(element, hand) {
    super(element.querySelector(".pdlive"), ["source", "partner", "keep", "belief", "text", "chances"]);
    Object.assign(this, { element, hand, last: null });
    this.begin.onclick = () => this.start();
    this.stop.onclick = () => this.rest(`${say("live.stopped")} ${say("live.again")}`);
    this.keep.onclick = () => this.handOver();
    window.addEventListener("pagehide", () => this.rest());
  }

  /** The player beside the panel. */
  get player() {
    const near = this.element.closest('[role="tabpanel"]') ?? document;
    return near.querySelector(".pdd")?.player ?? null;
  }

  state(name) {
    this.root.dataset.state = name;
    this.begin.hidden = name !== "idle";
    this.stop.hidden = name === "idle";
    for (const input of [this.source, this.partner]) input.disabled = name !== "idle";
    this.keep.hidden = !(this.last?.long && this.last.shown);
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
    this.takeTurn();
    const run = this.run;
    const over = () => run !== this.run;
    this.state("live");
    try {
      const { player } = this;
      if (!player) throw new FilmError(say("live.no_view"));
      const source = this.source.value === "clip" ? new Person(player) : new Webcam(this.video, detector());
      const partner = this.partner.value;
      const connection = new Connection({ partner });
      this.live = { source, connection, stream: null };
      this.say(say(source.video ? "live.opening_both" : "live.opening"));
      await source.begin(); // takes seconds, in which nothing could be sent
      if (over()) return;
      const payload = await connection.open();
      if (over()) return;
      this.live.stream = this.last = new Stream(player, payload, [source.video ? "you" : "given", "generated"]);
      this.last.partner = partner;
      if (source.video) {
        this.stage.hidden = false;
        this.stage.classList.add("pdcam-mirror");
        drawPerson(this.drawing, null, source.video);
        this.say(say("live.stand"));
      }
      await this.follow(over);
    } catch (error) {
      this.fail(error, over);
    }
  }

  fail(error, over) {
    if (over()) return;
    const known = error instanceof FilmError || error instanceof LiveError;
    if (!known) console.error(error);
    this.rest(known ? error.message : say("live.broke"), "error");
  }

  /** Looks and sends until the source is at its end. */
  async follow(over) {
    const { source } = this.live;
    const waiting = [];
    let sending = null; // what is on its way
    const send = async () => {
      try {
        await this.exchange(waiting.splice(0, TOGETHER), over);
      } catch (error) {
        this.fail(error, over);
      }
      sending = waiting.length && !over() ? send() : null;
    };
    for (let seen = await source.next(); seen && !over(); seen = await source.next()) {
      if (!this.root.offsetParent) return this.rest(say("live.left"));
      if (seen.people) drawPerson(this.drawing, seen.people[0], source.video);
      waiting.push(seen);
      sending ??= send();
      while (source.waits && sending && !over() && waiting.length >= WAITING) await sending;
      if (waiting.length > WAITING) waiting.shift();
    }
    while (sending && !over()) await sending;
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
  }

  /** Sends what has been seen as one message, and shows what is answered. */
  async exchange(seen, over) {
    const { connection, source, stream } = this.live;
    const answer = await connection.send(source.pack(seen));
    if (over()) return;
    if (!stream.shown) return this.rest(say("live.gone"));
    if (answer.frames) stream.add(answer.frames, answer.belief.state === "answers" ? "answers" : "", answer);
    this.keep.hidden = !stream.long;
    this.believe(answer.belief);
    this.say(answer.hint || (stream.known ? say("live.live") : say("live.stand")), answer.hint ? "error" : "");
  }

  believe({ state, text, chances }) {
    this.belief.hidden = !text;
    this.belief.dataset.state = state;
    if (this.text.textContent !== text) this.text.textContent = text;
    this.chances.replaceChildren(
      ...chances.map(([label, chance]) => {
        const item = node("li");
        item.style.setProperty("--share", `${100 * chance}%`);
        item.append(node("span", "", label), node("span", "", `${Math.round(100 * chance)} %`));
        return item;
      }),
    );
  }
}
