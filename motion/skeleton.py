"""Skeletons as data: joint names, parents and rest offsets.

A :class:`Skeleton` says which joints there are and how they hang together; its ``offsets`` are the
rest pose (a T-pose: Y up, facing +Z, left hand towards +X, metres). Motion is stored as joint
positions, so most skeletons here only need names and parents; :data:`SMPL22`, the skeleton every
network works on, carries the proportions of an average adult.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Skeleton:
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

    def __post_init__(self) -> None:
        if len(self.joint_names) != len(self.parents):
            raise ValueError(f"{self.name}: {len(self.joint_names)} names but {len(self.parents)} parents.")
        if np.shape(self.offsets) != (len(self.parents), 3):
            raise ValueError(f"{self.name}: offsets must be ({len(self.parents)}, 3).")
        if any(parent >= joint for joint, parent in enumerate(self.parents)):
            raise ValueError(f"{self.name}: a parent must come before its children.")

    @property
    def num_joints(self) -> int:
        """Number of joints."""
        return len(self.parents)

    @cached_property
    def bones(self) -> tuple[tuple[int, int], ...]:
        """(parent, child) pairs, one for every joint but the root."""
        return tuple((parent, joint) for joint, parent in enumerate(self.parents) if parent >= 0)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The children of every joint."""
        found: list[list[int]] = [[] for _ in self.parents]
        for parent, joint in self.bones:
            found[parent].append(joint)
        return tuple(tuple(joints) for joints in found)

    @cached_property
    def bone_lengths(self) -> Array:
        """(J,) length of the bone that ends in each joint in metres, 0 for the root."""
        return np.linalg.norm(self.offsets, axis=-1)

    @cached_property
    def mirror(self) -> tuple[int, ...]:
        """For every joint, the joint that takes its place when left and right are swapped."""
        index = {name: joint for joint, name in enumerate(self.joint_names)}
        return tuple(index.get(_other_side(name), joint) for joint, name in enumerate(self.joint_names))

    def index(self, joint_name: str) -> int:
        """The index of a joint by name; raises ``KeyError`` with the names that exist."""
        try:
            return self.joint_names.index(joint_name)
        except ValueError:
            raise KeyError(f"{self.name} has no joint {joint_name!r}; it has {self.joint_names}.") from None

    def rest_positions(self) -> Array:
        """(J, 3) the T-pose, root at the origin."""
        positions = np.array(self.offsets, dtype=np.float64)
        for parent, joint in self.bones:
            positions[joint] += positions[parent]
        return positions


def _other_side(name: str) -> str:
    if name.startswith("left_"):
        return "right_" + name[5:]
    if name.startswith("right_"):
        return "left_" + name[6:]
    return name


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
ARMS = tuple(tuple(SMPL22.index(f"{side}_{n}") for n in ("shoulder", "elbow", "wrist")) for side in ("left", "right"))
"""Shoulder, elbow and wrist of the left arm and of the right one."""
LEGS = tuple(tuple(SMPL22.index(f"{side}_{n}") for n in ("hip", "knee", "ankle", "foot")) for side in ("left", "right"))
"""Hip, knee, ankle and toe of the left leg and of the right one."""

_SBU = [
    ("head", None),
    ("neck", "head"),
    ("torso", "neck"),
    ("left_shoulder", "neck"),
    ("left_elbow", "left_shoulder"),
    ("left_wrist", "left_elbow"),
    ("right_shoulder", "neck"),
    ("right_elbow", "right_shoulder"),
    ("right_wrist", "right_elbow"),
    ("left_hip", "torso"),
    ("left_knee", "left_hip"),
    ("left_foot", "left_knee"),
    ("right_hip", "torso"),
    ("right_knee", "right_hip"),
    ("right_foot", "right_knee"),
]
SBU15 = _topology("sbu15", _SBU)
"""SBU Kinect Interaction (Yun et al. 2012); joints in the order of its files."""

_K3HI_ORDER = [
    "head",
    "neck",
    "left_shoulder",
    "right_shoulder",
    "left_elbow",
    "right_elbow",
    "left_wrist",
    "right_wrist",
    "torso",
    "left_hip",
    "right_hip",
    "left_knee",
    "right_knee",
    "left_foot",
    "right_foot",
]
_SBU_PARENT = dict(_SBU)
K3HI15 = Skeleton(
    "k3hi15",
    tuple(_K3HI_ORDER),
    # The torso (index 8) stands before the hips but after the arms, so every parent still comes first.
    tuple(-1 if _SBU_PARENT[n] is None else _K3HI_ORDER.index(_SBU_PARENT[n] or "") for n in _K3HI_ORDER),
    np.zeros((15, 3)),
)
"""K3HI (Hu et al.); the same 15 joints as SBU in another order."""

