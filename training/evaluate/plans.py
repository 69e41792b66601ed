"""Sentences with the plan that a careful person writes for each: the reading test."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Any

from motion import InputError

MODALITIES = ("told", "tried", "offered", "pretended", "wished")
ORDERS = ("after", "before", "with", "while", "until")


@dataclass(frozen=True)
class Act:
    """One act of a plan.

    Attributes:
        verb: lemma or phrase of what is done, such as "walk to" or "tap on shoulder".
        agents: those who do it, of "a" and "b".
        patient: to whom it is done.
        thing: noun of a thing that it is done with or to.
        polarity: "done", or "not" where the words say that it is not done.
        modality: "told" where the words simply say it, else one of :data:`MODALITIES`.
        order: (one of :data:`ORDERS`, index of another act of the plan); none where it starts with the sentence.
        side: "left", "right" or "both".
        times: how often, where the words say it.
        body: part of the body that is named, of the agent or of the patient.
        manner: such as "slowly".
    """

    verb: str
    agents: tuple[str, ...]
    patient: str | None = None
    thing: str | None = None
    polarity: str = "done"
    modality: str = "told"
    order: tuple[tuple[str, int], ...] = ()
    side: str | None = None
    times: int | None = None
    body: str | None = None
    manner: str | None = None


FIELDS = tuple(found.name for found in fields(Act))


@dataclass(frozen=True)
class Reading:
    """A sentence and its plan.

    Attributes:
        id: a short name.
        words: the sentence; no part of the text that ``repr`` gives, so that a failing test does not print it.
        acts: what the sentence says that two people do, in the order in which it is said.
        unread: parts of the words that name nothing that two bodies show.
        sealed: whether words and plan must not be shown.
    """

    id: str
    words: str = field(repr=False)
    acts: tuple[Act, ...] = field(repr=False)
    unread: tuple[str, ...] = field(default=(), repr=False)
    sealed: bool = False


@cache
def read_plans(path: Path) -> tuple[Reading, ...]:
    """The readings of a TOML file with ``reading`` tables, in its order.

    Raises:
        InputError: if a table or an act has a field that is unknown, missing or of another type; the words are not
            repeated.
    """
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    sealed = tables.get("sealed") is True
    found = []
    for row in tables.get("reading", []):
        try:
            acts = tuple(_act(act) for act in row["acts"])
            found.append(Reading(row["id"], row["words"], acts, tuple(row.get("unread", ())), sealed))
        except (KeyError, TypeError, AttributeError):
            raise InputError(f"Reading {row.get('id')} of {path.name} has a field that cannot be used.") from None
    return tuple(found)


def _act(row: dict[str, Any]) -> Act:
    order = tuple((str(kind), int(i)) for relation in row.get("order", ()) for kind, i in relation.items())
    return Act(**row | {"agents": tuple(row["agents"]), "order": order})
