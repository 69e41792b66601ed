"""The way up in a file: the one check of all formats, with its sign.

People stand most of the time, so the axis from their ankles to their shoulders is up. A format has a usual axis as
well, and a BVH the one along which its rest pose stands. Where the two differ, the floor decides: of a person who
stands on the floor at 0 the body is believed, of one who lies on it the format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .clip import Clip
from .layouts import LAYOUTS
from .rigs import RigMotion, match_joints
from .skeleton import SMPL22
from .transforms import axis_to_y

Array = NDArray[np.floating]
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
    parts = match_joints(motion)
    found = {"head": parts.head, "neck": parts.neck}
    for side, limb in (("left", parts.left), ("right", parts.right)):
        found |= {f"{side}_{'foot' if part == 'toe' else part}": joint for part, joint in limb.items()}
    return {name: positions[:, joint] for name, joint in found.items() if joint is not None}


def turn_of(up: str) -> Array:
    """(3, 3) rotation that turns an axis of :data:`AXES` to Y."""
    return axis_to_y("xyz".index(up[-1]), -1.0 if up[0] == "-" else 1.0)


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
        legs = [
            np.linalg.norm(at[f"{side}_{upper}"] - at[f"{side}_{lower}"], axis=-1)
            for side in ("left", "right")
            for upper, lower in (("hip", "knee"), ("knee", "ankle"))
        ]
        self.leg = max(float(np.median(np.sum(legs, axis=0))) / 2, 1e-9)
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
