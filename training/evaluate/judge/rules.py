"""Checks that a person would make on a duet, as rules on joint positions.

Each rule reads the events of a scene (see :class:`training.corpus.scene.Scene`) and answers only where they
name something: the hand that moves, joints that touch, whether the two come nearer, whether they face each
other, what happens first. A rule that cannot tell gives no verdict rather than a guess.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.handedness import limb_travel
from motion.metrics import facing_angle, pelvis_distance
from motion.transforms import heading, heading_matrix

Array = NDArray[np.floating]
Events = Mapping[str, Any]

CHECKS = ("side", "contact", "distance", "facing", "order")
HANDS_MEET = 0.10
"""Metres between the wrists of two people whose hands meet."""
TOUCHES = 0.20
"""Metres between a wrist and the joint of the other that it touches: the joint lies inside the body."""
CHANGES = 0.5
"""Metres by which the pelvises' distance must change where one approaches or leaves."""
FACES = 45.0
"""Degrees that people who face each other may be turned away, on average over both."""
DIPS = 0.25
"""Metres by which the head sinks in a bow."""
BOTH_SHARE = 0.5
"""Both hands count as moving if the smaller movement is at least this share of the larger."""
LEAST_MOVE = 0.15
"""Metres over which a hand that moves must move."""
RAISED = -0.10
"""Metres over the shoulder at which a wrist counts as raised: some wave at the height of the shoulder."""
RAISED_TIME = 0.2
"""Seconds for which a raised hand must be up."""

_PEOPLE = ("a", "b")
_BOWS = ("bow",)
_WAY = re.compile(r"\bto the (left|right)\b", re.IGNORECASE)
_RAISES = ("wave", "bye", "raise-hand", "raise-hands", "call", "cheer")


@dataclass(frozen=True)
class Verdict:
    """One thing that was checked.

    Attributes:
        check: one of :data:`CHECKS`.
        passed: whether the motion does it.
        value: what was measured: metres (side: how much further the named limb moves; contact: least
            distance; distance: last less first), degrees (facing) or seconds (order: second less first).
    """

    check: str
    passed: bool
    value: float


@dataclass(frozen=True)
class Task:
    """A sentence and what a motion of it should show.

    Attributes:
        caption: the sentence; a side counts only where its words name it.
        family: the kind of interaction; in "sequence" one person does all that is ordered.
        events: as in a scene.
        frames: length at 30 fps.
    """

    caption: str
    family: str
    events: Events
    frames: int = 120

    @property
    def checks(self) -> tuple[str, ...]:
        """The checks that :func:`judge` counts for it."""
        due = {
            "side": bool(named_sides(self.caption, self.events)),
            "contact": bool(self.events.get("contact")),
            "distance": self.events.get("distance") is not None,
            "facing": bool(self.events.get("facing")),
            "order": _timed(self) is not None,
        }
        return tuple(check for check in CHECKS if due[check])


def judge(duet: Duet, task: Task) -> list[Verdict]:
    """All verdicts on one duet of 22 SMPL joints, in the order of :data:`CHECKS`."""
    rules = {"side": _side, "contact": _contact, "distance": _distance, "facing": _facing, "order": _order}
    return [rules[check](duet, task) for check in task.checks]


# ---- side ----------------------------------------------------------------------------------------
def named_sides(caption: str, events: Events) -> list[tuple[str, tuple[str, ...]]]:
    """The sides that a sentence names: (side, people of whom it may be said).

    Two people of the same side share one entry where the word comes once: the sentence then does not tell
    whose hand it is, unless it speaks of hands or arms.
    """
    sides: Mapping[str, str] = events.get("side") or {}
    found = []
    for side in ("left", "right", "both"):
        word = r"\b(both|double|two-handed|arms|hands)\b" if side == "both" else rf"\b{side}\b"
        mentions = len(re.findall(word, caption, flags=re.IGNORECASE))
        people = tuple(person for person in _PEOPLE if sides.get(person) == side)
        if not mentions or not people:
            continue
        plural = re.search(rf"\b{side} (hands|arms)\b", caption, flags=re.IGNORECASE)
        if mentions >= len(people) or plural:
            found += [(side, (person,)) for person in people]
        else:
            found.append((side, people))
    return found


def _side(duet: Duet, task: Task) -> Verdict:
    named = named_sides(task.caption, task.events)
    leads = [max(_lead(duet, person, side, task) for person in people) for side, people in named]
    return Verdict("side", all(lead > 0 for lead in leads), min(leads))


