// A live stream on the server: one message after the other, each answered with the partner's frames.

import { say } from "../texts.js";

const PATIENCE = 60000; // milliseconds in which a lost connection may come back
const AGAIN = 1000; // milliseconds between two attempts
const SLOWEST = 15000; // milliseconds for an answer; the networks may have to be loaded for the first

/** What is wrong and what to do, in a sentence. */
export class LiveError extends Error {}

/** The server cannot be reached. */
class Lost extends Error {}

export class Connection {
  /** `address` is that of the page's live streams; `wanted` what is asked for: the partner. */
  constructor(address, wanted, { lost = () => {} } = {}) {
    this.address = address;
    this.wanted = wanted;
    this.lost = lost; // hears that the connection is lost, or there again
    this.id = null;
    this.closed = false;
  }

  /** Opens the stream; returns the payload that its frames belong to. */
  async open() {
    const { id, payload } = await this._ask("POST", "", this.wanted, 4 * SLOWEST);
    if (this.closed) {
      this.id = id;
      this.close();
    }
    this.id = id;
    return payload;
  }

  /**
   * Sends a message and returns its answer, or null where the stream had to be opened anew and the message is gone.
   * Throws a LiveError where it is over.
   */
  async send(message) {
    try {
      return await this._ask("POST", `/${this.id}`, message, SLOWEST);
    } catch (error) {
      if (!(error instanceof Lost)) throw error;
    }
    const until = performance.now() + PATIENCE;
    this.lost(true);
    while (!this.closed) {
      try {
        await this.open();
        this.lost(false);
        return null;
      } catch (error) {
        if (!(error instanceof Lost) || performance.now() > until) throw error instanceof Lost ? new LiveError(say("live.unreachable")) : error;
      }
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
    }
    return null;
  }

  /** Tells the server that the stream is over; safe while the page closes. */
  close() {
    this.closed = true;
    const { id } = this;
    this.id = null;
    if (id) fetch(`${this.address}/${id}`, { method: "DELETE", keepalive: true }).catch(() => {});
  }

  async _ask(method, path, content, patience) {
    let answer;
    try {
      answer = await fetch(this.address + path, {
        method, body: JSON.stringify(content), headers: { "Content-Type": "application/json" }, signal: AbortSignal.timeout(patience),
      });
    } catch {
      throw new Lost();
    }
    let fields = {};
    try {
      fields = await answer.json();
    } catch {
      // a proxy's own page
    }
    if (answer.ok) return fields;
    if (path && answer.status === 404) throw new Lost(); // a server that was started anew
    if ([502, 504].includes(answer.status)) throw new Lost();
    if (answer.status === 404) throw new LiveError(say("live.no_streams"));
    throw new LiveError(typeof fields.detail === "string" ? fields.detail : say("live.error", { status: answer.status }));
  }
}
