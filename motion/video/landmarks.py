"""The 33 points that MediaPipe's pose network finds on a body, and what they say about SMPL22's joints."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

POINTS = (
    "nose",
    "left_eye_inner",
    "left_eye",
    "left_eye_outer",
    "right_eye_inner",
    "right_eye",
    "right_eye_outer",
    "left_ear",
    "right_ear",
    "mouth_left",
    "mouth_right",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "left_pinky",
    "right_pinky",
    "left_index",
    "right_index",
    "left_thumb",
    "right_thumb",
    "left_hip",
    "right_hip",
    "left_knee",
    "right_knee",
    "left_ankle",
    "right_ankle",
    "left_heel",
    "right_heel",
    "left_foot_index",
    "right_foot_index",
)
"""Names in the network's order (Bazarevsky et al., BlazePose, 2020)."""
INDEX = {name: index for index, name in enumerate(POINTS)}
TORSO = [INDEX[name] for name in ("left_shoulder", "right_shoulder", "left_hip", "right_hip")]
LIMBS = [
    INDEX[f"{side}_{part}"]
    for part in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in ("left", "right")
]


@dataclass(frozen=True, eq=False)
class Landmarks:
    """The poses found in the pictures of a film, in any order within a picture.

    Attributes:
        width, height: of the film in pixels.
        times: (F,) seconds of the pictures that were looked at, increasing.
        frames: (N,) index of the picture of each pose.
        world: (N, 33, 3) metres about the middle of the hips, as the network gives them: x to the right of
            the picture, y down, z away from the camera.
        image: (N, 33, 2) shares of the picture's width and height from its upper left corner.
        seen: (N, 33) 0 to 1, how surely a point is visible.
    """

    width: int
    height: int
    times: Array
    frames: NDArray[np.integer]
    world: Array = field(repr=False)
    image: Array = field(repr=False)
    seen: Array = field(repr=False)

    @property
    def pixels(self) -> Array:
        """(N, 33, 2) pixels from the upper left corner."""
        return self.image * np.array([self.width, self.height])
