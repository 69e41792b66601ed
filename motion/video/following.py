"""A filmed person, picture by picture: what :mod:`.person` does for a film, without the pictures to come.

The first pictures measure the body and by how much the camera looks down; from then on every picture gives a pose at
once. Noise is filtered by the 1 € filter (Casiez et al., 2012), which lags little while somebody moves fast.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from motion.clip import FPS
from motion.ik import pose_bodies
from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22, TOES
from motion.vectors import FLAT, Array

from .landmarks import INDEX, Landmarks
from .person import LAYOUT, TILTS, Track, in_camera, layout_points
from .place import body_tilt, upright

MEASURED = 8
"""Pictures with a person that come before the first pose."""
_SEEN = 0.5
"""A point that is seen less surely than this counts as hidden, and a nose is turned away."""
_POSE = (2.5, 3.0)
"""1 € filter of the joints about the pelvis: lowest cut-off in Hz, and its growth with the speed in m/s."""
_PATH = (1.2, 1.0)
"""The same for the path of the pelvis, whose depth is uncertain."""
_FLOOR = 45
"""Pictures over which the lowest place of the feet is the floor."""
_UP = np.diag([1.0, -1.0, -1.0])
"""From a camera's axes, y down and z away from it, to y up and z towards it."""
_LEGS = [INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("knee", "ankle")]


class OneEuro:
    """The 1 € filter on an array of values.

    Args:
        lowest: cut-off frequency in Hz of values that rest.
        slope: growth of the cut-off with the speed of the values.
    """

    def __init__(self, lowest: float, slope: float) -> None:
        self.lowest, self.slope = lowest, slope
        self._value: Array | None = None
        self._speed: Array = np.zeros(1)

    def __call__(self, value: Array, seconds: float) -> Array:
        """The filtered value, ``seconds`` after the one before."""
        if self._value is None:
            self._value, self._speed = value, np.zeros_like(value)
            return value
        seconds = max(seconds, 1e-3)
        speed = (value - self._value) / seconds
        self._speed = self._speed + _share(1.0, seconds) * (speed - self._speed)
        pace = np.linalg.norm(self._speed, axis=-1, keepdims=True)
        share = _share(self.lowest + self.slope * pace, seconds)
        self._value = self._value + share * (value - self._value)
        return self._value


def _share(cutoff: Array | float, seconds: float) -> Array:
    """Share of a new value in an exponential filter of a cut-off frequency."""
    return 1 / (1 + 1 / (2 * np.pi * np.asarray(cutoff) * seconds))


class FollowedPerson:
    """Turns the landmarks of one person into poses, one picture after the other.

    Attributes:
        gaze: of the last picture with a pose; None where the points do not tell.
        tilt: degrees by which the camera looks down, as the first pictures say.
    """

    def __init__(self) -> None:
        self.tilt = 0.0
        self._measured: list[tuple[Array, Array]] = []
        self._turn: Array | None = None
        self._body = SMPL22
        self._size = 1.0
        self._pose, self._path = OneEuro(*_POSE), OneEuro(*_PATH)
        self._low: deque[float] = deque(maxlen=_FLOOR)
        self._origin = np.zeros(3)
        self._last: float | None = None
        self.seen = 0.0
        self.gaze: Gaze | None = None

    @property
    def hint(self) -> str:
        """A sentence about what the camera should see better; empty where it sees enough."""
        if self._last is None:
            return ""
        return "Step back until you are seen from head to feet." if self.seen < _SEEN else ""

    def add(self, landmarks: Landmarks, picture: int) -> Array | None:
        """The pose (22, 3) in metres, Y up, floor at 0; None while nobody is found or measured.

        Args:
            landmarks: of one picture or more.
            picture: index of the picture; its time must be later than that of the one before.
        """
        time = float(landmarks.times[picture])
        poses = np.flatnonzero(landmarks.frames == picture)
        if not len(poses):
            return None
        one = Track(FPS, *(values[poses[:1]] for values in (landmarks.world, landmarks.pixels, landmarks.seen)))
        seen = one.seen[0]
        before = time if self._last is None else self._last
        self._last = time
        self.seen = float(seen[_LEGS].mean())
        try:
            points = in_camera(one, landmarks)[0]
            if self._turn is None:
                self._measure(points, seen)
                return None
            pose = self._finished(points, seen, time - before, self._turn)
        except np.linalg.LinAlgError:  # all points in one place
            return None
        self.gaze = gaze(points, seen, self._turn @ _UP)
        return pose if np.isfinite(pose).all() else None

    def _measure(self, points: Array, seen: Array) -> None:
        """Keeps a picture for the measuring of body and tilt, and measures once there are enough."""
        self._measured.append((points, seen))
        if len(self._measured) < MEASURED:
            return
        stack, trust = (np.stack(values) for values in zip(*self._measured, strict=True))
        self.tilt = float(np.clip(np.degrees(body_tilt(stack, trust)), *TILTS))
        self._turn = upright(np.radians(self.tilt)) @ _UP
        chosen, _ = layout_points(stack, trust)
        _, root, self._body, self._size = pose_bodies(chosen, LAYOUT)
        self._origin = np.asarray(root[-1] @ self._turn.T / self._size) * FLAT
        self._measured.clear()

    def _finished(self, points: Array, seen: Array, seconds: float, turn: Array) -> Array:
        """A pose on SMPL22's bones in the world."""
        chosen, _ = layout_points(points[None], seen[None])
        rotations, root, _, _ = pose_bodies(chosen, LAYOUT, body=self._body)
        posed = forward_kinematics(rotations, root / self._size, SMPL22)[0] @ turn.T
        path = self._path(posed[:1] - self._origin, seconds)
        posed = self._pose(posed - posed[:1], seconds) + path
        self._low.append(float(posed[TOES, 1].min()))
        posed[:, 1] -= float(np.percentile(self._low, 20))
        return posed


# ---- The direction of a face, from ears and nose, the only points of a head that the pose network finds --------------
_NOSE, _EARS = INDEX["nose"], [INDEX["left_ear"], INDEX["right_ear"]]
_LEAST = 0.03
"""Metres from between the ears to the nose, over the floor, below which a face points nowhere."""


@dataclass(frozen=True, eq=False)
class Gaze:
    """The direction of a face over the floor.

    Attributes:
        ahead: (3,) unit vector in the world of the poses, with no part along Y; zero for a face that is not seen.
        camera: cosine of the angle between it and the way to the camera; -1 for a face that is not seen.
    """

    ahead: Array
    camera: float

    def towards(self, way: Array) -> float:
        """Cosine of the angle between the face and a way (3,) over the floor; 0 where one of them points nowhere."""
        length = float(np.linalg.norm(way * FLAT))
        return float(self.ahead @ way) / length if length > 1e-6 else 0.0


HIDDEN = Gaze(np.zeros(3), -1.0)
"""Of a face that is turned away from the camera."""


def gaze(points: Array, seen: Array, turn: Array) -> Gaze | None:
    """The gaze of one person; None where the points do not tell.

    Args:
        points: (33, 3) metres along the camera's axes, the camera at the origin.
        seen: (33,) how surely they are seen.
        turn: (3, 3) from the camera's axes to the world's.
    """
    if seen[_NOSE] < _SEEN:
        return HIDDEN
    middle = points[_EARS].mean(axis=0)
    ahead = (points[_NOSE] - middle) @ turn.T * FLAT
    length = float(np.linalg.norm(ahead))
    if not length > _LEAST:
        return None
    way = -middle @ turn.T * FLAT
    ahead = ahead / length
    return Gaze(ahead, Gaze(ahead, 0.0).towards(way))
