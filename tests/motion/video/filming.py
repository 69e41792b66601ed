"""Films a known motion with a pinhole camera: the landmarks that a perfect pose network would find."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np

from motion import SMPL22
from motion.kinematics import fit_rotations, forward_kinematics
from motion.video import Landmarks
from motion.video.landmarks import POINTS
from motion.video.person import LAYOUT
from motion.video.place import focal_length

J = {name: i for i, name in enumerate(SMPL22.joint_names)}
SIZE = (1280, 720)
RATE = 15.0


def stepping(seconds: float = 3.0, *, speed: float = 0.0, heading: float = 0.0) -> np.ndarray:
    """(T, 22, 3) at 15 fps: a person who waves, and walks at a speed where one is given, with feet that stand."""
    frames = round(seconds * RATE)
    t = np.arange(frames) / RATE
    pose = np.tile(SMPL22.rest_positions(), (frames, 1, 1))
    for side, sign in (("left", 1), ("right", -1)):  # hanging arms
        shoulder = pose[:, J[f"{side}_shoulder"]]
        pose[:, J[f"{side}_elbow"]] = shoulder + np.array([0.05 * sign, -0.25, 0.02])
        pose[:, J[f"{side}_wrist"]] = shoulder + np.array([0.08 * sign, -0.49, 0.10])
    lift = 0.5 + 0.4 * np.sin(2 * np.pi * 0.7 * t)
    elbow = pose[:, J["right_elbow"]]
    pose[:, J["right_wrist"]] = elbow + 0.26 * np.stack([0 * t, np.sin(3 * lift - 1.5), np.cos(3 * lift - 1.5)], -1)
    if speed:
        stride = 0.5 * speed  # metres a step of half a second
        for side, phase in (("left", 0.0), ("right", 0.5)):
            share = (t + phase) % 1.0
            swing = np.where(share < 0.5, 0.5 - 2 * share, 2 * share - 1.5) * stride
            up = 0.1 * np.sin(np.pi * np.clip(2 * share - 1, 0, 1))
            for part in ("ankle", "foot"):
                pose[:, J[f"{side}_{part}"], 2] += swing
                pose[:, J[f"{side}_{part}"], 1] += up
            pose[:, J[f"{side}_knee"], 2] += swing / 2 + 0.08
            pose[:, J[f"{side}_knee"], 1] += up / 2
    pose = forward_kinematics(fit_rotations(pose), pose[:, 0])
    pose[..., 2] += (speed * t)[:, None]
    sin, cos = np.sin(heading), np.cos(heading)
    pose = pose @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    pose[..., 1] -= pose[..., 1].min()
    return pose


def film(
    person: np.ndarray, *, tilt: float = 10.0, distance: float = 4.0, noise: float = 0.0, face: float | None = None
) -> Landmarks:
    """The landmarks of a person (T, 22, 3) about the world's origin, at which the camera looks at hip height.

    Args:
        distance: metres over the floor from the camera to the origin.
        tilt: degrees by which the camera looks down.
        noise: metres by which depth is off, a tenth of that across.
        face: radians from +Z towards +X to which the face points; by default nose and ears are in one place.
    """
    height = 0.95 + distance * np.tan(np.radians(tilt))
    rng = np.random.default_rng(0)
    focal = focal_length(*SIZE)
    sin, cos = np.sin(np.radians(tilt)), np.cos(np.radians(tilt))
    to_camera = np.array([[1, 0, 0], [0, -cos, -sin], [0, sin, -cos]]).T
    frames = len(person)
    world, image = [], []
    for pose in person:
        points = points_of(pose)
        if face is not None:
            put_face(points, face)
        seen = (points - [0, height, distance]) @ to_camera.T
        seen += noise * rng.normal(size=seen.shape) * [0.1, 0.1, 1.0]
        middle = (seen[23] + seen[24]) / 2
        world.append((seen - middle) @ onto(middle / np.linalg.norm(middle)))
        image.append((seen[:, :2] / seen[:, 2:] * focal + np.array(SIZE) / 2) / SIZE)
    all_seen = np.ones((frames, len(POINTS)))
    return Landmarks(*SIZE, np.arange(frames) / RATE, np.arange(frames), np.array(world), np.array(image), all_seen)


def onto(sight: np.ndarray) -> np.ndarray:
    """(3, 3) rotation from (0, 0, 1) to a direction."""
    x, y, z = sight
    s = 1 / (1 + z)
    return np.array([[1 - x * x * s, -x * y * s, x], [-x * y * s, 1 - y * y * s, y], [-x, -y, z]])


def points_of(joints: np.ndarray) -> np.ndarray:
    """(33, 3) points of a pose (22, 3), where the network sees them on the body of :data:`LAYOUT`."""
    rotations = fit_rotations(joints)
    body = type(SMPL22)("seen", SMPL22.joint_names, SMPL22.parents, LAYOUT.offsets)
    seen = forward_kinematics(rotations, joints[0], body)
    points = np.tile(seen[J["head"]], (33, 1))
    for i, name in enumerate(POINTS):
        name = name.replace("foot_index", "foot").replace("heel", "ankle")
        for finger in ("pinky", "index", "thumb"):
            name = name.replace(finger, "wrist")
        if name in J:
            points[i] = seen[J[name]]
    return points


def put_face(points: np.ndarray, angle: float) -> None:
    """Puts nose and ears of points (33, 3) where a face has them that points to an angle from +Z towards +X."""
    sin, cos = np.sin(angle), np.cos(angle)
    points[POINTS.index("nose")] += 0.11 * np.array([sin, 0, cos])
    for ear, sign in (("left_ear", 1), ("right_ear", -1)):
        points[POINTS.index(ear)] += 0.07 * sign * np.array([cos, 0, -sin])


def packed(landmarks: Landmarks, **known: Any) -> str:
    """The text that the browser would send."""

    def encode(values: np.ndarray, kind: str) -> str:
        return base64.b64encode(np.rint(values).astype(kind).tobytes()).decode()

    counts = np.bincount(landmarks.frames, minlength=len(landmarks.times))
    return json.dumps(
        {
            "landmarks": 1,
            "width": landmarks.width,
            "height": landmarks.height,
            "times": encode(1000 * landmarks.times, "<u4"),
            "counts": encode(counts, "u1"),
            "world": encode(1000 * landmarks.world, "<i2"),
            "image": encode(8000 * landmarks.image, "<i2"),
            "seen": encode(255 * landmarks.seen, "u1"),
            **known,
        }
    )
