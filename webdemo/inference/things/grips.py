"""Finger shapes of a finished motion: by what hands touch, by the acts of the plan, and by what they hold."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from acts import Act, Plan, lexicon
from acts.checking import rules_of
from motion import SMPL22, Duet
from motion.hands import MOST_GRIPS, SIDES, Grip
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import mask_of, masks
from motion.metrics.sentences.stretches import stretches

from .courses import ThingCourse
from .holding import Hands
from .uses import act_frames

Array = NDArray[np.floating]

TOUCH = 0.11
"""Metres between two palms, at most, that clasp each other."""
LAID = 0.16
"""Metres from a palm to the middle line of the other's trunk or arm, at most, where it lies flat on it."""
MET = 0.28
"""The same between two palms whose act has them clasp: hands reach for each other before they touch."""
_THUMBS = re.compile(r"\bthumbs?[ -]up\b")
_SHORTEST = 0.15
"""Seconds of a touch, at least."""
_BOTH = frozenset(("clap", "pray", "push", "hands-on-hips", "rub-hands", "surrender"))
"""Acts for which both hands take the shape."""
_BONES = [
    (SMPL22.index(a), SMPL22.index(b))
    for a, b in (
        ("pelvis", "spine2"),
        ("spine2", "neck"),
        ("left_shoulder", "right_shoulder"),
        ("left_shoulder", "left_elbow"),
        ("right_shoulder", "right_elbow"),
    )
]
"""What palms are laid on, as lines between joints."""
_HELD = {
    "sword": ("fist", "fist"),
    "stick": ("fist", "fist"),
    "umbrella": ("fist", "fist"),
    "bag": ("fist", "fist"),
    "flower": ("pinch", "pinch"),
    "ring": ("pinch", "pinch"),
    "guitar": ("grasp", "pinch"),
    "cup": ("grasp", "grasp"),
}
"""Shapes of the left and the right hand by the kind of the thing they hold; others are clasped."""


def grips_of_plan(plan: Plan, hands: Hands, duet: Duet, start: int, stop: int, lengths: Sequence[float]) -> list[Grip]:
    """The shapes that the acts of a plan give hands."""
    part = Motion(duet.positions[:, start:stop], duet.fps)
    found: list[Grip] = []
    for act, first, last in act_frames(plan, start, stop, lengths):
        found += _of_act(act, plan, hands, part, start, first, last)
    return found


def _of_act(act: Act, plan: Plan, hands: Hands, part: Motion, start: int, first: int, last: int) -> Iterator[Grip]:
    entry = lexicon().entries.get(act.act)
    words = plan.text(act.words).lower() if act.words else ""
    shape = "thumbs up" if _THUMBS.search(words) else entry.hand if entry else ""
    if not shape or entry is None:
        return
    if shape == "clasp":
        gaps = np.linalg.norm(hands.palms[0][:, None] - hands.palms[1][None], axis=-1)
        for one, other in np.ndindex(2, 2):
            for i, j in _spans(gaps[one, other] < MET, hands.fps, first, last):
                yield Grip(0, SIDES[one], shape, i, j)
                yield Grip(1, SIDES[other], shape, i, j)
        return
    for who in act.agents:
        person = "ab".index(who)
        seen = np.zeros(hands.frames, dtype=bool)
        for rule in rules_of(act, entry, who)[:1]:
            for mask in masks(rule)[:1]:
                seen[start : start + part.frames] = mask_of(mask, part)
        if shape in ("fist", "thumbs up") or not seen[first:last].any():
            seen[:] = shape in ("fist", "thumbs up")
        for i, j in _spans(seen, hands.fps, first, last):
            sides = (
                SIDES
                if act.act in _BOTH or shape == "fist"
                else (SIDES[hands.better_side(person, i, j, act.side or "")],)
            )
            for side in sides:
                yield Grip(person, side, shape, i, j)


def _spans(mask: NDArray[np.bool_], fps: float, first: int = 0, last: int | None = None) -> Iterator[tuple[int, int]]:
    """The stretches of a mask that overlap some frames, with a moment before each in which fingers get ready."""
    stop = len(mask) if last is None else min(last + round(0.5 * fps), len(mask))
    begin = max(first - round(0.5 * fps), 0)
    for i, j in stretches(mask, fps, pause=0.3):
        i, j = max(i - round(0.1 * fps), begin), min(j, stop)
        if j - i >= _SHORTEST * fps:
            yield i, j


def grips_of_contact(hands: Hands) -> Iterator[Grip]:
    """Palms that meet clasp each other, and one that lies on the other's trunk or arm is flat."""
    for person in (0, 1):
        for side in (0, 1):
            palm = hands.palms[person, side]
            near = np.stack([_to_line(palm, hands.positions[1 - person], bone) for bone in _BONES]).min(axis=0)
            for i, j in _spans(near < LAID, hands.fps):
                yield Grip(person, SIDES[side], "flat", i, j)
    gaps = np.linalg.norm(hands.palms[0][:, None] - hands.palms[1][None], axis=-1)
    for one, other in np.ndindex(2, 2):
        for i, j in _spans(gaps[one, other] < TOUCH, hands.fps):
            yield Grip(0, SIDES[one], "clasp", i, j)
            yield Grip(1, SIDES[other], "clasp", i, j)


def _to_line(points: Array, body: Array, bone: tuple[int, int]) -> Array:
    """(T,) metres from points (T, 3) to a bone of a body (T, 22, 3)."""
    start, along = body[:, bone[0]], body[:, bone[1]] - body[:, bone[0]]
    away = points - start
    share = np.einsum("ti,ti->t", away, along) / np.maximum(np.einsum("ti,ti->t", along, along), 1e-9)
    return np.linalg.norm(away - np.clip(share, 0, 1)[:, None] * along, axis=1)


def grips_of_things(courses: Iterable[ThingCourse], frames: int) -> Iterator[Grip]:
    """The hands of those who hold things."""
    for course in courses:
        shapes = _HELD.get(course.kind, ("clasp", "clasp")) if course.mesh is None else ("clasp", "clasp")
        ends = [frame for frame, _, _ in course.holders[1:]] + [frames]
        for (start, who, sides), stop in zip(course.holders, ends, strict=True):
            if stop <= start:
                continue
            for person in who:
                for side in sides:
                    yield Grip(person, SIDES[side], shapes[side], start, stop)


def fitting(grips: Iterable[Grip], frames: int) -> tuple[Grip, ...]:
    """Grips within a motion, not too many."""
    kept = [grip for grip in grips if grip.start < frames]
    return tuple(kept[-MOST_GRIPS:])
