"""Joint layouts of other recordings, each on a body with the tree of SMPL22.

A :class:`Layout` says which joint of SMPL22 each recorded joint is and carries the rest offsets of an
average adult *as that recording sees one*: a Kinect's "shoulder" lies nine centimetres below SMPL's, its
hips lie higher and wider. Pose is fitted on this body, then put on SMPL22's own bones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .skeleton import CMU17, COCO17, H36M17, K3HI15, NTU25, POINTS17, SBU15, SMPL22, Skeleton

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Layout:
    """The SMPL22 joint of each recorded joint.

    Attributes:
        name: what the recording is called in messages.
        joints: for every recorded joint, the index of its SMPL22 joint, or -1 where it has none.
        offsets: (22, 3) rest offsets in metres of an average adult as the recording sees one.
        variety: how far a bone may differ from the body's size, as a fraction. People differ by a tenth; a
            depth camera's arms differ more, but that is its error.
    """

    name: str
    joints: tuple[int, ...]
    offsets: Array = field(repr=False)
    variety: float = 0.33

    @property
    def columns(self) -> list[int]:
        """Indices of the recorded joints that SMPL22 has."""
        return [column for column, joint in enumerate(self.joints) if joint >= 0]

    @property
    def observed(self) -> list[int]:
        """The SMPL22 joints of :attr:`columns`."""
        return [joint for joint in self.joints if joint >= 0]


# OpenNI/NITE (Kinect v1) proportions of an adult of SMPL22's height, medians over SBU and K3HI: the trunk is
# a flat rigid plate of neck, shoulders and hips with "torso" in its middle, and "foot" is the ankle.
_OPENNI = {
    "left_hip": (0.100, -0.050, 0.0),
    "right_hip": (-0.100, -0.050, 0.0),
    "spine1": (0.0, 0.080, 0.0),
    "spine2": (0.0, 0.087, 0.0),
    "spine3": (0.0, 0.083, 0.0),
    "neck": (0.0, 0.134, 0.0),
    "head": (0.0, 0.212, 0.0),
    "left_collar": (0.053, 0.100, 0.0),
    "right_collar": (-0.053, 0.100, 0.0),
    "left_shoulder": (0.100, 0.034, 0.0),
    "right_shoulder": (-0.100, 0.034, 0.0),
    "left_elbow": (0.287, 0.0, 0.0),
    "right_elbow": (-0.287, 0.0, 0.0),
    "left_wrist": (0.287, 0.0, 0.0),
    "right_wrist": (-0.287, 0.0, 0.0),
    "left_knee": (0.0, -0.435, 0.0),
    "right_knee": (0.0, -0.435, 0.0),
    "left_ankle": (0.0, -0.415, 0.0),
    "right_ankle": (0.0, -0.415, 0.0),
}
_OPENNI_NAMES = {"torso": "spine2", "left_foot": "left_ankle", "right_foot": "right_ankle"}
# Kinect v2: "base of spine" lies between the hips, "spine shoulder" at the height of the shoulders.
_KINECT2 = {"left_hip": (0.080, -0.030, 0.0), "right_hip": (-0.080, -0.030, 0.0)}
_KINECT2_NAMES = {"base_of_spine": "pelvis", "middle_of_spine": "spine2"}


def _layout(
    source: Skeleton, names: dict[str, str], offsets: dict[str, tuple[float, float, float]], variety: float = 0.33
) -> Layout:
    wanted = [names.get(name, name) for name in source.joint_names]
    joints = tuple(SMPL22.joint_names.index(n) if n in SMPL22.joint_names else -1 for n in wanted)
    body = SMPL22.offsets.copy()
    for name, offset in offsets.items():
        body[SMPL22.index(name)] = offset
    return Layout(source.name, joints, body, variety)


LAYOUTS: dict[str, Layout] = {
    "sbu15": _layout(SBU15, _OPENNI_NAMES, _OPENNI, 0.1),
    "k3hi15": _layout(K3HI15, _OPENNI_NAMES, _OPENNI, 0.1),
    "ntu25": _layout(NTU25, _KINECT2_NAMES, _KINECT2, 0.15),
    "cmu17": _layout(CMU17, {}, {}),
    "h36m17": _layout(H36M17, {}, {}),
    "coco17": _layout(COCO17, {"nose": "head"}, {"head": (0.0, 0.09, 0.13)}),
    "points17": _layout(POINTS17, {}, {}),
    "smpl22": _layout(SMPL22, {}, {}),
}
"""The layouts that a fit knows by the name of their skeleton."""


def find_layout(joints: Layout | Skeleton | str | Sequence[str]) -> Layout:
    """The layout of a skeleton, of a skeleton's name, or of a list of SMPL22 joint names.

    Raises:
        InputError: for a skeleton without a layout or a joint that SMPL22 does not have.
    """
    if isinstance(joints, Layout):
        return joints
    if isinstance(joints, Skeleton):
        joints = joints.name
    if isinstance(joints, str):
        if joints not in LAYOUTS:
            raise InputError(f"No joint layout is called {joints!r}: use one of {', '.join(sorted(LAYOUTS))}.")
        return LAYOUTS[joints]
    unknown = [name for name in joints if name not in SMPL22.joint_names]
    if unknown:
        raise InputError(f"The joint {unknown[0]!r} is not one of the 22: use {', '.join(SMPL22.joint_names)}.")
    return Layout("named", tuple(SMPL22.joint_names.index(name) for name in joints), SMPL22.offsets)
