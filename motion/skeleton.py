"""Skeletons as data: joint names, parents and rest offsets.

A :class:`Skeleton` says which joints there are and how they hang together; its ``offsets`` are the
rest pose (a T-pose: Y up, facing +Z, left hand towards +X, metres). Motion is stored as joint
positions, so most skeletons here only need names and parents; :data:`SMPL22`, the skeleton every
network works on, carries the proportions of an average adult.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .vectors import Array

SIDES = ("left", "right")
OTHER_SIDE = {"left": "right", "right": "left"}


class Tree:
    """Joints, each of which hangs on another.

    Attributes:
        parents: index of each joint's parent, -1 for a root; a parent comes before its children.
        offsets: (J, 3) rest position of each joint relative to its parent.
    """

    parents: tuple[int, ...]
    offsets: Array

    @cached_property
    def bones(self) -> tuple[tuple[int, int], ...]:
        """(parent, child) pairs, one for every joint but the roots."""
        return tuple((parent, joint) for joint, parent in enumerate(self.parents) if parent >= 0)

    def rest_positions(self) -> Array:
        """(J, 3) the pose of rest, for a skeleton the T-pose with the root at the origin."""
        positions = np.array(self.offsets, dtype=np.float64)
        for parent, joint in self.bones:
            positions[joint] += positions[parent]
        return positions


@dataclass(frozen=True, eq=False)
class Skeleton(Tree):
    """A tree of joints.

    Attributes:
        name: what the skeleton is called in files and messages.
        joint_names: one unique name a joint.
        parents: index of each joint's parent, -1 for the root; a parent comes before its children.
        offsets: (J, 3) rest position of each joint relative to its parent in metres (zeros for a
            skeleton of which only the topology is known).
    """

    name: str
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array = field(repr=False)

    @cached_property
    def num_joints(self) -> int:
        """Number of joints."""
        return len(self.parents)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The children of every joint."""
        children: list[list[int]] = [[] for _ in self.parents]
        for parent, joint in self.bones:
            children[parent].append(joint)
        return tuple(tuple(joints) for joints in children)

    def below(self, joint: int) -> list[int]:
        """All joints that hang below one."""
        return [each for child in self.children[joint] for each in (child, *self.below(child))]

    @cached_property
    def bone_lengths(self) -> Array:
        """(J,) length of the bone that ends in each joint in metres, 0 for the root."""
        return np.linalg.norm(self.offsets, axis=-1)

    def standing(self) -> Array:
        """(J, 3) the T-pose with its lowest joint on the floor, metres."""
        rest = self.rest_positions()
        return np.asarray(rest - [0.0, rest[:, 1].min(), 0.0])

    @cached_property
    def mirror(self) -> tuple[int, ...]:
        """For every joint, the joint that takes its place when left and right are swapped."""
        index = {name: joint for joint, name in enumerate(self.joint_names)}
        parts = (name.partition("_") for name in self.joint_names)
        others = (OTHER_SIDE.get(side, side) + mark + rest for side, mark, rest in parts)
        return tuple(index.get(other, joint) for joint, other in enumerate(others))

    @cached_property
    def index(self) -> Callable[[str], int]:
        """The index of a joint by name; raises ``KeyError`` for another name."""
        return {name: joint for joint, name in enumerate(self.joint_names)}.__getitem__


def _topology(name: str, joints: list[tuple[str, str | None]], offsets: Array | None = None) -> Skeleton:
    names = tuple(joint for joint, _ in joints)
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent in joints)
    return Skeleton(name, names, parents, np.zeros((len(names), 3)) if offsets is None else offsets)


