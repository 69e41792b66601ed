"""The names of joints, whoever gave them: one matcher for the rigs and markers of all formats.

``mixamorig:LeftUpLeg``, ``Anna_UpperLeg_L``, ``lThighBend``, ``lfemur`` and ``左足`` are one joint. A name is a side
and a part: what all names of a file begin or end with is left out, then words that say nothing about the body, then
the side; tables of vendors' words name the rest.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Sequence

Key = tuple[str, str]
"""("left" | "right" | "centre", the part's words in one, lower case)."""

_NOISE = {
    "mixamorig",
    "bip",
    "biped",
    "valve",
    "character",
    "cc",
    "c",
    "base",
    "j",
    "def",
    "org",
    "mcp",
    "jnt",
    "joint",
    "bone",
    "skel",
    "skeleton",
    "ctrl",
    "rig",
    "m",
    "b",
    "sk",
    "avg",
    "f",
    "x",
    "bend",
    "stretch",
}
"""Words of exporters and rigging tools that say nothing about the body; Auto-Rig Pro's and DAZ Genesis' among them."""
_SIDES = {"l": "left", "left": "left", "lft": "left", "r": "right", "right": "right", "rgt": "right"}
PARTS: dict[str, tuple[str, ...]] = {
    "wrist": ("wrist", "hand"),
    "elbow": ("elbow", "forearm", "lowerarm", "lowarm", "farm", "radius"),
    "shoulder": ("upperarm", "uparm", "uarm", "humerus", "arm", "shldr", "shoulder"),
    "collar": ("collar", "collarbone", "clavicle", "clav", "shoulder", "inshoulder"),
    "ankle": ("ankle", "foot"),
    "toe": ("toe", "toes", "toebase", "ball", "forefoot", "foot"),
    "knee": ("knee", "lowerleg", "lowleg", "shin", "shank", "calf", "tibia", "leg"),
    "hip": ("upleg", "upperleg", "thigh", "femur", "hip", "leg"),
    "neck": ("neck", "lowerneck", "necklower"),
    "head": ("head", "face", "skull"),
}
"""Words for each part by preference. Parts earlier in this table claim a joint first: "shoulder" is the upper arm in
Xsens' rig, where nothing else is, and the collar in Mixamo's, where "arm" is the upper arm. "uarm" and "farm" are
OptiTrack's, "shldr" is DAZ's."""
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


def joint_keys(names: Sequence[str], glued: Collection[str] = _GLUED) -> list[Key]:
    """The side and the part of each of a file's names.

    Args:
        names: of all joints or markers of one person.
        glued: parts before which a letter alone is a side, as in "lfemur".
    """
    words = [_words(name) for name in names]
    for end in (0, -1):
        while shared := _shared(words, end):
            words = [its[1:] if end == 0 else its[:-1] if its[end:] == [shared] else its for its in words]
    return [_key(its, glued) for its in words]


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
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)]


def _shared(words: Sequence[list[str]], end: int) -> str:
    """The word that most names begin (0) or end (-1) with, if it is no part of a body."""
    several = [its[end] for its in words if len(its) > 1 and its[end] not in _SIDES]
    if len(several) < 2:
        return ""
    word, count = Counter(several).most_common(1)[0]
    return word if count > _SHARED * len(words) and word not in _GLUED else ""


def _key(words: Sequence[str], glued: Collection[str]) -> Key:
    sides = [_SIDES[word] for word in words if word in _SIDES]
    rest = "".join(word for word in words if word not in _SIDES and word not in _NOISE)
    if not sides and rest[:1] in ("l", "r") and rest[1:] in glued:
        return _SIDES[rest[0]], rest[1:]
    return (sides[0] if sides else "centre"), rest
