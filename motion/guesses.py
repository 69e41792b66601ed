"""The way up in a file: the one check of all formats, with its sign.

People stand most of the time, so the axis from their ankles to their shoulders is up. A format has a usual axis as
well, and a BVH the one along which its rest pose stands. Where the two differ, the floor decides: of a person who
stands on the floor at 0 the body is believed, of one who lies on it the format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .clip import Clip
from .rigs import RigMotion
from .skeleton import LAYOUTS, POINTS17, SKELETONS, SMPL22, Skeleton
from .vectors import Array, unit

Places = Mapping[str, Array]
"""(T, 3) of the joints that a person has, by SMPL22's names, in the file's axes and unit."""

AXES = ("x", "y", "z", "-x", "-y", "-z")
"""What points up: "-y" is an axis that points down, as in a camera's frame."""
_FRAMES = 400
"""So many, spread over the motion, tell enough."""
_CLEAR = 0.8
"""Share of the way from ankles to shoulders that lies along one axis where people stand."""
_LONG = 0.8
"""Length of that way over the legs', of people who stand."""
# Heights over the length of the legs.
_ANKLES, _PELVIS = (-0.15, 0.3), (0.7, 1.4)
_LYING = (-0.08, 0.3)
_WALKED, _LEVEL = 0.5, 0.15


def places_of(motion: Clip | RigMotion) -> dict[str, Array]:
    """The joints of a person by SMPL22's names.

    Raises:
        InputError: if no human body is found in a rig.
    """
    positions = motion.positions
    if isinstance(motion, Clip):
        joints = LAYOUTS[motion.skeleton.name].joints
        return {SMPL22.joint_names[ours]: positions[:, its] for its, ours in enumerate(joints) if ours >= 0}
    return {name: positions[:, joint] for name, joint in motion.parts.joints.items()}


def leg_length(places: Places) -> float:
    """The median length of a person's thighs and shins together, the mean of both legs."""
    bones = [
        np.linalg.norm(places[f"{side}_{upper}"] - places[f"{side}_{lower}"], axis=-1)
        for side in ("left", "right")
        for upper, lower in (("hip", "knee"), ("knee", "ankle"))
    ]
    return float(np.median(bones, axis=-1).sum()) / 2


def turn_of(up: str) -> Array:
    """(3, 3) rotation that turns an axis of :data:`AXES` to Y."""
    sign = -1.0 if up[0] == "-" else 1.0
    if up[-1] == "y":
        return np.diag([1.0, sign, sign])
    if up[-1] == "z":
        return np.array([[1.0, 0, 0], [0, 0, sign], [0, -sign, 0]])
    return np.array([[0, -sign, 0], [sign, 0, 0], [0, 0, 1.0]])


def find_up(people: Sequence[Places], usual: str, *, firm: bool = False) -> str:
    """The axis that points up for all people of one world.

    Args:
        people: everybody.
        usual: the axis that their kind of file takes, or along which their rest pose stands.
        firm: where the floor does not tell, the usual axis is believed and not the body.
    """
    bodies = [_Body(places) for places in people]
    standing = [(body, axis) for body in bodies if (axis := body.axis)]
    if not standing or any(axis == usual for _, axis in standing):
        return usual
    for body, axis in standing:
        if body.stands_on_floor(axis):
            return axis
    if any(body.lies_on_floor(usual) for body in bodies):
        return usual
    body, axis = standing[0]
    turned_over = axis[-1] == usual[-1]
    return axis if not firm or turned_over or body.walks(axis) else usual


def axis_of(way: Array) -> str:
    """The axis of :data:`AXES` nearest to a vector (3,)."""
    largest = int(np.argmax(np.abs(way)))
    return ("-" if way[largest] < 0 else "") + "xyz"[largest]


