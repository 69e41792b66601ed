"""What is read of a sentence, in short."""

from __future__ import annotations

from acts import read


def told(text: str) -> list[tuple[str, str, str | None]]:
    """The acts as (act, agents, patient)."""
    return [(act.act, "".join(act.agents), act.patient) for act in read(text).acts]
