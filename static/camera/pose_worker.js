// Finds people in pictures, off the page's thread: MediaPipe's pose landmarker on the processor.

// The library reports how it is used to its maker, once a minute. Here only this server is asked for anything.
const fetchHere = self.fetch.bind(self);
self.fetch = (resource, options) =>
  new URL(resource.url ?? resource, self.location.href).origin === self.location.origin
    ? fetchHere(resource, options)
    : Promise.reject(new TypeError("Only this server is asked."));

// Of 1. The detector sees a small copy of the picture and doubts people who fill half its height; what it found
// wrongly is dropped by the landmarks' presence.
const SURE = { minPoseDetectionConfidence: 0.1, minPosePresenceConfidence: 0.3, minTrackingConfidence: 0.3 };
let landmarker = null;
let latest = 0; // milliseconds: the library wants every time to be later than the one before
let offset = 0;

async function open() {
  const { PoseLandmarker } = await import("./mediapipe/vision_bundle.mjs");
  const folder = new URL("mediapipe/", import.meta.url).href;
  const fileset = {
    wasmLoaderPath: `${folder}vision_wasm_module_internal.js`,
    wasmBinaryPath: `${folder}vision_wasm_module_internal.wasm`,
  };
  landmarker = await PoseLandmarker.createFromOptions(fileset, {
    baseOptions: { modelAssetPath: `${folder}pose_landmarker_lite.task`, delegate: "CPU" },
    runningMode: "VIDEO",
    numPoses: 1,
    ...SURE,
  });
}

/** Forgets whom it followed. */
async function begin() {
  await landmarker.setOptions({ numPoses: 1, runningMode: "VIDEO" });
  offset = latest + 1000;
}

function detect({ picture, time }) {
  latest = Math.max(latest + 1, offset + Math.round(time));
  const found = landmarker.detectForVideo(picture, latest);
  picture.close();
  return found.landmarks.map((points, person) => ({
    image: points.map(({ x, y }) => [x, y]),
    seen: points.map(({ visibility }) => visibility),
    world: found.worldLandmarks[person].map(({ x, y, z }) => [x, y, z]),
  }));
}

const jobs = { open, begin, detect };

self.onmessage = async ({ data }) => {
  try {
    self.postMessage({ id: data.id, answer: await jobs[data.job](data) });
  } catch (error) {
    self.postMessage({ id: data.id, error: String(error?.message ?? error) });
  }
};
