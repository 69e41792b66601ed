"""The stage of a beat: by its acts, by its phrases, or by the acts that its words are read as."""

from __future__ import annotations

from functools import lru_cache

from . import beginnings, idle, moves, postures
from .beats import Beat
from .contacts import contact
from .gestures import gestures
from .holds import hold, leads_by_both_hands, twirls
from .lifts import lift
from .roles import of_each
from .scripting import understood
from .staging import staged
from .strikes import strike
from .told import Told


def told_by(beat: Beat) -> Told:
    """Reads a beat by its acts, by those that its words are read as, or by its phrases where none is read."""
    if beat.acts:
        return staged(beat.acts)
    plan = understood(beat.sentence)
    return of_words(beat.sentence) if plan is None else staged(plan.acts)


@lru_cache(maxsize=512)
def of_words(sentence: str) -> Told:
    """Reads a sentence for the stage."""
    return Told(
        moves=moves.moves(sentence), idle=idle.idle(sentence), gesturing=idle.gesturing(sentence),
        gestures=gestures(sentence), contact=contact(sentence), hold=hold(sentence),
        by_both_hands=leads_by_both_hands(sentence), twirls=twirls(sentence), lift=lift(sentence),
        strike=strike(sentence), changes=postures.changes(sentence), leaps=postures.leaps(sentence),
        bows=postures.bows(sentence), on_feet=postures.on_feet(sentence), placed=beginnings.beginning(sentence),
        keeps_place=beginnings.keeps_place(sentence), touches=idle.touches(sentence), alone=of_each(sentence),
    )  # fmt: skip
