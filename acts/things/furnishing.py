"""Two people with the things that their plans name, and hands that take shapes; no joint moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from acts.plan import Plan
from motion import Duet
from motion.hands import MOST_GRIPS
from motion.things import MOST_THINGS, Thing
from motion.things.hands import Hands

from .courses import courses
from .furniture import fixtures, furniture
from .grips import grips_of_contact, grips_of_plan, grips_of_things
from .uses import uses_of

PlanFrames = tuple[Plan, int, int | None, int | None]
"""A plan, its first and last frame (None for the end), and the number of its beat, where there are several."""
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