class _Body:
    """Evidence of the way up in a person's joints."""

    def __init__(self, places: Places) -> None:
        count = len(places["left_hip"])
        some = np.unique(np.linspace(0, count - 1, min(count, _FRAMES)).astype(int))
        at = {name: np.asarray(place[some], dtype=np.float64) for name, place in places.items()}
        self.leg = max(leg_length(at), 1e-9)
        self.ankles = np.stack([at["left_ankle"], at["right_ankle"]], axis=1)
        self.pelvis: Array = (at["left_hip"] + at["right_hip"]) / 2
        self.joints = np.stack(list(at.values()), axis=1)
        shoulders: Array = (at["left_shoulder"] + at["right_shoulder"]) / 2
        self.tall = np.median(shoulders - self.ankles.mean(axis=1), axis=0)

    @property
    def axis(self) -> str:
        """The axis along which the person stands; empty for one who does not."""
        way, long = axis_of(self.tall), float(np.linalg.norm(self.tall))
        share = float(np.abs(self.tall).max()) / max(long, 1e-9)
        return way if share > _CLEAR and long > _LONG * self.leg else ""

    def _heights(self, places: Array, up: str) -> Array:
        """(T, …) along an axis, over the length of the legs."""
        return (-1.0 if up[0] == "-" else 1.0) * places[..., "xyz".index(up[-1])] / self.leg

    def stands_on_floor(self, up: str) -> bool:
        """True if the ankles are at the height of ankles over the floor at 0, and the pelvis is at its own."""
        ankles = float(np.quantile(self._heights(self.ankles, up).min(axis=1), 0.1))
        pelvis = float(np.median(self._heights(self.pelvis, up)))
        return _ANKLES[0] <= ankles <= _ANKLES[1] and _PELVIS[0] <= pelvis <= _PELVIS[1]

    def lies_on_floor(self, up: str) -> bool:
        """True if the lowest joint is just above the floor at 0 nearly all the time, as of somebody who lies there."""
        low, high = np.quantile(self._heights(self.joints, up).min(axis=1), (0.1, 0.9))
        return bool(_LYING[0] <= low and high <= _LYING[1])

    def walks(self, up: str) -> bool:
        """True if the body goes over a floor on which one foot or the other stands."""
        low, high = np.quantile(self._heights(self.ankles, up).min(axis=1), (0.1, 0.9))
        across = [axis for axis in range(3) if axis != "xyz".index(up[-1])]
        way = np.linalg.norm(np.ptp(self.pelvis[:, across], axis=0)) / self.leg
        return bool(high - low < _LEVEL and way > _WALKED)


# ---- Calibration poses -----------------------------------------------------------------------------------------------
_LIMBS = (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist"))
_LONGEST = 3.0
"""Seconds for which the pose is held, at most."""
_JUMP, _STILL = 6.0, 0.5
"""Metres a second against the pelvis, of an adult: of the jump at least, and of the pose before it at most."""
_ABRUPT = 4.0
"""So many times as fast as anything after it is the jump."""
_STRAIGHT = 0.95
_LEG = 0.81
"""Metres: an adult's."""


def calibration_frames(places: Places, fps: float) -> int:
    """Number of first frames of a motion that hold a pose of straight limbs which the next one jumps from; 0 for none.

    Args:
        places: (T, 3) of a person's joints, in any unit.
        fps: frames a second.
    """
    limbs = [[places[f"{side}_{part}"] for part in limb] for limb in _LIMBS for side in ("left", "right")]
    joints = np.stack([joint for limb in limbs for joint in limb], axis=1).astype(np.float64)
    joints -= (joints[:, :1] + joints[:, 3:4]) / 2
    leg = float(np.median(np.linalg.norm(np.diff(joints[:, :3], axis=1), axis=-1).sum(axis=1)))
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=-1).max(axis=1, initial=0.0) * fps * _LEG / max(leg, 1e-9)
    if len(speed) < 4:
        return 0
    jump = int(np.argmax(speed[: max(1, round(_LONGEST * fps))]))
    after = speed[jump + 1 :].max(initial=0.0)
    abrupt = speed[jump] > max(_JUMP, _ABRUPT * after) and speed[:jump].max(initial=0.0) < _STILL
    if not abrupt or len(speed) - jump < 4:
        return 0
    bones = joints[jump].reshape(-1, 3, 3)
    reach = np.linalg.norm(bones[:, 2] - bones[:, 0], axis=-1)
    lengths = np.linalg.norm(np.diff(bones, axis=1), axis=-1).sum(axis=1)
    return jump + 1 if (reach > _STRAIGHT * lengths).all() else 0