# Average adult proportions in the order of the SMPL model (Loper et al. 2015), left and right made
# symmetric so that a mirrored motion lives on the same skeleton. Metres.
_SMPL22 = [
    ("pelvis", None, (0.0, 0.0, 0.0)),
    ("left_hip", "pelvis", (0.0595, -0.0864, -0.0156)),
    ("right_hip", "pelvis", (-0.0595, -0.0864, -0.0156)),
    ("spine1", "pelvis", (0.0, 0.1244, -0.0384)),
    ("left_knee", "left_hip", (0.0434, -0.3851, 0.0016)),
    ("right_knee", "right_hip", (-0.0434, -0.3851, 0.0016)),
    ("spine2", "spine1", (0.0, 0.1380, 0.0268)),
    ("left_ankle", "left_knee", (-0.0170, -0.4235, -0.0360)),
    ("right_ankle", "right_knee", (0.0170, -0.4235, -0.0360)),
    ("spine3", "spine2", (0.0, 0.0560, 0.0029)),
    ("left_foot", "left_ankle", (0.0380, -0.0612, 0.1262)),
    ("right_foot", "right_ankle", (-0.0380, -0.0612, 0.1262)),
    ("neck", "spine3", (0.0, 0.2116, -0.0335)),
    ("left_collar", "spine3", (0.0774, 0.1133, -0.0213)),
    ("right_collar", "spine3", (-0.0774, 0.1133, -0.0213)),
    ("head", "neck", (0.0, 0.0889, 0.0504)),
    ("left_shoulder", "left_collar", (0.1181, 0.0461, -0.0138)),
    ("right_shoulder", "right_collar", (-0.1181, 0.0461, -0.0138)),
    ("left_elbow", "left_shoulder", (0.2577, -0.0150, -0.0271)),
    ("right_elbow", "right_shoulder", (-0.2577, -0.0150, -0.0271)),
    ("left_wrist", "left_elbow", (0.2674, 0.0098, -0.0067)),
    ("right_wrist", "right_elbow", (-0.2674, 0.0098, -0.0067)),
]

SMPL22 = _topology(
    "smpl22", [(name, parent) for name, parent, _ in _SMPL22], np.array([offset for *_, offset in _SMPL22])
)
"""The 22 body joints of SMPL with the proportions of an average adult; what every network here speaks."""

FEET = tuple(SMPL22.index(n) for n in ("left_ankle", "left_foot", "right_ankle", "right_foot"))
ARMS = tuple(tuple(SMPL22.index(f"{side}_{n}") for n in ("shoulder", "elbow", "wrist")) for side in SIDES)
"""Shoulder, elbow and wrist of the left arm and of the right one."""
LEGS = tuple(tuple(SMPL22.index(f"{side}_{n}") for n in ("hip", "knee", "ankle", "foot")) for side in SIDES)
"""Hip, knee, ankle and toe of the left leg and of the right one."""
TOES = [leg[-1] for leg in LEGS]
HEAD_TOP = 0.16
"""Metres from the joint of the head to its top, along the neck (15 to 18 cm in the bodies that are drawn)."""


def _chains(name: str, chains: str) -> Skeleton:
    """A skeleton from chains of joints between commas; joints are numbered as they appear, the first is the root."""
    parents: dict[str, str | None] = {}
    for chain in chains.split(","):
        above: str | None = None
        for joint in chain.split():
            parents.setdefault(joint, above)
            above = joint
    return _topology(name, list(parents.items()))


SBU15 = _chains(
    "sbu15",
    "head neck torso, neck left_shoulder left_elbow left_wrist, neck right_shoulder right_elbow right_wrist,"
    "torso left_hip left_knee left_foot, torso right_hip right_knee right_foot",
)
"""SBU Kinect Interaction (Yun et al. 2012); joints in the order of its files."""

K3HI15 = _chains(
    "k3hi15",
    "head neck left_shoulder, neck right_shoulder, left_shoulder left_elbow, right_shoulder right_elbow,"
    "left_elbow left_wrist, right_elbow right_wrist, neck torso left_hip, torso right_hip, left_hip left_knee,"
    "right_hip right_knee, left_knee left_foot, right_knee right_foot",
)
"""K3HI (Hu et al.); the same 15 joints as SBU in another order."""

NTU25 = _chains(
    "ntu25",
    # The Kinect v2 order puts "spine_shoulder" after the joints that hang on it; here those hang on the
    # middle of the spine instead, which keeps parents before children without reordering the file's joints.
    "base_of_spine middle_of_spine neck head, middle_of_spine left_shoulder left_elbow left_wrist left_hand,"
    "middle_of_spine right_shoulder right_elbow right_wrist right_hand,"
    "base_of_spine left_hip left_knee left_ankle left_foot, base_of_spine right_hip right_knee right_ankle right_foot,"
    "middle_of_spine spine_shoulder, left_hand left_hand_tip, left_wrist left_thumb, right_hand right_hand_tip,"
    "right_wrist right_thumb",
)
"""Kinect v2 / NTU RGB+D 25 joints in file order."""

