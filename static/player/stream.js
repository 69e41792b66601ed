// A motion of two that is still being made: a stream without an end.

import { toBase64 } from "./base64.js";
import { Pace } from "./clock.js";
import { unpackPositions } from "./decode.js";

const KEPT = 1800; // frames that can be looked at again
const DROPPED = 600; // of the oldest, when there are more
const BEHIND = 8; // frames: a clock that lags more jumps
const BUFFER = 2; // frames that it keeps in hand
const LONG = 30; // frames that a stream must have before it can be kept

export class Stream {
  /** `template` is a payload of one person; `roles` are the names of the two. */
  constructor(player, template, roles) {
    this.player = player;
    this.template = template;
    this.roles = roles;
    this.known = 0;
    this.started = false;
    this.pace = new Pace();
  }

  /** Whether the player still shows this stream. */
  get shown() {
    return !this.known || this.player.data?.id === this.template.id;
  }

  /** Whether there is enough to be kept. */
  get long() {
    return this.known >= LONG;
  }

  /** What can be looked at again as base64 of float32 (2, frames, joints, 3); after the end. */
  pack() {
    return toBase64(this.player.sample.motion.values);
  }

  /** Frames by which the picture lags behind what has come. */
  get lag() {
    const { clock } = this.player;
    return this.started && clock.playing ? Math.max(0, this.known - 1 - clock.frame) : 0;
  }

  /**
   * Takes new frames, packed as in webdemo/view/payload.py, a line about them, and the partner's things: whole with the
   * first frames, then the place and rotation of each that `moved`, by its number.
   */
  add(packed, text, { things, moved = [] } = {}) {
    const { player } = this;
    const inHand = this.lag;
    if (!this.known) this._begin(packed, things);
    else this._append(unpackPositions(packed));
    const { clock, sample } = player;
    for (const [index, ...pose] of moved) sample.things.figures[index]?.place(pose);
    sample.live = { text };
    sample.frames = clock.frames = this.known;
    clock.limit = this.known - 1;
    if (!this.started && this.known > 1) {
      this.started = clock.loop = true;
      clock.play();
    }
    clock.hurry = clock.playing ? this.pace.add(performance.now(), inHand) : 1;
    if (clock.playing && clock.limit - clock.frame > BEHIND) {
      clock.frame = clock.limit - BUFFER;
      this.pace.begin();
    }
    player.find(".pdd-range").max = String(this.known - 1);
    player.wake();
  }

  /** Nothing more comes: what is there can be played again. */
  end() {
    const { player, known } = this;
    if (!known || !this.shown) return;
    const { sample } = player;
    const whole = empty(sample.motion, known);
    copyFrames(sample.motion, 0, known, whole, 0);
    sample.motion = whole;
    sample.live = null;
    player.clock.hurry = 1;
    player.select(0);
  }

  _begin(packed, things) {
    const { player, roles } = this;
    const sample = { ...this.template.samples[0], roles, positions: packed, frames: packed.shape[1], curves: [], ...(things && { things }) };
    player.load({ ...this.template, samples: [sample], stream: true });
    const first = player.sample.motion;
    player.sample.motion = empty(first, KEPT);
    copyFrames(first, 0, first.frames, player.sample.motion, 0);
    this.known = first.frames;
  }

  _append(motion) {
    const { clock, sample } = this.player;
    if (this.known + motion.frames > KEPT) {
      copyFrames(sample.motion, DROPPED, this.known, sample.motion, 0);
      this.known -= DROPPED;
      clock.frame = Math.max(0, clock.frame - DROPPED);
    }
    copyFrames(motion, 0, motion.frames, sample.motion, this.known);
    this.known += motion.frames;
  }
}

/** Room for so many frames of the same people. */
const empty = ({ people, joints }, frames) => ({ values: new Float32Array(people * frames * joints * 3), people, frames, joints });

/** Copies a motion's frames from `start` to `stop` into another one, from its frame `at` on. */
function copyFrames(from, start, stop, to, at) {
  const width = 3 * from.joints;
  for (let person = 0; person < from.people; person++) {
    const [first, place] = [width * from.frames * person, width * (to.frames * person + at)];
    to.values.set(from.values.subarray(first + width * start, first + width * stop), place);
  }
}
