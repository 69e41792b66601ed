"""Rigs as files bring them, and which of their joints play which part of the body.

:func:`match_joints` finds the parts by their names and by the tree: a limb is a chain, so
that its upper joints are ancestors of its lower ones.

``mixamorig:LeftUpLeg``, ``Anna_UpperLeg_L``, ``lThighBend``, ``lfemur`` and ``左足`` are one joint. A name is a side
and a part: what all names of a file begin or end with is left out, then words that say nothing about the body, then
the side; tables of vendors' words name the rest.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .errors import InputError
from .skeleton import Tree
from .vectors import Array


@dataclass(frozen=True, eq=False)
class RigMotion(Tree):
    """The motion of any rig, before it is brought onto one of our skeletons.

    Attributes:
        joint_names: one name a joint; the tip of a chain (BVH's End Site) is named ``PARENT_end``.
        parents: index of each joint's parent, -1 for a root; parents come first.
        offsets: (J, 3) rest position relative to the parent, in metres.
        positions: (T, J, 3) world positions in metres, axes as in the file.
        fps: frames a second.
        metres_per_unit: what the file's lengths were multiplied by.
        name: the file's name, for messages.
        up: the axis that points up, of :data:`motion.guesses.AXES`, where it is known; found from the body otherwise.
        every: of how many frames of the file one is here.
        y_up: Y is up unless the rest pose stands along another axis, as in a BVH.
        mirrored: the world shows what is named left on the right.
        notes: sentences on how well its file could be read.
    """

    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array = field(repr=False)
    positions: Array = field(repr=False)
    fps: float
    metres_per_unit: float = 1.0
    name: str = ""
    up: str | None = None
    every: int = 1
    y_up: bool = False
    mirrored: bool = False
    notes: tuple[str, ...] = field(default=(), repr=False)

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return len(self.positions)

    @cached_property
    def parts(self) -> BodyParts:
        """The parts of its body; raises InputError as :func:`match_joints`."""
        return match_joints(self)

    @cached_property
    def bone_lengths(self) -> Array:
        """(J,) median length of the bone that ends in each joint in metres, 0 for roots."""
        return np.array(
            [
                0.0
                if parent < 0
                else np.median(np.linalg.norm(self.positions[:, joint] - self.positions[:, parent], axis=-1))
                for joint, parent in enumerate(self.parents)
            ]
        )

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
    """Indices of a rig's joints by part.

    Attributes:
        spine: the chain from the pelvis (first) to the joint that carries the shoulders (last).
        joints: neck, head and the joints of the limbs that the rig has, by SMPL22's names.
    """

    spine: tuple[int, ...]
    joints: dict[str, int]

    @property
    def matched(self) -> int:
        """Number of SMPL22's joints that follow from them: its spine has four with the pelvis."""
        return len(self.joints) + min(len(self.spine), 4)


_BELOW = {"elbow": "wrist", "shoulder": "elbow", "collar": "shoulder", "knee": "ankle", "hip": "knee"}
"""The next joint down the limb."""
_LIMB = ("wrist", "elbow", "shoulder", "collar", "ankle", "foot", "knee", "hip")
_ONE_PLACE = 1e-3
"""Share of a body's height within which the left and the right of a part are helpers at one place."""
_LOOKED_AT = 50
"""So many frames, spread over the motion, tell which are."""
_REQUIRED = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")


def match_joints(rig: RigMotion) -> BodyParts:
    """Finds the parts of a human body among a rig's joints.

    Raises:
        InputError: naming the parts that no joint was found for.
    """
    keys = joint_keys(rig.joint_names)
    helpers = _helpers(rig, keys)
    limbs = {side: _match_limbs(rig, keys, side, helpers) for side in ("left", "right")}
    missing = [f"{side} {part}" for side in limbs for part in _REQUIRED if limbs[side][part] is None]
    if missing:
        shown = ", ".join(rig.joint_names[:8]) + " …" * (len(rig.joint_names) > 8)
        raise InputError(
            f"{rig.name or 'The file'} has no joint that looks like the {', '.join(missing)} (it has "
            f"{shown}): rename its joints as Mixamo does: LeftArm, LeftForeArm …"
        )
    pelvis = rig.common_ancestor(limbs["left"]["hip"], limbs["right"]["hip"])  # type: ignore[arg-type]
    chest = rig.common_ancestor(limbs["left"]["shoulder"], limbs["right"]["shoulder"])  # type: ignore[arg-type]
    if pelvis < 0 or chest < 0:
        raise InputError(f"{rig.name or 'The file'} holds more than one skeleton: put one person in each file.")
    path = rig.path_to_root(chest)
    spine = path[: path.index(pelvis) + 1][::-1] if pelvis in path else [pelvis, chest]
    neck, head = (_best(rig, keys, "centre", part) for part in ("neck", "head"))
    if head is None and neck is not None:
        head = next((joint for joint, parent in enumerate(rig.parents) if parent == neck), None)
    joints: dict[str, int | None] = {"neck": neck, "head": head}
    for side, limb in zip(("right", "left") if rig.mirrored else ("left", "right"), limbs.values(), strict=True):
        joints |= {f"{side}_{part}": joint for part, joint in limb.items()}
    return BodyParts(tuple(spine), {name: joint for name, joint in joints.items() if joint is not None})


def _helpers(rig: RigMotion, keys: list[Key]) -> frozenset[int]:
    """Joints that share their place with the same part of the other side: they are no limb's."""
    by_key: dict[Key, list[int]] = {}
    for joint, key in enumerate(keys):
        by_key.setdefault(key, []).append(joint)
    near = _ONE_PLACE * float(np.ptp(rig.positions[0], axis=0).max())
    some = np.unique(np.linspace(0, rig.num_frames - 1, _LOOKED_AT).astype(int))
    places = rig.positions[some]
    helpers: set[int] = set()
    for (side, part), joints in by_key.items():
        others = np.array(by_key.get(("right", part), ()), dtype=int)
        for one in joints if side == "left" and others.size else ():
            apart = np.linalg.norm(places[:, [one]] - places[:, others], axis=-1).max(axis=0)
            if (beside := others[apart < near]).size:
                helpers.update((one, *beside.tolist()))
    return frozenset(helpers)


def _match_limbs(rig: RigMotion, keys: list[Key], side: str, helpers: frozenset[int]) -> dict[str, int | None]:
    joints: dict[str, int | None] = {}
    for part in _LIMB:
        taken = helpers.union(joint for joint in joints.values() if joint is not None)
        joints[part] = _best(rig, keys, side, part, taken, joints.get(_BELOW.get(part, "")))
    # A chain that stops at the forearm or the foot still has a tip (BVH's End Site), which is the next joint.
    for part, carrier in (("wrist", "elbow"), ("foot", "ankle")):
        parent = joints[carrier]
        if joints[part] is None and parent is not None:
            tips = (joint for joint, name in enumerate(rig.joint_names) if name.endswith("_end"))
            joints[part] = next((joint for joint in tips if rig.parents[joint] == parent), None)
    return joints


def _best(
    rig: RigMotion, keys: list[Key], side: str, part: str, taken: frozenset[int] = frozenset(), below: int | None = None
) -> int | None:
    """The joint of a part: one above the next joint down the limb, with the best-liked name, the nearest to that.

    Where nothing is known below, or nothing with such a name is above it, it is the one nearest to the root.
    """
    above = [] if below is None else rig.path_to_root(below)[1:]
    named = [joint for joint, key in enumerate(keys) if key[0] == side and key[1] in PARTS[part] and joint not in taken]
    if held := [joint for joint in named if joint in above]:
        return min(held, key=lambda joint: (PARTS[part].index(keys[joint][1]), above.index(joint)))
    return min(named, key=lambda joint: (PARTS[part].index(keys[joint][1]), len(rig.path_to_root(joint))), default=None)


# ---- Names -----------------------------------------------------------------------------------------------------------
Key = tuple[str, str]
"""("left" | "right" | "centre", the part's words in one, lower case)."""

_SAID = (
    "mixamorig bip biped valve character cc c base j def org mcp jnt joint "
    "bone skel skeleton ctrl rig m b sk avg f x bend stretch"
)
_NOISE = frozenset(_SAID.split())
"""Words of exporters and rigging tools that say nothing about the body; Auto-Rig Pro's and DAZ Genesis' among them."""
_SIDES = {"l": "left", "left": "left", "lft": "left", "r": "right", "right": "right", "rgt": "right"}
PARTS: dict[str, tuple[str, ...]] = {
    "wrist": ("wrist", "hand"),
    "elbow": ("elbow", "forearm", "lowerarm", "lowarm", "farm", "radius"),
    "shoulder": ("upperarm", "uparm", "uarm", "humerus", "arm", "shldr", "shoulder"),
    "collar": ("collar", "collarbone", "clavicle", "clav", "shoulder", "inshoulder"),
    "ankle": ("ankle", "foot"),
    "foot": ("toe", "toes", "toebase", "ball", "forefoot", "foot"),
    "knee": ("knee", "lowerleg", "lowleg", "shin", "shank", "calf", "tibia", "leg"),
    "hip": ("upleg", "upperleg", "thigh", "femur", "hip", "leg"),
    "neck": ("neck", "lowerneck", "necklower"),
    "head": ("head", "face", "skull"),
}
"""Words for each part of SMPL22, whose foot is where toes begin, by preference. Parts earlier in this table claim a
joint first: "shoulder" is the upper arm in Xsens' rig, where nothing else is, and the collar in Mixamo's, where "arm"
is the upper arm. "uarm" and "farm" are OptiTrack's, "shldr" is DAZ's."""
_JAPANESE = {
    "手首": "wrist",
    "ひじ": "elbow",
    "腕": "arm",
    "肩": "collar",
    "足首": "ankle",
    "つま先": "toe",
    "ひざ": "knee",
    "足": "thigh",
    "首": "neck",
    "頭": "head",
    "上半身": "spine",
    "下半身": "hips",
    "センター": "centre",
}
"""MikuMikuDance's parts; 左 and 右 before them are left and right."""
_GLUED = frozenset(word for words in PARTS.values() for word in words)
_SHARED = 0.6
"""Share of a file's names that begin, or end, with a word that is no name of a part."""


def joint_keys(names: Sequence[str]) -> list[Key]:
    """The side and the part of each of the names of all joints of one person."""
    words = [_words(name) for name in names]
    for end in (0, -1):
        while shared := _shared(words, end):
            words = [its[1:] if end == 0 else its[:-1] if its[end:] == [shared] else its for its in words]
    return [_key(its) for its in words]


def without_beginning(names: Sequence[str]) -> tuple[str, ...]:
    """The names without the beginning that all of them share, such as "actor_"."""
    first, last = min(names), max(names)
    same = next((i for i, (one, other) in enumerate(zip(first, last, strict=False)) if one != other), 0)
    cut = max(first[:same].rfind(mark) for mark in "_:|. -") + 1
    return tuple(name[cut:] for name in names)


def _words(name: str) -> list[str]:
    """A name's words in lower case, without digits, marks and what stands before a colon."""
    name = name.rsplit(":", 1)[-1]
    if not name.isascii():
        side = {"左": ["left"], "右": ["right"]}.get(name[:1], [])
        part = re.sub(r"[\d０-９_.]", "", name[1:] if side else name)
        if part in _JAPANESE:
            return [*side, _JAPANESE[part]]
    return [word.lower() for word in re.findall(r"(?i:left|right)|[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)]


def _shared(words: Sequence[list[str]], end: int) -> str:
    """The word that most names begin (0) or end (-1) with, if it is no part of a body."""
    several = [its[end] for its in words if len(its) > 1 and its[end] not in _SIDES]
    if len(several) < 2:
        return ""
    word, count = Counter(several).most_common(1)[0]
    return word if count > _SHARED * len(words) and word not in _GLUED else ""


def _key(words: Sequence[str]) -> Key:
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = "".join(word for word in words if word not in _SIDES and word not in _NOISE)
    if not sides and rest[:1] in ("l", "r") and rest[1:] in _GLUED:  # as in "lfemur"
        return _SIDES[rest[0]], rest[1:]
    return (sides[0] if sides else "centre"), rest
