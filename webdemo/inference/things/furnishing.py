"""A finished result with the things that its words name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, TypeGuard

import numpy as np

from acts import Plan
from motion import SMPL22, Clip, Duet, InputError
from motion.looks import SIZES, UNSAID, grown_up, looks_of, size_of
from motion.metrics import compare
from motion.sizes import at_sizes
from motion.things import FURNITURE, MOST_THINGS, Mesh, Thing
from webdemo.inference.run import Result

from .courses import ThingCourse
from .fixtures import fixtures
from .grips import fitting, grips_of_contact, grips_of_plan, grips_of_things
from .holding import Hands, level, yaw_of
from .seats import furniture
from .uses import Use, lengths_of, uses_of

_ALIKE = 0.02
"""Share of an adult's thigh by which a child's bones may differ from those of a child's body."""
Planned = tuple[Plan, int, int | None, int | None]
"""A plan, its first and last frame (None for the end), and the number of its beat."""


def furnished(result: Result, plans: Sequence[Planned], own: Mesh | None = None, *, given: bool = False) -> Result:
    """A result whose people look as their plans say, with the things of the acts, and hands that take shapes.

    Args:
        result: of two people on SMPL22; another is returned as it is.
        plans: of the request's words.
        own: the surface that the first thing has, in place of that of its kind.
        given: a part of the motion was given, with adults: nobody is a child.

    Returns:
        the result, with ``things`` in the manifests where there are some, and with shapes of hands.
    """
    duets: list[Duet | Clip] = []
    lists: list[list[dict[str, Any]]] = []
    looks = looks_in(plan for plan, *_ in plans)
    result = _at_their_sizes(result, grown_up(looks) if given else looks)
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
        things.append(thing if own is None or things else _shaped(thing, own))
        event = {"act": use.id, "does": use.does, "by": "".join("ab"[who] for who in people)}
        rows.append({"kind": things[-1].kind, "name": thing.name, "events": [event]})
    for fixture in fixtures(hands, uses):
        body, *leaves = fixture.things(hands.frames, hands.fps)
        shaped = own is not None and not things
        things += [_shaped(body, own)] if shaped and own is not None else [body, *leaves]
        rows.append({"kind": things[-1].kind if shaped else body.kind, "name": body.name, "events": fixture.events})
        rows += [] if shaped else [{"kind": leaf.kind, "name": leaf.name, "events": []} for leaf in leaves]
    if own is not None and not things:
        things.append(_beside(hands, own))
        rows.append({"kind": "own", "name": "own", "events": []})
    if not things:
        return duet, []
    things, rows = things[:MOST_THINGS], rows[:MOST_THINGS]
    manifest = {**(duet.manifest or {}), "things": rows}
    return replace(duet, things=tuple(things), manifest=manifest), rows


def looks_in(plans: Iterable[Plan]) -> tuple[str, str]:
    """The looks of the two people, each as the first plan that says something about them has it."""
    people = [("", ""), ("", "")]
    for plan in plans:
        people = [(sex or p.sex, age or p.age) for (sex, age), p in zip(people, plan.people, strict=True)]
    return looks_of(people)


def _at_their_sizes(result: Result, looks: tuple[str, str]) -> Result:
    """A result whose people look as their plans say, at the sizes of these looks; who looks somehow already, stays so.

    Of people who are smaller than they were made only what is shown is measured.
    """
    if looks == UNSAID:
        return replace(result, duets=tuple(map(_by_their_bones, result.duets)))
    duets, readouts = list(result.duets), list(result.readouts)
    a, b = (size_of(look) for look in looks)
    for i, duet in enumerate(duets):
        if not _is_made(duet):
            continue
        if (a, b) != (1.0, 1.0):
            duet = duet.with_positions(at_sizes(duet.positions, (a, b)))
            readouts[i : i + 1] = [{**each, **compare(None, duet)} for each in readouts[i : i + 1]]
        duets[i] = replace(duet, looks=looks)
    manifest = {**result.manifest, "looks": list(looks)}
    return replace(result, duets=tuple(duets), readouts=tuple(readouts), manifest=manifest)


def _by_their_bones(duet: Duet | Clip) -> Duet | Clip:
    """Two people who are not described; one with a child's bones, such as the given person of a reaction, is one."""
    if not _is_made(duet):
        return duet
    hip, knee = (SMPL22.index(f"left_{part}") for part in ("hip", "knee"))
    thighs = np.linalg.norm(duet.positions[:, :, knee] - duet.positions[:, :, hip], axis=-1).mean(axis=1)
    a, b = np.abs(thighs / SMPL22.bone_lengths[knee] - SIZES["boy"]) < _ALIKE
    return replace(duet, looks=("boy" if a else UNSAID[0], "girl" if b else UNSAID[1]))


def _is_made(duet: Duet | Clip) -> TypeGuard[Duet]:
    """True for two people on SMPL22 whom nobody has dressed yet."""
    on_bodies = duet.skeleton.joint_names == SMPL22.joint_names
    return isinstance(duet, Duet) and on_bodies and duet.looks == UNSAID


def _shaped(thing: Thing, own: Mesh) -> Thing:
    """A piece of furniture with another surface, which stands on the floor."""
    lift = np.array([0.0, -float(own.vertices[:, 1].min()), 0.0], dtype=np.float32)
    return Thing("own", own, thing.places + lift, thing.rotations, thing.name)


def _beside(hands: Hands, own: Mesh) -> Thing:
    """One's own thing on the floor beside two people, where the words name none."""
    one, other = (hands.joint(person, "pelvis")[0] for person in (0, 1))
    across = level(np.cross([0.0, 1.0, 0.0], other - one))
    place = (one + other) / 2 * [1, 0, 1] + (0.5 + float(own.size[[0, 2]].max()) / 2) * across
    place[1] = -float(own.vertices[:, 1].min())
    return Thing.at_rest("own", own, place, yaw_of(-across), hands.frames)


def _same(one: Thing, other: Thing) -> bool:
    """True for two pieces of furniture of one kind on one spot."""
    return one.kind == other.kind and bool(abs(one.places[0] - other.places[0]).max() < 0.4)


def _courses(hands: Hands, uses: Iterable[Use], own: Mesh | None) -> list[ThingCourse]:
    """One course a thing: uses of one name follow each other, and two who each hold one have two."""
    found: dict[tuple[str, str], list[Use]] = {}
    for use in uses:
        if use.does in ("sits", "passes", "faces", "opens", "closes", ""):
            continue
        if use.kind in FURNITURE and use.does != "carries":
            continue
        single = use.does in ("holds", "fights", "plays", "uses") and len(use.agents) == 2
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
