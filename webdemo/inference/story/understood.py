"""Notes on what of a sentence cannot be shown: further people, and acts that nobody knows."""

from __future__ import annotations

from acts import Plan, captions, read
from acts.lexicon import lexicon
from motion import InputError

from .staging import staged

MOST_NAMED = 3
"""Parts of a sentence that a note quotes, at most."""


def is_understood(sentence: str) -> bool:
    """True if people's ways, postures or touches are planned from a sentence, or all of its acts are known."""
    plan = _plan(sentence)
    return plan is not None and bool(plan.acts) and (not plan.unread or staged(plan.acts).is_planned)


def notes(sentence: str) -> tuple[str, ...]:
    """Sentences on what of the words is not shown; none where the words were planned, or no parser is installed."""
    plan = _plan(sentence)
    if plan is None:
        return ()
    found = list(plan.notes)
    parts = [plan.text(unread.words) for unread in plan.unread][:MOST_NAMED]
    if parts and not staged(plan.acts).is_planned:
        quoted = ", ".join(f"“{part}”" for part in parts)
        found.append(f"Not understood: {quoted}. Say it in plainer words, or as what the two bodies do.")
    return tuple(found)


def of_each(sentence: str) -> tuple[str, str]:
    """A sentence on what person a does and one on what b does, as :func:`acts.captions.of_each` gives them."""
    plan = _plan(sentence)
    return ("", "") if plan is None else captions.of_each(plan.acts, lexicon())


def _plan(sentence: str) -> Plan | None:
    try:
        return read(sentence)
    except InputError:
        return None