NTU25 = Skeleton(
    "ntu25",
    (
        "base_of_spine",
        "middle_of_spine",
        "neck",
        "head",
        "left_shoulder",
        "left_elbow",
        "left_wrist",
        "left_hand",
        "right_shoulder",
        "right_elbow",
        "right_wrist",
        "right_hand",
        "left_hip",
        "left_knee",
        "left_ankle",
        "left_foot",
        "right_hip",
        "right_knee",
        "right_ankle",
        "right_foot",
        "spine_shoulder",
        "left_hand_tip",
        "left_thumb",
        "right_hand_tip",
        "right_thumb",
    ),
    # The Kinect v2 order puts "spine_shoulder" after the joints that hang on it; here those hang on the
    # middle of the spine instead, which keeps parents before children without reordering the file's joints.
    (-1, 0, 1, 2, 1, 4, 5, 6, 1, 8, 9, 10, 0, 12, 13, 14, 0, 16, 17, 18, 1, 7, 6, 11, 10),
    np.zeros((25, 3)),
)
"""Kinect v2 / NTU RGB+D 25 joints in file order."""

CMU17 = _topology(
    "cmu17",
    [
        ("pelvis", None),
        ("left_hip", "pelvis"),
        ("left_knee", "left_hip"),
        ("left_ankle", "left_knee"),
        ("right_hip", "pelvis"),
        ("right_knee", "right_hip"),
        ("right_ankle", "right_knee"),
        ("spine1", "pelvis"),
        ("spine3", "spine1"),
        ("neck", "spine3"),
        ("head", "neck"),
        ("left_shoulder", "spine3"),
        ("left_elbow", "left_shoulder"),
        ("left_wrist", "left_elbow"),
        ("right_shoulder", "spine3"),
        ("right_elbow", "right_shoulder"),
        ("right_wrist", "right_elbow"),
    ],
)
"""The 17 joints that motion-prediction papers keep of CMU MoCap, in their order."""

H36M17 = _topology(
    "h36m17",
    [
        ("pelvis", None),
        ("right_hip", "pelvis"),
        ("right_knee", "right_hip"),
        ("right_ankle", "right_knee"),
        ("left_hip", "pelvis"),
        ("left_knee", "left_hip"),
        ("left_ankle", "left_knee"),
        ("spine1", "pelvis"),
        ("spine3", "spine1"),
        ("neck", "spine3"),
        ("head", "neck"),
        ("left_shoulder", "spine3"),
        ("left_elbow", "left_shoulder"),
        ("left_wrist", "left_elbow"),
        ("right_shoulder", "spine3"),
        ("right_elbow", "right_shoulder"),
        ("right_wrist", "right_elbow"),
    ],
)
"""The 17 joints of Human3.6M in the order of pose estimators (VideoPose3D): legs right first, arms left first."""

COCO17 = _topology(
    "coco17",
    [
        ("nose", None),
        ("left_eye", "nose"),
        ("right_eye", "nose"),
        ("left_ear", "nose"),
        ("right_ear", "nose"),
        ("left_shoulder", "nose"),
        ("right_shoulder", "nose"),
        ("left_elbow", "left_shoulder"),
        ("right_elbow", "right_shoulder"),
        ("left_wrist", "left_elbow"),
        ("right_wrist", "right_elbow"),
        ("left_hip", "left_shoulder"),
        ("right_hip", "right_shoulder"),
        ("left_knee", "left_hip"),
        ("right_knee", "right_hip"),
        ("left_ankle", "left_knee"),
        ("right_ankle", "right_knee"),
    ],
)
"""The 17 key points of COCO, in metres."""

POINTS17 = _topology(
    "points17",
    [
        ("pelvis", None),
        ("left_hip", "pelvis"),
        ("left_knee", "left_hip"),
        ("left_ankle", "left_knee"),
        ("left_foot", "left_ankle"),
        ("right_hip", "pelvis"),
        ("right_knee", "right_hip"),
        ("right_ankle", "right_knee"),
        ("right_foot", "right_ankle"),
        ("neck", "pelvis"),
        ("head", "neck"),
        ("left_shoulder", "neck"),
        ("left_elbow", "left_shoulder"),
        ("left_wrist", "left_elbow"),
        ("right_shoulder", "neck"),
        ("right_elbow", "right_shoulder"),
        ("right_wrist", "right_elbow"),
    ],
)
"""Joint centres that are found from markers or key points (:mod:`motion.formats.markers`)."""

SKELETONS: dict[str, Skeleton] = {s.name: s for s in (SMPL22, SBU15, K3HI15, NTU25, CMU17, H36M17, COCO17, POINTS17)}
