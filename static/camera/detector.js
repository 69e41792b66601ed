// The page's side of the pose worker.

const LONGEST_SIDE = 960; // pixels of what is looked at: more costs time and finds nothing more

const shared = new Map(); // two for the page, the second for a second person: each takes a second to load and 100 MB

/** The page's two detectors with MediaPipe's files at an address. */
export function detectorsOf(folder) {
  if (!shared.has(folder)) shared.set(folder, [new Detector(folder), new Detector(folder)]);
  return shared.get(folder);
}

export class Detector {
  /** `folder` is the address of MediaPipe's files, with a slash at its end. */
  constructor(folder) {
    this.folder = folder;
    this.waiting = new Map();
    this.number = 0;
    this.opened = null;
  }

  /**
   * Loads the network at the first call. Follows as many people from now on and nobody of before; pictures that are
   * `still` have nothing to do with each other.
   */
  async begin(people, { still = false } = {}) {
    this.opened ??= this._open(people).catch((error) => {
      this.close();
      throw error;
    });
    await this.opened;
    await this._ask({ job: "begin", people, still });
  }

  /** The people in a video's present picture, or in a window [x, y, width, height] of it, at a time in seconds. */
  async detect(source, time, window = null) {
    const [all, tall] = [source.videoWidth || source.width, source.videoHeight || source.height];
    const [x, y, width, height] = (window ?? [0, 0, all, tall]).map(Math.round);
    const scale = Math.min(1, LONGEST_SIDE / Math.max(width, height));
    const size = { resizeWidth: Math.round(width * scale), resizeHeight: Math.round(height * scale) };
    const picture = await createImageBitmap(source, x, y, width, height, scale < 1 ? size : {});
    const found = await this._ask({ job: "detect", picture, time: 1000 * time }, [picture]);
    return found.map((person) => ({
      ...person,
      image: person.image.map(([u, v]) => [(x + u * width) / all, (y + v * height) / tall]),
    }));
  }

  close() {
    this.worker?.terminate();
    this.worker = null;
    this.opened = null;
    for (const { reject } of this.waiting.values()) reject(new Error("closed"));
    this.waiting.clear();
  }

  async _open(people) {
    this.worker = new Worker(new URL("pose_worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => {
      const { resolve, reject } = this.waiting.get(data.id) ?? {};
      this.waiting.delete(data.id);
      if (data.error === undefined) resolve?.(data.answer);
      else reject?.(new Error(data.error));
    };
    this.worker.onerror = () => this.close();
    await this._ask({ job: "open", folder: this.folder, people });
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
