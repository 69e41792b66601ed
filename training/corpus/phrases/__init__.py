"""The phrase book of the corpus' captions: one entry a family, a kind of families a module.

Notation (read by :mod:`training.corpus.captions`):
    ``(a|b|)``  one of the alternatives, the last of which is empty here;
    ``*verb``   agrees with its subject: waves, wave, waving;
    ``{other}`` ``{them}`` ``{theirs}``  the other person, by noun, pronoun or possessive; ``{their}`` one's own;
    ``{with_hand}`` ``{hand}`` ``{with_foot}`` ``{to_side}`` ``{round}``  filled from the side that a scene names, or neutral;
    ``{thing}`` ``{the_thing}``  an object that the motion cannot show.
Verb phrases of ``a`` and ``b`` have that person as the subject, those of ``both`` the two people; ``nouns``
are keyword-like prompts; ``sentences`` are whole sentences with ``{A}`` and ``{B}``.
"""

# ruff: noqa: E501 (the notation reads better unbroken)

from __future__ import annotations

from .actions import ACTIONS
from .combat import COMBAT
from .contact import CONTACT
from .entry import Entry
from .gestures import GESTURES
from .locomotion import LOCOMOTION
from .recorded import RECORDED

__all__ = ["ACTIONS", "ENTRIES", "Entry"]

ENTRIES: dict[str, Entry] = {**GESTURES, **LOCOMOTION, **COMBAT, **CONTACT, **RECORDED}
"""The words of every family, by its name."""
