"""What is read of a sentence, in short."""

from __future__ import annotations

from acts import Act, read


def said(text: str) -> list[str]:
    """The acts as "a hug b", with marks for those that do not happen."""
    return [_said(act) for act in read(text).acts]


def _said(act: Act) -> str:
    mark = "" if act.modality == "told" else f" ({act.modality})"
    not_ = "not " if act.polarity == "not" else ""
    return f"{''.join(act.agents)} {not_}{act.act}{f' {act.patient}' if act.patient else ''}{mark}"


def told(text: str) -> list[tuple[str, str, str | None]]:
    """The acts as (act, agents, patient)."""
    return [(act.act, "".join(act.agents), act.patient) for act in read(text).acts]