_LEFT_ARM, _RIGHT_ARM = (f"{side}_shoulder {side}_elbow {side}_wrist" for side in SIDES)
_LEFT_LEG, _RIGHT_LEG = (f"pelvis {side}_hip {side}_knee {side}_ankle" for side in SIDES)
_UPPER_BODY = f"pelvis spine1 spine3 neck head, spine3 {_LEFT_ARM}, spine3 {_RIGHT_ARM}"
CMU17 = _chains("cmu17", f"{_LEFT_LEG}, {_RIGHT_LEG}, {_UPPER_BODY}")
"""The 17 joints that motion-prediction papers keep of CMU MoCap, in their order."""

H36M17 = _chains("h36m17", f"{_RIGHT_LEG}, {_LEFT_LEG}, {_UPPER_BODY}")
"""The 17 joints of Human3.6M in the order of pose estimators (VideoPose3D): legs right first, arms left first."""

COCO17 = _chains(
    "coco17",
    "nose left_eye, nose right_eye, nose left_ear, nose right_ear, nose left_shoulder, nose right_shoulder,"
    "left_shoulder left_elbow, right_shoulder right_elbow, left_elbow left_wrist, right_elbow right_wrist,"
    "left_shoulder left_hip, right_shoulder right_hip, left_hip left_knee, right_hip right_knee,"
    "left_knee left_ankle, right_knee right_ankle",
)
"""The 17 key points of COCO, in metres."""

POINTS17 = _chains(
    "points17", f"{_LEFT_LEG} left_foot, {_RIGHT_LEG} right_foot, pelvis neck head, neck {_LEFT_ARM}, neck {_RIGHT_ARM}"
)
"""Joint centres that are found from markers or key points (:mod:`motion.formats.markers`)."""

SKELETONS: dict[str, Skeleton] = {s.name: s for s in (SMPL22, SBU15, K3HI15, NTU25, CMU17, H36M17, COCO17, POINTS17)}


# ---- Layouts: the joints of other recordings, each on a body with the tree of SMPL22 ---------------------------------
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
    "spine1": (0.0, 0.080, 0.0),
    "spine2": (0.0, 0.087, 0.0),
    "spine3": (0.0, 0.083, 0.0),
    "neck": (0.0, 0.134, 0.0),
    "head": (0.0, 0.212, 0.0),
    "left_collar": (0.053, 0.100, 0.0),
    "left_shoulder": (0.100, 0.034, 0.0),
    "left_elbow": (0.287, 0.0, 0.0),
    "left_wrist": (0.287, 0.0, 0.0),
    "left_knee": (0.0, -0.435, 0.0),
    "left_ankle": (0.0, -0.415, 0.0),
}
_OPENNI_NAMES = {"torso": "spine2", "left_foot": "left_ankle", "right_foot": "right_ankle"}
# Kinect v2: "base of spine" lies between the hips, "spine shoulder" at the height of the shoulders.
_KINECT2 = {"left_hip": (0.080, -0.030, 0.0)}
_KINECT2_NAMES = {"base_of_spine": "pelvis", "middle_of_spine": "spine2"}


def _layout(
    source: Skeleton, names: dict[str, str], offsets: dict[str, tuple[float, float, float]], variety: float = 0.33
) -> Layout:
    wanted = [names.get(name, name) for name in source.joint_names]
    joints = tuple(SMPL22.joint_names.index(n) if n in SMPL22.joint_names else -1 for n in wanted)
    return Layout(source.name, joints, offsets_of(offsets), variety)


def offsets_of(changed: Mapping[str, tuple[float, float, float]]) -> Array:
    """(22, 3) SMPL22's offsets, of which some are others: metres by joint; the right side mirrors the left."""
    offsets = SMPL22.offsets.copy()
    for name, offset in changed.items():
        offsets[SMPL22.mirror[SMPL22.index(name)]] = np.array(offset) * [-1.0, 1.0, 1.0]
        offsets[SMPL22.index(name)] = offset
    return offsets


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


def find_layout(joints: Layout | Skeleton | Sequence[str]) -> Layout:
    """The layout of a skeleton, or of a list of SMPL22 joint names."""
    if isinstance(joints, Layout):
        return joints
    if isinstance(joints, Skeleton):
        return LAYOUTS[joints.name]
    return Layout("named", tuple(SMPL22.index(name) for name in joints), SMPL22.offsets)
