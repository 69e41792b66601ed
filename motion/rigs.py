"""Rigs as files bring them, and which of their joints play which part of the body.

A rig names its joints as its makers liked: ``mixamorig:LeftUpLeg``, ``UpperLeg_L``, ``lfemur`` and
``LeftHip`` are one joint. :func:`match_joints` finds the parts by rules over the words of a name and
by the tree; it needs no table of known rigs.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .skeleton import SMPL22

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class RigMotion:
    """The motion of any rig, before it is brought onto one of our skeletons.

    Attributes:
        joint_names: one name a joint; the tip of a chain (BVH's End Site) is named ``PARENT_end``.
        parents: index of each joint's parent, -1 for a root; parents come first.
        offsets: (J, 3) rest position relative to the parent, in metres.
        positions: (T, J, 3) world positions in metres, axes as in the file.
        rotations: (T, J, 3, 3) local rotations against the rig's rest pose, where the joints are SMPL22's.
        fps: frames a second.
        metres_per_unit: what the file's lengths were multiplied by.
        name: the file's name, for messages.
        up: the axis that points up ("x", "y" or "z"), where it is known; it is found from the body otherwise.
        every: of how many frames of the file one is here.
        y_up: Y is up unless the rest pose stands along another axis, as in a BVH.
    """

    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array = field(repr=False)
    positions: Array = field(repr=False)
    rotations: Array | None = field(repr=False)
    fps: float
    metres_per_unit: float = 1.0
    name: str = ""
    up: str | None = None
    every: int = 1
    y_up: bool = False

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return len(self.positions)

    @cached_property
    def bone_lengths(self) -> Array:
        """(J,) median length of the bone that ends in each joint in metres, 0 for roots."""
        return np.array([
            0.0 if parent < 0
            else np.median(np.linalg.norm(self.positions[:, joint] - self.positions[:, parent], axis=-1))
            for joint, parent in enumerate(self.parents)
        ])  # fmt: skip

    def path_to_root(self, joint: int) -> list[int]:
        """The joint and all its ancestors."""
        path = [joint]
        while self.parents[path[-1]] >= 0:
            path.append(self.parents[path[-1]])
        return path

    def common_ancestor(self, first: int, second: int) -> int:
        """The joint nearest to both that carries both; -1 where they hang on different roots."""
        others = set(self.path_to_root(second))
        return next((joint for joint in self.path_to_root(first) if joint in others), -1)


@dataclass(frozen=True)
class BodyParts:
    """Indices of a rig's joints by part; ``None`` where the rig has no such joint.

    ``left`` and ``right`` hold collar, shoulder, elbow, wrist, hip, knee, ankle and toe; ``spine`` is the
    chain from the pelvis (first) to the joint that carries the shoulders (last).
    """

    pelvis: int
    spine: tuple[int, ...]
    neck: int | None
    head: int | None
    left: dict[str, int | None]
    right: dict[str, int | None]


# The words of a name that say nothing about the body: prefixes of exporters and rigging tools.
_NOISE = {
    "mixamorig", "bip", "biped", "valve", "character", "cc", "base", "j", "def", "org", "mcp", "jnt", "joint",
    "bone", "skel", "skeleton", "ctrl", "rig", "m", "b", "sk", "avg", "f",
}  # fmt: skip
_SIDES = {"l": "left", "left": "left", "lft": "left", "r": "right", "right": "right", "rgt": "right"}
# By preference. Parts earlier in this table claim a joint first: "shoulder" is the upper arm in Xsens' rig,
# where nothing else is, and the collar in Mixamo's, where "arm" is the upper arm.
_LIMB_NAMES = {
    "wrist": ("wrist", "hand"),
    "elbow": ("elbow", "forearm", "lowerarm", "lowarm", "radius"),
    "shoulder": ("upperarm", "uparm", "humerus", "arm", "shldr", "shoulder"),
    "collar": ("collar", "collarbone", "clavicle", "clav", "shoulder", "inshoulder"),
    "ankle": ("ankle", "foot"),
    "toe": ("toe", "toes", "toebase", "ball", "forefoot", "foot"),
    "knee": ("knee", "lowerleg", "lowleg", "shin", "shank", "calf", "tibia", "leg"),
    "hip": ("upleg", "upperleg", "thigh", "femur", "hip", "leg"),
}
_ALL_LIMB_NAMES = {name for names in _LIMB_NAMES.values() for name in names}
_SPINE_NAMES = ("spine1", "spine2", "spine3")
_REQUIRED = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")


def matched_names(rig: RigMotion) -> list[tuple[str, str]]:
    """(joint of the rig, joint of SMPL22) of every part that :func:`match_joints` finds, pelvis first.

    Raises:
        InputError: as :func:`match_joints`.
    """
    parts = match_joints(rig)
    pairs: list[tuple[int | None, str]] = [(parts.pelvis, "pelvis")]
    # The spine's joints are spread over SMPL22's three; a shorter spine names those it has.
    pairs += list(zip(parts.spine[1:], _SPINE_NAMES, strict=False))
    pairs += [(parts.neck, "neck"), (parts.head, "head")]
    for side, limb in (("left", parts.left), ("right", parts.right)):
        pairs += [(joint, f"{side}_{'foot' if part == 'toe' else part}") for part, joint in limb.items()]
    return [(rig.joint_names[joint], name) for joint, name in pairs if joint is not None]


def pairs_of(rig: RigMotion) -> dict[int, int]:
    """The joint of SMPL22 beside each joint of a rig's body; the last of any spine carries the shoulders in both.

    Raises:
        InputError: as :func:`match_joints`.
    """
    spine = match_joints(rig).spine[1:]
    shares = np.linspace(0, 2, len(spine)) if len(spine) > 1 else np.array([2.0])
    found = {rig.joint_names.index(theirs): SMPL22.index(ours) for theirs, ours in matched_names(rig)}
    return found | {
        joint: SMPL22.index(_SPINE_NAMES[round(share)]) for joint, share in zip(spine, shares, strict=False)
    }


def match_joints(rig: RigMotion) -> BodyParts:
    """Finds the parts of a human body among a rig's joints.

    Raises:
        InputError: naming the parts that no joint was found for.
    """
    keys = [_side_and_key(name) for name in rig.joint_names]
    limbs = {side: _match_limbs(rig, keys, side) for side in ("left", "right")}
    missing = [f"{side} {part}" for side in limbs for part in _REQUIRED if limbs[side][part] is None]
    if missing:
        raise InputError(
            f"{rig.name or 'The file'} has no joint that looks like the {', '.join(missing)} (it has "
            f"{_shorten(rig.joint_names)}): rename its joints as Mixamo does: LeftArm, LeftForeArm …"
        )
    pelvis = rig.common_ancestor(limbs["left"]["hip"], limbs["right"]["hip"])  # type: ignore[arg-type]
    chest = rig.common_ancestor(limbs["left"]["shoulder"], limbs["right"]["shoulder"])  # type: ignore[arg-type]
    if pelvis < 0 or chest < 0:
        raise InputError(f"{rig.name or 'The file'} holds more than one skeleton: give one person a file.")
    path = rig.path_to_root(chest)
    spine = path[: path.index(pelvis) + 1][::-1] if pelvis in path else [pelvis, chest]
    neck = _first(rig, keys, "centre", ("neck", "lowerneck"))
    head = _first(rig, keys, "centre", ("head", "face", "skull"))
    if head is None and neck is not None:
        head = next((joint for joint, parent in enumerate(rig.parents) if parent == neck), None)
    return BodyParts(pelvis, tuple(spine), neck, head, limbs["left"], limbs["right"])


def _match_limbs(rig: RigMotion, keys: list[tuple[str, str]], side: str) -> dict[str, int | None]:
    found: dict[str, int | None] = {}
    for part, names in _LIMB_NAMES.items():
        taken = {joint for joint in found.values() if joint is not None}
        found[part] = _first(rig, keys, side, names, taken)
    # A chain that stops at the forearm or the foot still has a tip (BVH's End Site), which is the next joint.
    for part, carrier in (("wrist", "elbow"), ("toe", "ankle")):
        parent = found[carrier]
        if found[part] is None and parent is not None:
            tips = (joint for joint, name in enumerate(rig.joint_names) if name.endswith("_end"))
            found[part] = next((joint for joint in tips if rig.parents[joint] == parent), None)
    return found


def _first(
    rig: RigMotion,
    keys: list[tuple[str, str]],
    side: str,
    names: tuple[str, ...],
    taken: set[int] | None = None,
) -> int | None:
    """The joint with the best-liked name; among equals the one nearest to the root."""
    for name in names:
        found = [
            joint for joint, key in enumerate(keys) if key == (side, name) and joint not in (taken or ())
        ]
        if found:
            return min(found, key=lambda joint: len(rig.path_to_root(joint)))
    return None


def _side_and_key(name: str) -> tuple[str, str]:
    """("left" | "right" | "centre", the name's words in one, without side, digits and prefixes)."""
    words = [w.lower() for w in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name.rsplit(":", 1)[-1])]
    sides = [_SIDES[w] for w in words if w in _SIDES]
    rest = [w for w in words if w not in _SIDES and w not in _NOISE]
    if not sides and len(rest) == 1 and rest[0][0] in "lr" and rest[0][1:] in _ALL_LIMB_NAMES:
        # "lfemur": a side glued to the part.
        return _SIDES[rest[0][0]], rest[0][1:]
    return (sides[0] if sides else "centre"), "".join(rest)


def _shorten(names: tuple[str, ...]) -> str:
    return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")
