"""Two people with the things that their plans name, and hands that take shapes; no joint moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from acts.plan import Plan
from motion import Duet
from motion.hands import MOST_GRIPS
from motion.things import MOST_THINGS, Mesh, Thing
from motion.things.hands import Hands, level, yaw_of
from motion.vectors import FLAT

from .courses import courses
from .furniture import fixtures, furniture
from .grips import grips_of_contact, grips_of_plan, grips_of_things
from .uses import uses_of

PlanFrames = tuple[Plan, int, int | None, int | None]
"""A plan, its first and last frame (None for the end), and the number of its beat, where there are several."""
Row = dict[str, Any]
"""A thing as a manifest holds it: its kind, its name, and what is done with it."""


def furnish(duet: Duet, plans: Sequence[PlanFrames], lengths: Sequence[float] = (), mesh: Mesh | None = None) -> Duet:
    """Two people with things, shapes of hands, and a row a thing in the manifest.

    Args:
        duet: on SMPL22.
        plans: of what they do.
        lengths: seconds of the beats into which a sentence was split, where it was.
        mesh: the surface of the first thing, in place of that of its kind; it stands beside the people where their
            words name none.
    """
    hands = Hands.of(duet)
    uses, grips = [], list(grips_of_contact(hands))
    for plan, start, stop, beat in plans:
        end = duet.num_frames if stop is None else stop
        split = lengths if beat is None else ()
        uses += uses_of(plan, start, end, split)
        grips += grips_of_plan(plan, hands, duet, start, end, split)
    rows: list[tuple[Thing, list[Row]]] = []
    moved = courses(hands, uses, mesh)
    for course in moved:
        rows += [(course.thing(), course.events), *((table, []) for table in course.tables)]
    grips = [grip for grip in (*grips, *grips_of_things(moved, duet.num_frames)) if grip.start < duet.num_frames]
    for use, people, thing in furniture(hands, uses):
        if not any(_is_same(thing, other) for other, _ in rows):
            event = {"act": use.id, "does": use.does, "by": "".join("ab"[who] for who in people)}
            rows.append((thing if mesh is None or rows else _shaped(thing, mesh), [event]))
    for fixture in fixtures(hands, uses):
        body, *leaves = fixture.things(hands.frames, hands.fps)
        if mesh is not None and not rows:
            rows.append((_shaped(body, mesh), fixture.events))
        else:
            rows += [(body, fixture.events), *((leaf, []) for leaf in leaves)]
    if mesh is not None and not rows:
        rows.append((_beside(hands, mesh), []))
    duet = replace(duet, grips=tuple(grips[-MOST_GRIPS:]))
    if not rows:
        return duet
    rows = rows[:MOST_THINGS]
    listed = [{"kind": thing.kind, "name": thing.name, "events": events} for thing, events in rows]
    manifest = {**(duet.manifest or {}), "things": listed}
    return replace(duet, things=tuple(thing for thing, _ in rows), manifest=manifest)


def _shaped(thing: Thing, mesh: Mesh) -> Thing:
    """A piece of furniture with another surface, which stands on the floor."""
    lift = np.array([0.0, -float(mesh.vertices[:, 1].min()), 0.0], dtype=np.float32)
    return Thing("own", mesh, thing.places + lift, thing.rotations, thing.name)


def _beside(hands: Hands, mesh: Mesh) -> Thing:
    """A thing on the floor beside two people."""
    one, other = (hands.joint(person, "pelvis")[0] for person in (0, 1))
    across = level(np.cross([0.0, 1.0, 0.0], other - one))
    place = (one + other) / 2 * FLAT + (0.5 + float(mesh.size[[0, 2]].max()) / 2) * across
    place[1] = -float(mesh.vertices[:, 1].min())
    return Thing.at_rest("own", mesh, place, yaw_of(-across), hands.frames)


def _is_same(one: Thing, other: Thing) -> bool:
    """True for two pieces of furniture of one kind on one spot."""
    return one.kind == other.kind and bool(abs(one.places[0] - other.places[0]).max() < 0.4)
