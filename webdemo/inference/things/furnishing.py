"""A finished result with the things that its words name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from acts import Plan
from motion import SMPL22, Clip, Duet, InputError
from motion.things import FURNITURE, MOST_THINGS, Mesh, Thing

from ..requests import Result
from .courses import ThingCourse
from .grips import fitting, grips_of_contact, grips_of_plan, grips_of_things
from .holding import Hands
from .seats import furniture
from .uses import Use, lengths_of, uses_of

Planned = tuple[Plan, int, int | None, int | None]
"""A plan, its first and last frame (None for the end), and the number of its beat."""


def furnished(result: Result, plans: Sequence[Planned], own: Mesh | None = None) -> Result:
    """A result whose duets have the things that their plans' acts are done with, and hands that take shapes.

    Args:
        result: of two people on SMPL22; another is returned as it is.
        plans: of the request's words.
        own: the surface that the first thing has, in place of that of its kind.

    Returns:
        the result, with ``things`` in the manifests where there are some, and with shapes of hands.
    """
    duets: list[Duet | Clip] = []
    lists: list[list[dict[str, Any]]] = []
    for duet in result.duets:
        made, rows = _furnished(duet, plans, lengths_of(result.manifest), own)
        duets.append(made)
        lists.append(rows)
    manifest = {**result.manifest, "things": lists[0]} if any(lists) else result.manifest
    return replace(result, duets=tuple(duets), manifest=manifest)


def _furnished(
    duet: Duet | Clip, plans: Sequence[Planned], lengths: Sequence[float], own: Mesh | None
) -> tuple[Duet | Clip, list[dict[str, Any]]]:
    if not isinstance(duet, Duet) or duet.skeleton.joint_names != SMPL22.joint_names:
        return duet, []
    hands = Hands.of(duet)
    uses: list[Use] = []
    grips = list(grips_of_contact(hands))
    for plan, start, stop, beat in plans:
        end = duet.num_frames if stop is None else stop
        split = lengths if beat is None else ()
        uses += uses_of(plan, start, end, split)
        grips += grips_of_plan(plan, hands, duet, start, end, split)
    things, rows = list[Thing](), list[dict[str, Any]]()
    courses = _courses(hands, uses, own)
    for course in courses:
        thing = course.made()
        things += [thing, *course.tables]
        rows.append({"kind": thing.kind, "name": thing.name, "events": course.events})
        rows += [{"kind": table.kind, "name": table.name, "events": []} for table in course.tables]
    grips += grips_of_things(courses, duet.num_frames)
    duet = replace(duet, grips=fitting(grips, duet.num_frames))
    for use, people, thing in furniture(hands, uses):
        if any(_same(thing, other) for other in things):
            continue
        things.append(thing)
        event = {"act": use.id, "does": use.does, "by": "".join("ab"[who] for who in people)}
        rows.append({"kind": thing.kind, "name": thing.name, "events": [event]})
    if not things:
        return duet, []
    things, rows = things[:MOST_THINGS], rows[:MOST_THINGS]
    manifest = {**(duet.manifest or {}), "things": rows}
    return replace(duet, things=tuple(things), manifest=manifest), rows


def _same(one: Thing, other: Thing) -> bool:
    """True for two pieces of furniture of one kind on one spot."""
    return one.kind == other.kind and bool(abs(one.places[0] - other.places[0]).max() < 0.4)


def _courses(hands: Hands, uses: Iterable[Use], own: Mesh | None) -> list[ThingCourse]:
    """One course a thing: uses of one name follow each other, and two who each hold one have two."""
    found: dict[tuple[str, str], list[Use]] = {}
    for use in uses:
        if use.does in ("sits", "passes", ""):
            continue
        if use.kind in FURNITURE and use.does != "carries":
            continue
        single = use.does in ("holds", "fights", "plays") and len(use.agents) == 2
        for who in use.agents if single else (None,):
            mine = use if who is None else replace(use, agents=(who,), other=None)
            found.setdefault((use.name, "" if who is None else "ab"[who]), []).append(mine)
    courses: list[ThingCourse] = []
    for several in found.values():
        try:
            courses.append(ThingCourse(hands, several, own if not courses else None))
        except InputError:  # a size that its kind cannot have
            continue
    return courses
