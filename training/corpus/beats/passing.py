"""Ways past each other: both walk, or one skips past the other who stands."""

from __future__ import annotations

from ..cues import STILL
from ..library import pick
from .moves import ahead, leftwards
from .performer import bearing
from .play import Play


def walk_past(play: Play, i: int) -> None:
    """Both go past each other without stopping."""
    rng = play.rng
    start = play.sync()
    styles = []
    aside = pick(rng, (-1, 1)) * rng.uniform(0.8, 1.1)
    spots = [person.spot for person in play.people]
    for k in (i, 1 - i):
        person, goal = play.people[k], spots[1 - k]
        way = bearing(goal - person.spot)
        target = goal + aside * leftwards(way) + rng.uniform(0.3, 0.8) * ahead(way)
        # Each keeps to their own side from the middle on.
        styles.append(person.go(target, None, stop=False).style)
    play.note(("walk-past", "walk-past"), start, i=i, relation="while", styles=tuple(styles))


def skip_past(play: Play, i: int) -> None:
    """i skips past the other, who stands."""
    rng = play.rng
    start = play.sync()
    own, other = play.people[i], play.people[1 - i]
    way = bearing(other.spot - own.spot)
    aside = pick(rng, (-1, 1)) * rng.uniform(0.8, 1.1)
    target = other.spot + aside * leftwards(way) + rng.uniform(0.4, 1.2) * ahead(way)
    own.go(target, None, action="skip", stop=False)
    play.note(("skip", STILL), start, i=i, relation="while")
