"""Chooses test sentences for a generator: unseen ones with something to check, spread over families."""

from __future__ import annotations

import json
import re
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import torch

from models.motion_tokens import decode
from motion import Duet, InputError
from training.prepare import Scenes

from .rules import Task

EVERYDAY = Path(__file__).with_name("everyday.json")
_PERSON = re.compile(r"\b(person|man|woman|first|one|someone|somebody|friend)\b", re.IGNORECASE)
_SECOND = re.compile(
    r"\b(other|another|second|two|both people|each|partner|someone|person 2|person b|together|pair|couple"
    r"|people|they (?:both|all)|man.*woman|woman.*man)\b",
    re.IGNORECASE,
)


def tells_of_both(caption: str) -> bool:
    """True if a sentence speaks of both people, or of none by name ("a short handshake").

    "One person holds a hand down." is true of a low five but does not ask for one.
    """
    return _SECOND.search(caption) is not None or _PERSON.search(caption) is None


def choose(scenes: Scenes, count: int, *, seed: int = 0, split: str = "test") -> list[tuple[Task, dict]]:
    """Sentences of a split with the rows of their scenes, one kind after the other in turn.

    A kind is a family, with or without a side that is named, and with the two actions that come in order:
    sides and orders are few, and would otherwise be too few to count.
    No sentence comes twice; a scene lends a second one only when every scene of its kind has lent one.
    Raises InputError if the split has none that can be checked.
    """
    rng = np.random.default_rng(seed)
    kinds: dict[str, list[list[tuple[Task, dict]]]] = {}
    seen: set[str] = set()
    rows = scenes.split(split)
    for i in rng.permutation(len(rows)):
        row = rows[i]
        frames = scenes.layout.num_frames(row["tokens"])
        tasks = []
        for j in rng.permutation(len(row["captions"])):
            task = Task(row["captions"][j], row["family"], row["events"] or {}, frames)
            plain = re.sub(r"[^a-z0-9 ]", "", task.caption.lower())
            if task.checks and plain not in seen and tells_of_both(task.caption):
                seen.add(plain)
                tasks.append((task, row))
        for kind in {_kind(task) for task, _ in tasks}:
            kinds.setdefault(kind, []).append([item for item in tasks if _kind(item[0]) == kind])
    queues = [_in_turn(kinds[kind]) for kind in sorted(kinds)]
    found = _in_turn([queues[i] for i in rng.permutation(len(queues))])[:count]
    if not found:
        raise InputError(
            f"The {split} split of these scenes has no caption that can be checked: prepare a corpus with "
            "events by `python -m training.corpus`."
        )
    return found


def everyday() -> list[Task]:
    """Sentences as people type them, written by hand and not by the corpus' grammar, with what to check."""
    rows = json.loads(EVERYDAY.read_text())
    return [Task(r["prompt"], r["family"], r["events"], round(30 * r["seconds"])) for r in rows]


def _kind(task: Task) -> str:
    named = ["side"] if "side" in task.checks else []
    return " ".join([task.family, *named, *(task.events["order"] if "order" in task.checks else ())])


def _in_turn(queues: list[list[Any]]) -> list[Any]:
    """One of each list, then the second of each, …"""
    return [item for turn in zip_longest(*queues) for item in turn if item is not None]


def real_duet(scenes: Scenes, row: dict[str, Any]) -> Duet:
    """The recorded scene, decoded from its control points: as smooth as what a network can give."""
    with torch.no_grad():
        positions = decode(scenes.scene(row), scenes.layout)[0].numpy()
    return Duet.from_positions(positions, fps=30.0, roles=("actor", "reactor"))
