"""Plans of acts: the one place where a request's words become one, and the notes on what of them is not shown."""

from __future__ import annotations

from acts import Plan, captions, read
from acts.lexicon import lexicon
from motion import InputError


def understood(text: str) -> Plan:
    """The plan of a text; an empty one where it says nothing, is too long, or no parser is installed."""
    try:
        return read(text) if text.strip() else Plan()
    except InputError:
        return Plan()


def of_each(plan: Plan) -> tuple[str, str]:
    """A sentence on what person a does and one on what b does, as :func:`acts.captions.of_each` gives them."""
    return captions.of_each(plan.acts, lexicon())