def _lead(duet: Duet, person: str, side: str, task: Task) -> float:
    """Metres by which the named limb does more than it has to; above 0 it is the one that acts.

    Where the side is a way to go ("walks off to the left"), it is how far the person gets to that side, as
    they see it before they go. Where one hand of a touches b, it is the hand that comes nearer to where it
    should touch (the other arm may swing as far for balance); else the limb that moves more relative to the
    body.
    """
    other = "left" if side == "right" else "right"
    touches = task.events.get("contact") or ()
    if person == "a" and side != "both" and len(touches) == 1 and touches[0]["a"].endswith("wrist"):
        gap = {s: min(_gap(duet, f"{s}_wrist", j) for j in _either(touches[0]["b"])) for s in (side, other)}
        return gap[other] - gap[side]
    positions = duet.people[_PEOPLE.index(person)].positions.astype(np.float64)
    if _WAY.search(task.caption):
        path = positions[:, SMPL22.index("pelvis")]
        aside = (path[-1] - path[0]) @ heading_matrix(heading(positions[:1])[0])[:, 0]
        return float(aside if side == "left" else -aside) - LEAST_MOVE
    legs = re.search(r"\b(kick\w*|foot|leg)\b", task.caption, flags=re.IGNORECASE)
    joint, root = ("ankle", "hip") if legs else ("wrist", "shoulder")
    travel = {s: limb_travel(positions, f"{s}_{joint}", f"{s}_{root}") for s in ("left", "right")}
    if side == "both":
        return min(travel.values()) - max(LEAST_MOVE, BOTH_SHARE * max(travel.values()))
    return travel[side] - max(LEAST_MOVE, travel[other])


# ---- contact -------------------------------------------------------------------------------------
def _contact(duet: Duet, task: Task) -> Verdict:
    entries = task.events["contact"]
    both_hands = len({entry["a"] for entry in entries}) > 1
    excess, gaps = [], []
    for entry in entries:
        own, other = entry["a"], entry["b"]
        hands = own.endswith("wrist") and other.endswith("wrist")
        # A sentence asks for "the shoulder" or "a hand": which one is the side's rule, not this one's.
        mine = [own] if both_hands else _either(own)
        gap = min(_gap(duet, i, j) for i in mine for j in _either(other))
        gaps.append(gap)
        excess.append(gap - (HANDS_MEET if hands else TOUCHES))
    return Verdict("contact", max(excess) < 0, gaps[int(np.argmax(excess))])


def _either(joint: str) -> list[str]:
    """The joint on both sides of the body."""
    side, _, part = joint.partition("_")
    return [f"left_{part}", f"right_{part}"] if side in ("left", "right") else [joint]


def _gap(duet: Duet, own: str, other: str) -> float:
    gap = duet.a.positions[:, SMPL22.index(own)] - duet.b.positions[:, SMPL22.index(other)]
    return float(np.linalg.norm(gap, axis=-1).min())


# ---- distance and facing -------------------------------------------------------------------------
def _distance(duet: Duet, task: Task) -> Verdict:
    kind = task.events["distance"]
    distance = pelvis_distance(duet)
    start, end = float(distance[:5].mean()), float(distance[-5:].mean())
    if kind == "approach":
        return Verdict("distance", end - start < -CHANGES, end - start)
    if kind == "part":
        # A person who pushes the other away may first walk up: measure from the smallest distance.
        growth = end - float(distance.min())
        return Verdict("distance", growth > CHANGES, growth)
    return Verdict("distance", abs(end - start) <= CHANGES, end - start)


def _facing(duet: Duet, task: Task) -> Verdict:
    third = duet.num_frames // 3
    angle = float(facing_angle(duet)[:, third : max(2 * third, third + 1)].mean())
    return Verdict("facing", angle < FACES, angle)


# ---- order ---------------------------------------------------------------------------------------
def _timed(task: Task) -> list[tuple[str, str]] | None:
    """(person, action) in their order, or None if a rule cannot distinguish the two in time."""
    order = task.events.get("order") or ()
    if len(order) != 2 or any(action not in _BOWS + _RAISES for action in order):
        return None
    if task.family != "sequence":
        return [("a", order[0]), ("b", order[1])]
    # One person does both: of two raised hands a rule cannot see which is which.
    if (order[0] in _BOWS) == (order[1] in _BOWS):
        return None
    return [("a", order[0]), ("a", order[1])]


def action_time(positions: Array, action: str, fps: float) -> float | None:
    """The time in seconds of a person's (T, 22, 3) bow or raised hand; None if there is none.

    A bow is timed at the head's lowest frame, 25 cm or more below its usual height; a raised hand at the middle of
    the frames in which a wrist is up (:data:`RAISED`).
    """
    if action in _BOWS:
        height = positions[:, SMPL22.index("head"), 1]
        frame = int(height.argmin())
        return frame / fps if np.percentile(height, 90) - height[frame] > DIPS else None
    raised = [
        positions[:, SMPL22.index(f"{side}_wrist"), 1] - positions[:, SMPL22.index(f"{side}_shoulder"), 1]
        for side in ("left", "right")
    ]
    frames = np.flatnonzero(np.max(raised, axis=0) > RAISED)
    return float(np.median(frames)) / fps if len(frames) >= RAISED_TIME * fps else None


def _order(duet: Duet, task: Task) -> Verdict:
    people = {"a": duet.a.positions, "b": duet.b.positions}
    times = [action_time(people[person], action, duet.fps) for person, action in _timed(task) or ()]
    if times[0] is None or times[1] is None:
        return Verdict("order", False, float("nan"))
    return Verdict("order", times[0] < times[1], times[1] - times[0])
