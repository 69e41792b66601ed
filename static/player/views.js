// Camera presets, told from where the two people stand.

import { FIELD_OF_VIEW } from "./orbit.js";

const BODY_HEIGHT = 2.45; // metres that must fit from floor to above the names
const SIDE_ROOM = 1.5; // metres beside the outermost pelvis
const LOOK_AT = { wide: 0.92, tall: 0.74 }; // metres; tall stages keep their tools under the feet
const WIDEST = 8; // metres; people farther apart than this are not kept in view together

/** The point the camera follows: between the pelvises, at a height that does not bob. */
export function midpoint(pose, skeleton, aspect) {
  const spots = pose.map((points) => points[skeleton.pelvis]);
  return [0, 1].map((i) => spots.reduce((sum, p) => sum + p[i], 0) / spots.length).concat(aspect < 1.1 ? LOOK_AT.tall : LOOK_AT.wide);
}

/** Angle of the line from A to B on the floor; of the way A faces where there is nobody else. */
export function heading(pose, skeleton) {
  const [a, b] = pose.map((points) => points[skeleton.pelvis]);
  if (b && Math.hypot(b[0] - a[0], b[1] - a[1]) > 0.05) return Math.atan2(b[1] - a[1], b[0] - a[0]);
  const [left, right] = skeleton.hips.map((j) => pose[0][j]);
  if (!left || !right) return 0;
  // The left hip lies a quarter turn anticlockwise (seen from above) of where the body faces.
  return Math.atan2(left[1] - right[1], left[0] - right[0]) - Math.PI / 2;
}

/** How far apart the pelvises of a pair stand on the floor, the widest of several; metres, 0 for one person. */
export function apart(pose, skeleton) {
  const spots = pose.map((points) => points[skeleton.pelvis]);
  const gaps = spots.map((b, i) => (i % 2 ? Math.hypot(b[0] - spots[i - 1][0], b[1] - spots[i - 1][1]) : 0));
  return Math.min(Math.max(...gaps), WIDEST);
}

/** Yaw, elevation and distance of a preset. */
export function preset(name, { along, apart: gap, aspect }) {
  const tangent = 2 * Math.tan(FIELD_OF_VIEW / 2);
  const fit = (across) => Math.max(BODY_HEIGHT / tangent, (across + SIDE_ROOM) / (tangent * aspect)) + across / 6;
  switch (name) {
    case "front": return { yaw: along, elevation: 0.16, distance: BODY_HEIGHT / tangent + gap / 2 + 0.6 };
    case "side": return { yaw: along - Math.PI / 2, elevation: 0.1, distance: fit(gap) };
    case "top": return { yaw: along - Math.PI / 2, elevation: 1.48, distance: Math.max(fit(gap), 4) + 0.5 };
    case "a": return { yaw: along + Math.PI + 0.4, elevation: 0.3, distance: gap / 2 + 2.7 };
    case "b": return { yaw: along - 0.4, elevation: 0.3, distance: gap / 2 + 2.7 };
    default: return { yaw: along - 1.05, elevation: 0.24, distance: fit(gap * 0.9) };
  }
}
