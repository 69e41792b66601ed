// The page's side of the pose worker.

const LONGEST_SIDE = 960; // pixels of what is looked at: more costs time and finds nothing more

let shared = null; // one for the page: it takes a second to load and 100 MB

/** The page's detector. */
export const detector = () => (shared ??= new Detector());

class Detector {
  constructor() {
    this.waiting = new Map();
    this.number = 0;
    this.opened = null;
  }

  /** Loads the network at the first call. Follows one person from now on and nobody of before. */
  async begin() {
    this.opened ??= this._open().catch((error) => {
      this.close();
      throw error;
    });
    await this.opened;
    await this._ask({ job: "begin" });
  }

  /** The people in a video's present picture, none or one, at a time in seconds. */
  async detect(source, time) {
    const [width, height] = [source.videoWidth || source.width, source.videoHeight || source.height];
    const scale = Math.min(1, LONGEST_SIDE / Math.max(width, height));
    const size = { resizeWidth: Math.round(width * scale), resizeHeight: Math.round(height * scale) };
    const picture = await createImageBitmap(source, 0, 0, width, height, scale < 1 ? size : {});
    return this._ask({ job: "detect", picture, time: 1000 * time }, [picture]);
  }

  close() {
    this.worker?.terminate();
    this.worker = null;
    this.opened = null;
    for (const { reject } of this.waiting.values()) reject(new Error("closed"));
    this.waiting.clear();
  }

  async _open() {
    this.worker = new Worker(new URL("pose_worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => {
      const { resolve, reject } = this.waiting.get(data.id) ?? {};
      this.waiting.delete(data.id);
      if (data.error === undefined) resolve?.(data.answer);
      else reject?.(new Error(data.error));
    };
    this.worker.onerror = () => this.close();
    await this._ask({ job: "open" });
  }

  _ask(message, transfer = []) {
    const id = ++this.number;
    return new Promise((resolve, reject) => {
      if (!this.worker) return reject(new Error("closed"));
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ ...message, id }, transfer);
    });
  }
}
