"""The HIERARCHY part of a BVH file: joints, their offsets and channels."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from webdemo.motion.errors import InputError

from .crowd import MAX_PEOPLE

MAX_JOINTS = 200
_LONGEST_NAME = 80
_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass
class Joint:
    """A joint, or the tip of a chain; ``channels`` are ("position" or "rotation", axis) in their order."""

    name: str
    parent: int
    line: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    channels: list[tuple[str, int]] = field(default_factory=list)
    is_end: bool = False


def parse_hierarchy(text: str, label: str) -> list[Joint]:
    """The joints of a HIERARCHY part, parents first.

    Raises:
        InputError: one sentence with the line and joint where it is wrong.
    """
    joints: list[Joint] = []
    stack: list[int] = []
    pending: int | None = None  # the joint whose "{" has not come yet
    for number, line in enumerate(text.splitlines(), 1):
        # Braces may share a line with other words.
        for piece in re.findall(r"[{}]|[^{}]+", line):
            words = piece.split()
            if not words:
                continue
            keyword = words[0].upper()
            where = f"{label}, line {number}"
            if keyword in ("ROOT", "JOINT", "END"):
                if keyword == "JOINT" and not stack:
                    raise InputError(f"{where}: JOINT {' '.join(words[1:])} hangs on nothing.")
                parent = stack[-1] if stack else -1
                if keyword == "END":
                    if parent < 0:
                        raise InputError(f"{where}: an End Site hangs on nothing.")
                    given = f"{joints[parent].name}_end"
                else:
                    given = " ".join(words[1:])[:_LONGEST_NAME]
                    if not given:
                        raise InputError(f"{where}: a joint has no name.")
                joints.append(Joint(given, parent, number, is_end=keyword == "END"))
                pending = len(joints) - 1
                if sum(not joint.is_end for joint in joints) > MAX_JOINTS or len(joints) > 2 * MAX_JOINTS:
                    raise InputError(
                        f"{where}: more than {MAX_JOINTS} joints; export the body without extras."
                    )
            elif keyword == "{":
                if pending is None:
                    raise InputError(f"{where}: '{{' without a joint before it.")
                stack.append(pending)
                pending = None
            elif keyword == "}":
                if not stack:
                    raise InputError(f"{where}: one '}}' too many.")
                stack.pop()
            elif keyword == "OFFSET" and stack:
                joints[stack[-1]].offset = _three_numbers(words[1:], where, joints[stack[-1]].name)
            elif keyword == "CHANNELS" and stack:
                joints[stack[-1]].channels = _channels(words[1:], where, joints[stack[-1]].name)
            elif keyword != "HIERARCHY":
                raise InputError(f"{where}: {words[0][:40]!r} is not understood in the HIERARCHY part.")
    if stack or pending is not None:
        open_joint = joints[stack[-1] if stack else pending or 0]
        raise InputError(
            f"{label}: joint {open_joint.name} (line {open_joint.line}) is never closed by '}}'."
        )
    if not joints:
        raise InputError(f"{label} has no ROOT joint.")
    for first, stop in trees(joints, label):
        names = [joint.name for joint in joints[first:stop]]
        for joint in joints[first:stop]:
            if names.count(joint.name) > 1 and not joint.is_end:
                raise InputError(
                    f"{label}, line {joint.line}: two joints are named {joint.name}: rename one."
                )
    return joints


def trees(joints: list[Joint], label: str) -> list[tuple[int, int]]:
    """(first, stop) joint of each person, who is a tree of joints; they follow one another."""
    roots = [index for index, joint in enumerate(joints) if joint.parent < 0]
    if len(roots) > MAX_PEOPLE:
        raise InputError(f"{label} holds {len(roots)} people: give {MAX_PEOPLE} or fewer a file.")
    return list(zip(roots, [*roots[1:], len(joints)], strict=True))


def _three_numbers(words: list[str], where: str, joint: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words)
    except ValueError:
        raise InputError(
            f"{where}: OFFSET of joint {joint} must be three numbers, not {' '.join(words)[:40]!r}."
        ) from None
    if not np.isfinite([x, y, z]).all() or max(abs(x), abs(y), abs(z)) > 1e6:
        raise InputError(f"{where}: OFFSET of joint {joint} is not a usable length.")
    return x, y, z


def _channels(words: list[str], where: str, joint: str) -> list[tuple[str, int]]:
    found = []
    for word in words[1:]:
        match = re.fullmatch(r"([XYZ])(position|rotation)", word, re.IGNORECASE)
        if not match:
            raise InputError(f"{where}: joint {joint} has an unknown channel {word[:40]!r}.")
        found.append((match[2].lower(), _AXES[match[1].lower()]))
    if not words or words[0] != str(len(found)) or len(set(found)) != len(found):
        raise InputError(
            f"{where}: CHANNELS of joint {joint} must be a count and that many different channels."
        )
    return found
