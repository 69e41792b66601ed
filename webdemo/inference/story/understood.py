"""Notes on what of a sentence cannot be shown: further people, and acts that nobody knows."""

from __future__ import annotations

from acts import Plan, read
from motion import InputError

from .idle import is_planned

MOST_NAMED = 3
"""Parts of a sentence that a note quotes, at most."""


def is_understood(sentence: str) -> bool:
    """True if people's ways, postures or touches are planned from a sentence, or all of its acts are known."""
    if is_planned(sentence):
        return True
    plan = _plan(sentence)
    return plan is not None and bool(plan.acts) and not plan.unread


def notes(sentence: str) -> tuple[str, ...]:
    """Sentences on what of the words is not shown; none where the words were planned, or no parser is installed."""
    plan = _plan(sentence)
    if plan is None:
        return ()
    found = list(plan.notes)
    parts = [plan.text(unread.words) for unread in plan.unread][:MOST_NAMED]
    if parts and not is_planned(sentence):
        quoted = ", ".join(f"“{part}”" for part in parts)
        found.append(f"Not understood: {quoted}. Say it in plainer words, or as what the two bodies do.")
    return tuple(found)


def _plan(sentence: str) -> Plan | None:
    try:
        return read(sentence)
    except InputError:
        return None
