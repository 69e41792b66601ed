"""Two people with the things that their plans name, and hands that take shapes; no joint moves.

Fingers take shape by what hands touch, by the acts of the plan, and by what they hold.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acts.checking import rules_of
from acts.lexicon import lexicon
from acts.plan import Act, Plan, PlanFrames
from motion import SMPL22, Duet
from motion.hands import MOST_GRIPS, SIDES, Grip
from motion.metrics.bodies import point_segment_distance
from motion.metrics.sentences.joints import Motion, stretches
from motion.metrics.sentences.language import mask_of, masks
from motion.things import MOST_THINGS, Thing
from motion.things.hands import Hands

from .courses import ThingCourse, courses
from .furniture import fixtures, furniture
from .uses import act_frames, uses_of

Row = dict[str, Any]
"""A thing as a manifest holds it: its kind, its name, and what is done with it."""


def furnish(duet: Duet, plans: Sequence[PlanFrames], lengths: Sequence[float] = ()) -> Duet:
    """Two people with things, shapes of hands, and a row a thing in the manifest.

    Args:
        duet: on SMPL22.
        plans: of what they do.
        lengths: seconds of the beats into which a sentence was split, where it was.
    """
    hands = Hands.of(duet)
    uses, grips = [], list(grips_of_contact(hands))
    for plan, start, stop, beat in plans:
        end = duet.num_frames if stop is None else stop
        split = lengths if beat is None else ()
        uses += uses_of(plan, start, end, split)
        grips += grips_of_plan(plan, hands, duet, start, end, split)
    rows: list[tuple[Thing, list[Row]]] = []
    moved = courses(hands, uses)
    for course in moved:
        rows += [(course.thing(), course.events), *((table, []) for table in course.tables)]
    grips = [grip for grip in (*grips, *grips_of_things(moved, duet.num_frames)) if grip.start < duet.num_frames]
    for use, people, thing in furniture(hands, uses):
        if not any(_is_same(thing, other) for other, _ in rows):
            event = {"act": use.id, "does": use.does, "by": "".join("ab"[who] for who in people)}
            rows.append((thing, [event]))
    for fixture in fixtures(hands, uses):
        body, *leaves = fixture.things(hands.frames, hands.fps)
        rows += [(body, fixture.events), *((leaf, []) for leaf in leaves)]
    duet = replace(duet, grips=tuple(grips[-MOST_GRIPS:]))
    if not rows:
        return duet
    rows = rows[:MOST_THINGS]
    listed = [{"kind": thing.kind, "name": thing.name, "events": events} for thing, events in rows]
    manifest = {**(duet.manifest or {}), "things": listed}
    return replace(duet, things=tuple(thing for thing, _ in rows), manifest=manifest)


def _is_same(one: Thing, other: Thing) -> bool:
    """True for two pieces of furniture of one kind on one spot."""
    return one.kind == other.kind and bool(abs(one.places[0] - other.places[0]).max() < 0.4)


# ---- the shapes of hands ---------------------------------------------------------------------------------
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
_STARTS = [SMPL22.index(name) for name in ("pelvis", "spine2", "left_shoulder", "left_shoulder", "right_shoulder")]
_ENDS = [SMPL22.index(name) for name in ("spine2", "neck", "right_shoulder", "left_elbow", "right_elbow")]
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
    return [
        grip
        for act, first, last in act_frames(plan, start, stop, lengths)
        for grip in _of_act(act, plan, hands, part, start, first, last)
    ]


def _of_act(act: Act, plan: Plan, hands: Hands, part: Motion, start: int, first: int, last: int) -> Iterator[Grip]:
    entry = lexicon().entries.get(act.act)
    words = plan.text(act.words).lower() if act.words else ""
    shape = "thumbs up" if _THUMBS.search(words) else entry.hand if entry else ""
    if not shape or entry is None:
        return
    if shape == "clasp":
        yield from _clasps(hands, MET, first, last)
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
            one = SIDES[hands.better_side(person, i, j, act.side or "")]
            for side in SIDES if act.act in _BOTH or shape == "fist" else (one,):
                yield Grip(person, side, shape, i, j)


def _spans(mask: NDArray[np.bool_], fps: float, first: int = 0, last: int | None = None) -> Iterator[tuple[int, int]]:
    """The stretches of a mask that overlap some frames, with a moment before each in which fingers get ready."""
    stop = len(mask) if last is None else min(last + round(0.5 * fps), len(mask))
    begin = max(first - round(0.5 * fps), 0)
    for i, j in stretches(mask, fps, pause=0.3) if mask.any() else ():
        i, j = max(i - round(0.1 * fps), begin), min(j, stop)
        if j - i >= _SHORTEST * fps:
            yield i, j


def grips_of_contact(hands: Hands) -> Iterator[Grip]:
    """Palms that meet clasp each other, and one that lies on the other's trunk or arm is flat."""
    for person in (0, 1):
        body = hands.positions[1 - person]
        for side in (0, 1):
            palm = hands.palms[person, side]
            near = point_segment_distance(palm[:, None], body[:, _STARTS], body[:, _ENDS]).min(axis=1)
            for i, j in _spans(near < LAID, hands.fps):
                yield Grip(person, SIDES[side], "flat", i, j)
    yield from _clasps(hands, TOUCH)


def _clasps(hands: Hands, metres: float, first: int = 0, last: int | None = None) -> Iterator[Grip]:
    """The palms of the two that are within some metres of each other, in frames from ``first`` to ``last``."""
    gaps = np.linalg.norm(hands.palms[0][:, None] - hands.palms[1][None], axis=-1)
    for one, other in np.ndindex(2, 2):
        for i, j in _spans(gaps[one, other] < metres, hands.fps, first, last):
            yield Grip(0, SIDES[one], "clasp", i, j)
            yield Grip(1, SIDES[other], "clasp", i, j)


def grips_of_things(courses: Iterable[ThingCourse], frames: int) -> Iterator[Grip]:
    """The hands of those who hold things."""
    for course in courses:
        shapes = _HELD.get(course.kind, ("clasp", "clasp"))
        ends = [frame for frame, _, _ in course.holders[1:]] + [frames]
        for (start, who, sides), stop in zip(course.holders, ends, strict=True):
            for person, side in product(who, sides) if stop > start else ():
                yield Grip(person, SIDES[side], shapes[side], start, stop)
