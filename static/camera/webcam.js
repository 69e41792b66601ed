// The webcam: its picture, and a recording of it.

import { FilmError, LONGEST } from "./film.js";
import { say } from "../texts.js";

const KINDS = ["video/webm;codecs=vp8", "video/webm", "video/mp4"];
const COUNTDOWN = 3; // seconds

/** Opens the webcam in a video element; throws a FilmError where there is none or it may not be used. */
export async function openWebcam(video) {
  if (!navigator.mediaDevices?.getUserMedia)
    throw new FilmError(say("camera.insecure"));
  let stream;
  try {
    stream = await navigator.mediaDevices.getUserMedia({
      audio: false,
      video: { width: { ideal: 1280 }, height: { ideal: 720 }, frameRate: { ideal: 30 } },
    });
  } catch (error) {
    if (error.name === "NotAllowedError") throw new FilmError(say("camera.refused"));
    if (error.name === "NotFoundError") throw new FilmError(say("camera.none"));
    throw new FilmError(say("camera.in_use"));
  }
  video.srcObject = stream;
  await video.play();
}

/** Lets go of the webcam. */
export function closeWebcam(video) {
  for (const track of video.srcObject?.getTracks() ?? []) track.stop();
  video.srcObject = null;
}

/** Counts down; `show(seconds)` hears of each second, `stopped()` says whether to stop. Whether it ended well. */
export async function countDown(show, stopped) {
  for (let left = COUNTDOWN; left > 0; left--) {
    show(left);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    if (stopped()) return false;
  }
  show(0);
  return true;
}

/** Records a stream until `stop()` of what is returned, at most as long as a film may be; `film` is a promise of the file. */
export function record(stream) {
  const kind = KINDS.find((name) => MediaRecorder.isTypeSupported(name));
  const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: 4e6 });
  const parts = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const film = new Promise((resolve) => {
    recorder.onstop = () => resolve(new File(parts, "webcam", { type: recorder.mimeType.split(";")[0] }));
  });
  const end = setTimeout(() => stop(), 1000 * LONGEST);
  const stop = () => {
    clearTimeout(end);
    if (recorder.state !== "inactive") recorder.stop();
  };
  stream.getVideoTracks()[0]?.addEventListener("ended", stop);
  recorder.start(1000);
  return { film, stop };
}
