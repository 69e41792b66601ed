"""The models that react, and how they heed words: person a as recorded, person b made for them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from webdemo.inference import Engine, ReactRequest, Result
from webdemo.inference.engine import WEIGHTS
from webdemo.motion import Clip, Duet

from .rules import Task

_OFFLINE = {"model": "regennet", "mode": "offline", "steps": 5, "damping": 0.0}
_ONLINE = {"model": "regennet", "mode": "online", "steps": 5}
_PERSON_TO_PERSON = {"model": "intergen", "mode": "offline"}
METHODS: dict[str, dict[str, Any]] = {
    "ReGenNet, online": _ONLINE,
    "ReGenNet, offline": _OFFLINE,
    "ReGenNet, online, first pose given": _ONLINE | {"start": True},
    "ReGenNet, offline, first pose given": _OFFLINE | {"start": True},
    "InterFormer, first pose given": {"model": "interformer", "start": True},
    "InterGen, person to person": _PERSON_TO_PERSON | {"steps": 20, "guidance": 1.0, "damping": 0.0},
    "Virtual agent": {"model": "agent", "steps": 20, "damping": 0.0},
}
"""The fields of a request without words and without damping, by the name of the method."""
TOLD: dict[str, dict[str, Any]] = {
    "InterGen, person to person": _PERSON_TO_PERSON | {"steps": 25, "damping": 0.7},
    "ReGenNet, offline": _OFFLINE | {"damping": 0.7},
    "ReGenNet, offline, no damping": _OFFLINE,
    "ReGenNet, online": _ONLINE,
    "InterFormer, first pose given, no words": METHODS["InterFormer, first pose given"],
    "Virtual agent, no words": {"model": "agent", "steps": 25, "damping": 0.7},
}
"""The same with words, at the page's settings; InterFormer and the virtual agent take none."""
WORDLESS = ("interformer", "agent")
"""Models that take no words."""
LONGEST = 300
"""Frames that a model reacts to at most."""


def installed(methods: Mapping[str, Mapping[str, Any]] = METHODS, weights: Path = WEIGHTS) -> list[str]:
    """The methods whose weights are there."""
    return [name for name, chosen in methods.items() if (weights / chosen["model"] / "config.json").is_file()]


def react(engine: Engine, recorded: Duet, seed: int, chosen: Mapping[str, Any], *, prompt: str = "") -> Duet:
    """Person a as recorded, ten seconds at most, with the person b that a method makes for them.

    Args:
        recorded: 30 fps on SMPL's 22 joints, a second or more; person b lends the first pose, and nothing
            else, to a method that is given one.
        chosen: fields of the request; ``start``, if true, gives the first pose.
        prompt: the sentence, for a method that takes words.
    """
    fields = dict(chosen)
    start = recorded.b.positions[0] if fields.pop("start", False) else None
    if fields["model"] in WORDLESS:
        prompt = ""
    actor = Clip(recorded.a.positions[:LONGEST], recorded.fps)
    request = ReactRequest(actor=actor, prompt=prompt, seed=seed, start=start, **fields)
    return next(event for event in engine.run(request) if isinstance(event, Result)).duets[0]


def of_the_reactor(task: Task) -> Task:
    """The task without what a recorded person a settles alone: a's side, and an order of a's own actions."""
    events = dict(task.events)
    side = {person: hand for person, hand in (events.pop("side", None) or {}).items() if person == "b"}
    if side:
        events["side"] = side
    if task.family == "sequence":
        events.pop("order", None)
    return replace(task, events=events)


def react_to_all(
    engine: Engine, tasks: Sequence[Task], recorded: Sequence[Duet], seed: int, chosen: Mapping[str, Any]
) -> Iterator[Duet]:
    """A method's duet for every sentence and recorded pair, with the seed ``seed`` + its place."""
    for i, (task, duet) in enumerate(zip(tasks, recorded, strict=True)):
        yield react(engine, duet, seed + i, chosen, prompt=task.caption)
