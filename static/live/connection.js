// A live stream on the server: one message after the other, each answered with the partner's frames.

import { say } from "../texts.js";

const SLOWEST = 15000; // milliseconds for an answer; the networks may have to be loaded for the first

/** What is wrong and what to do, in a sentence. */
export class LiveError extends Error {}

export class Connection {
  /** `wanted` is what is asked for: the partner. */
  constructor(wanted) {
    const root = window.gradio_config?.root || new URL(".", document.baseURI).href;
    this.address = `${root.replace(/[/]$/, "")}/live`;
    this.wanted = wanted;
    this.id = null;
    this.closed = false;
    this.leaving = new AbortController();
  }

  /** Opens the stream; returns the payload that its frames belong to. */
  async open() {
    const { id, payload } = await this._ask("", this.wanted, 4 * SLOWEST);
    this.id = id;
    if (this.closed) this.close();
    return payload;
  }

  /** Sends a message and returns its answer; throws a LiveError where the stream is over. */
  send(message) {
    return this._ask(`/${this.id}`, message, SLOWEST);
  }

  /** Tells the server that the stream is over; safe while the page closes. */
  close() {
    this.closed = true;
    const { id } = this;
    if (id) this.leaving.abort(); // what is on its way would be refused
    this.id = null;
    if (id) fetch(`${this.address}/${id}`, { method: "DELETE", keepalive: true }).catch(() => {});
  }

  async _ask(path, content, patience) {
    let answer;
    const signal = AbortSignal.any([this.leaving.signal, AbortSignal.timeout(patience)]);
    try {
      answer = await fetch(this.address + path, {
        method: "POST", body: JSON.stringify(content), headers: { "Content-Type": "application/json" }, signal,
      });
    } catch {
      throw new LiveError(say("live.unreachable"));
    }
    const fields = await answer.json().catch(() => ({})); // a proxy has a page of its own
    if (fields.ended) throw new LiveError(fields.ended);
    if (answer.ok) return fields;
    if ([502, 504].includes(answer.status)) throw new LiveError(say("live.unreachable"));
    if (!path && answer.status === 404) throw new LiveError(say("live.no_streams"));
    throw new LiveError(typeof fields.detail === "string" ? fields.detail : say("live.error", { status: answer.status }));
  }
}
