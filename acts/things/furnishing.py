"""Two people with the things that their plans name, and hands that take shapes; no joint moves. What is seen of acts
with things follows from these.

Fingers take shape by what hands touch, by the acts of the plan, and by what they hold.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from acts.checking import Verdict, decided, rules_of
from acts.lexicon import NOUNS, is_fixture, is_listed, kind_of, lexicon
from acts.plan import Act, Plan, PlanFrames
from motion import SMPL22, Duet
from motion.hands import MOST_GRIPS, Grip
from motion.metrics.bodies import point_segment_distance
from motion.metrics.sentences.joints import Motion, stretches
from motion.metrics.sentences.language import mask_of, masks
from motion.skeleton import SIDES
from motion.things import MOST_THINGS, Thing
from motion.things.hands import Hands
from motion.things.sight import looked_at
from motion.vectors import Array

from .courses import ThingCourse, courses
from .furniture import BODIES, LEAVES, TAKES, fixtures, furniture
from .uses import act_frames, uses_of

Row = dict[str, Any]
"""A thing as a manifest holds it: its kind, its name, and what is done with it."""


def furnish(duet: Duet, plans: Sequence[PlanFrames], lengths: Sequence[float]) -> Duet:
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
    moved = courses(hands, uses) if uses else []
    for course in moved:
        rows += [(course.thing(), course.events), *((table, []) for table in course.tables)]
    grips = [grip for grip in (*grips, *grips_of_things(moved, duet.num_frames)) if grip.start < duet.num_frames]
    duet = replace(duet, grips=tuple(grips[-MOST_GRIPS:]))
    if not uses:
        return duet
    for use, people, thing in furniture(hands, uses):
        if not any(_is_same(thing, other) for other, _ in rows):
            event = {"act": use.id, "does": use.does, "by": "".join("ab"[who] for who in people)}
            rows.append((thing, [event]))
    for fixture in fixtures(hands, uses):
        body, *leaves = fixture.things(hands.frames, hands.fps)
        rows += [(body, fixture.events), *((leaf, []) for leaf in leaves)]
    if not rows:
        return duet
    rows = rows[:MOST_THINGS]
    listed = [{"kind": thing.kind, "name": thing.name, "events": events} for thing, events in rows]
    manifest = {**(duet.manifest or {}), "things": listed}
    return replace(duet, things=tuple(thing for thing, _ in rows), manifest=manifest)


def drawn_otherwise(rows: Sequence[Row], plans: Sequence[PlanFrames] = ()) -> tuple[str, ...]:
    """A sentence each on the things that are drawn as others, and on those that plans name and that are not drawn.

    Args:
        rows: of a manifest.
        plans: of what people do.
    """
    known, drawn = lexicon().entries, {word for row in rows for word in (row["name"], row["kind"])}
    acts = (act for plan, *_ in plans for act in plan.acts if act.happens and act.act in known)
    nouns = (act.thing or known[act.act].prop for act in acts)
    named = [noun for noun in nouns if (kind_of(noun) or is_listed(noun, "shapeless")) and not is_fixture(noun)]
    said = {
        "Drawn as something like it": [
            f"{row['name']} as a {row['kind']}" for row in rows if is_listed(row["name"], "like")
        ],
        "Not drawn": [noun for noun in named if drawn.isdisjoint((noun, kind_of(noun)))],
    }
    return tuple(
        f"{head}: {', '.join(f'the {each}' for each in dict.fromkeys(own))}." for head, own in said.items() if own
    )


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
_HELD = tomllib.loads(NOUNS.read_text(encoding="utf-8"))["held"]
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
    words = plan.text(act.words).lower()
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


# ---- verdicts on acts that the things of a motion show ------------------------------------------------

LOOKS = "look-at-thing"
"""The entry of the lexicon that says that somebody looks at something."""
LEAST = 0.4
"""Seconds for which somebody must look at a thing."""
AT_HAND = 0.35
"""Metres from a palm to a thing of which it moves a part, at most."""
_TURNED, _SHIFTED = np.radians(30.0), 0.1
"""Radians and metres by which a part moves at least that is opened or closed."""
_BEGINS = 0.05
"""The share of that with which its movement begins."""


def judge_things(
    verdicts: Sequence[Verdict], plan: Plan, duet: Duet, start: int, stop: int, lengths: Sequence[float]
) -> tuple[Verdict, ...]:
    """The verdicts, of which those on acts with a thing that is in the scene follow from the things.

    A look at a thing follows from where the face points. Something is opened or closed where a part of it begins to
    move while one of the act's agents has a hand at it, and handed over where it goes from hand to hand.

    Args:
        verdicts: on the acts of the plan.
        plan: of the frames from ``start`` to ``stop``.
        duet: with its things.
        start, stop: frames.
        lengths: seconds of the beats into which the sentence was split, where it was.
    """
    frames = {act.id: (act, first, last) for act, first, last in act_frames(plan, start, stop, lengths)}
    return tuple(_judge(each, plan, duet, *frames[each.id]) if each.id in frames else each for each in verdicts)


def _judge(verdict: Verdict, plan: Plan, duet: Duet, act: Act, first: int, last: int) -> Verdict:
    """The verdict on an act of some frames."""
    if act.act == LOOKS and act.thing and last > first:
        kinds = _kinds(act.thing)
        seen = [i for i, thing in enumerate(duet.things) if thing.kind in kinds]
        if not seen:
            return verdict
        seconds = min(_seconds(duet, who, first, last, seen) for who in act.agents)
        return decided(verdict, act, plan, done=seconds >= LEAST, measure=f"looks at it for {seconds:.1f} s")
    entry = lexicon().entries.get(act.act)
    if entry is not None and entry.thing in ("gives", "takes") and verdict.done is not None and act.happens:
        return _passed(verdict, act, plan, duet, first, last)
    if verdict.done is not None or entry is None or entry.thing not in ("opens", "closes"):
        return verdict
    kind = kind_of(act.thing or "")
    moving = {leaf.kind for leaves in LEAVES.values() for leaf in leaves if leaf.moved_by == kind}
    parts = [thing for thing in duet.things if thing.kind in moving]
    if not parts:
        return verdict
    frames = range(first, min(last + round(TAKES * duet.fps), duet.num_frames))
    starts = [frame for part in parts if (frame := _starts(part, frames)) is not None]
    if not starts:
        return decided(verdict, act, plan, done=False, measure="nothing of it moves")
    whole = [*parts, *(thing for thing in duet.things if thing.kind == BODIES.get(kind, kind))]
    palms = Hands.of(duet).palms[["ab".index(who) for who in act.agents], :, min(starts)].reshape(-1, 3)
    near = min(_away(palms, thing, min(starts)) for thing in whole)
    measure = f"hand {100 * near:.0f} cm from it as it moves"
    return decided(verdict, act, plan, done=near <= AT_HAND, measure=measure)


def _passed(verdict: Verdict, act: Act, plan: Plan, duet: Duet, first: int, last: int) -> Verdict:
    """The verdict on what is handed over: done where the thing goes from hand to hand, and not judged without one."""
    rows = (duet.manifest or {}).get("things", ())
    events = [event for row in rows for event in row["events"] if event["act"] == act.id]
    at = next((event["at"] for event in events if "to" in event and first <= event["at"] * duet.fps < last + 9), None)
    if at is not None:
        return decided(verdict, act, plan, done=True, measure=f"it goes from hand to hand at {at:.1f} s")
    if why := next((event["why"] for event in events if "why" in event), ""):
        return decided(verdict, act, plan, done=False, measure=why)
    if len(act.agents) == 2:
        return replace(verdict, done=None, measure="only one thing is drawn")
    drawn = not act.thing or any(row["name"] == act.thing for row in rows)
    return verdict if drawn else replace(verdict, done=None, measure=f"no {act.thing} is drawn")


def _kinds(noun: str) -> set[str]:
    """The kinds of things that a noun may stand for: a window is its frame, its sashes and its curtains."""
    kind = kind_of(noun)
    body = BODIES.get(kind, kind)
    return {kind, body, *(leaf.kind for leaf in LEAVES.get(body, ()))} - {""}


def _seconds(duet: Duet, who: str, first: int, last: int, things: Sequence[int]) -> float:
    """Seconds for which a person's face points to one of some things."""
    me = "ab".index(who)
    people = duet.positions[:, first:last].astype(np.float64)
    cut = [thing.cut(first, last) for thing in duet.things]
    return float(np.isin(looked_at(cut, people[me], people[1 - me]), things).sum() / duet.fps)


def _starts(part: Thing, frames: range) -> int | None:
    """The frame of some in which a part begins to move; None where it hardly does."""
    turns, places = (track[frames.start : frames.stop].astype(np.float64) for track in (part.rotations, part.places))
    cosines = (np.einsum("tij,ij->t", turns, turns[0]) - 1) / 2
    turned = np.arccos(np.clip(cosines, -1.0, 1.0)) / _TURNED
    moved = np.maximum(turned, np.linalg.norm(places - places[0], axis=1) / _SHIFTED)
    return frames[int(np.argmax(moved > _BEGINS))] if moved.max() >= 1 else None


def _away(palms: Array, thing: Thing, frame: int) -> float:
    """The metres from the nearest of some palms (P, 3) to the box around a thing."""
    local = (palms - thing.places[frame]) @ thing.rotations[frame]
    low, high = thing.mesh.vertices.min(axis=0), thing.mesh.vertices.max(axis=0)
    return float(np.linalg.norm(local - np.clip(local, low, high), axis=1).min())