# ---- Finds the joint order of an array without joint names from its number of joints and its bones ------------------
_SAMPLED = 200
"""So many, spread over the motion, tell enough."""
_SURE = 0.05
"""By so much the second best order is stranger, where the best is sure."""
_SHAPE = 0.2
"""Weight of how the parts lie to one another beside how the bones change."""


def likely_skeleton(positions: Array) -> tuple[Skeleton | None, Skeleton | None]:
    """The skeleton under which the bones change least, left and right are most alike, and the body is a body.

    Args:
        positions: (…, T, J, 3) of any unit and axes.

    Returns:
        None where no skeleton has J joints; and another that it may as well be.
    """
    if positions.ndim < 2:
        return None, None
    # SBU's order and K3HI's share 15 joints; CMU's, Human3.6M's and COCO's 17. Points of markers come with their names.
    known = [s for s in SKELETONS.values() if s is not POINTS17 and s.num_joints == positions.shape[-2]]
    if len(known) < 2 or positions.ndim < 3 or positions.shape[-1] != 3 or 0 in positions.shape:
        return (known[0] if known else None), None
    some = np.linspace(0, positions.shape[-3] - 1, _SAMPLED).astype(int)
    frames = positions[..., some, :, :].astype(np.float64).reshape(-1, *positions.shape[-2:])
    strange = {skeleton.name: _strangeness(frames, skeleton) for skeleton in known}
    best, second, *_ = sorted(known, key=lambda skeleton: strange[skeleton.name])
    return best, None if strange[second.name] - strange[best.name] > _SURE else second


def _shape(frames: Array, skeleton: Skeleton) -> float:
    """0 to 4: the hips lie across as the shoulders do, which are above them, knees bend forwards, the head is up."""
    at = places_of(Clip(frames.astype(np.float32), 30.0, skeleton))
    hips, shoulders, knees, ankles = (
        (at[f"left_{part}"] + at[f"right_{part}"]) / 2 for part in ("hip", "shoulder", "knee", "ankle")
    )
    across = unit(at["left_hip"] - at["right_hip"])
    trunk = unit(shoulders - hips)
    ahead = np.cross(across, trunk)

    def against(one: Array, other: Array) -> float:
        return float(np.mean(1 - np.sum(one * other, axis=-1))) / 2

    bent = np.sum((knees - (hips + ankles) / 2) * ahead, axis=-1) / np.linalg.norm(hips - ankles, axis=-1).clip(1e-9)
    return (
        against(across, unit(at["left_shoulder"] - at["right_shoulder"]))
        + against(trunk, unit(hips - ankles))
        + against(trunk, unit(at["head"] - hips))
        + float(np.clip(-10 * np.mean(bent), 0.0, 1.0))
    )


def _strangeness(frames: Array, skeleton: Skeleton) -> float:
    """Variation of bone lengths over time and between the sides, relative to them, and what no body looks like."""
    bones = {
        skeleton.joint_names[child]: np.linalg.norm(frames[:, child] - frames[:, parent], axis=-1)
        for parent, child in skeleton.bones
    }
    mean = float(np.mean([length.mean() for length in bones.values()])) + 1e-9
    change = float(np.mean([length.std() for length in bones.values()])) / mean
    pairs = [(name, name.replace("left_", "right_")) for name in bones if name.startswith("left_")]
    uneven = float(np.mean([abs(bones[a].mean() - bones[b].mean()) for a, b in pairs if b in bones])) / mean
    return change + uneven + _SHAPE * _shape(frames, skeleton)
