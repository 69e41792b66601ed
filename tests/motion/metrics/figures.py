"""Bodies for the rules of sentences: two who stand, and edits of what they do."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motion import SMPL22
from motion.metrics.sentences.joints import Motion

FPS, FRAMES = 30.0, 120
Edit = Callable[[np.ndarray], None]
Place = tuple[float, float, float]


def index(name: str) -> int:
    return SMPL22.index(name)


def duet(*edits: Edit, gap: float = 2.0) -> Motion:
    """a at the origin, looking along +Z, b ``gap`` metres ahead and looking back, arms hanging; edits change a."""
    body = SMPL22.rest_positions() + np.array([0.0, 0.96, 0.0])
    for side in ("left", "right"):
        shoulder = body[index(f"{side}_shoulder")]
        body[index(f"{side}_elbow")] = shoulder + np.array([0, -0.27, 0])
        body[index(f"{side}_wrist")] = shoulder + np.array([0, -0.52, 0.05])
        body[index(f"{side}_ankle"), 1], body[index(f"{side}_foot"), 1] = 0.08, 0.02
    both = np.repeat(np.stack([body, body * [-1, 1, -1] + [0, 0, gap]])[:, None], FRAMES, axis=1)
    for edit in edits:
        edit(both)
    return Motion(both, FPS)


def put(name: str, place: Place, who: int = 0, base: str = "pelvis") -> Edit:
    """Moves a joint to a place relative to another joint of the same body, which must look along +Z."""

    def edit(both: np.ndarray) -> None:
        both[who, :, index(name)] = both[who, :, index(base)] + place

    return edit


def each(part: str, place: Place, base: str = "pelvis", who: int = 0) -> list[Edit]:
    """Both joints of a part at a place, the left one's x as given and the right one's mirrored."""
    x, y, z = place
    bases = [base if base in SMPL22.joint_names else f"{side}_{base}" for side in ("left", "right")]
    return [put(f"left_{part}", (x, y, z), who, bases[0]), put(f"right_{part}", (-x, y, z), who, bases[1])]


def tilt(degrees: float, towards: tuple[float, float]) -> Edit:
    """Leans a's trunk: the neck goes over the floor along (X, Z)."""

    def edit(both: np.ndarray) -> None:
        neck = both[0, :, index("neck")]
        neck[:, [0, 2]] = both[0, :, 0][:, [0, 2]] + np.tan(np.radians(degrees)) * (
            neck[:, 1:2] - both[0, :, 0, 1:2]
        ) * np.array(towards)

    return edit


def spin(degrees: float, who: int = 0) -> Edit:
    """Turns a body about its pelvis to the left, evenly over the whole motion."""

    def edit(both: np.ndarray) -> None:
        angle = np.radians(np.linspace(0, degrees, FRAMES))[:, None]
        root = both[who, :, :1] * [1, 0, 1]
        x, y, z = np.moveaxis(both[who] - root, -1, 0)
        turned = [x * np.cos(angle) + z * np.sin(angle), y, z * np.cos(angle) - x * np.sin(angle)]
        both[who] = np.stack(turned, axis=-1) + root

    return edit


def shift(start: Place, stop: Place, who: int = 0) -> Edit:
    """Moves a whole body evenly from one offset to another."""

    def edit(both: np.ndarray) -> None:
        both[who] += np.linspace(start, stop, FRAMES)[:, None]

    return edit


def swing(who: int, side: str, lag: float = 0.0) -> Edit:
    """A wrist goes up and down along a path that does not repeat, ``lag`` seconds late."""

    def edit(both: np.ndarray) -> None:
        t = np.arange(FRAMES) / FPS - lag
        both[who, :, index(f"{side}_wrist"), 1] += 0.3 * np.sin(2.0 * t**2 * np.sign(t)) + 0.3
        both[who, :, index(f"{side}_elbow"), 1] += 0.15 * np.sin(2.0 * t**2 * np.sign(t)) + 0.15

    return edit


def rise(both: np.ndarray) -> None:
    for side in ("left", "right"):
        both[0, 60:, index(f"{side}_ankle"), 1] += 0.08


def elbow_on(both: np.ndarray) -> None:
    both[0, :, index("left_elbow")] = both[1, :, index("right_shoulder")] + [0, 0.1, 0]
