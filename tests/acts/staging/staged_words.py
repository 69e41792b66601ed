"""What the stage is told by the acts that a sentence is read as, as one beat."""

from __future__ import annotations

from collections.abc import Mapping

from acts import read
from acts.staging.bodies.gestures import Gesture
from acts.staging.bodies.strikes import Strike
from acts.staging.contacts import Contact
from acts.staging.floor import Standing
from acts.staging.holds import Hold
from acts.staging.lifts import Lift
from acts.staging.moves import Move
from acts.staging.postures import Change
from acts.staging.stage import staged
from acts.staging.told import Told


def told(words: str) -> Told:
    return staged(read(words).acts)


def moves(words: str) -> tuple[Move, ...]:
    return told(words).moves


def contact(words: str) -> Contact | None:
    return told(words).contact


def hold(words: str) -> Hold | None:
    return told(words).hold


def twirls(words: str) -> str:
    return told(words).twirls


def lift(words: str) -> Lift | None:
    return told(words).lift


def strike(words: str) -> Strike | None:
    return told(words).strike


def gestures(words: str) -> Mapping[str, Gesture]:
    return told(words).gestures


def changes(words: str) -> Mapping[str, tuple[Change, ...]]:
    return told(words).changes


def leaps(words: str) -> Mapping[str, int]:
    return told(words).leaps


def bows(words: str) -> Mapping[str, tuple[int, bool]]:
    return told(words).bows


def beginning(words: str) -> Standing | None:
    return told(words).placed


def idle(words: str) -> frozenset[str]:
    return told(words).idle


def gesturing(words: str) -> frozenset[str]:
    return told(words).gesturing


def is_planned(words: str) -> bool:
    return told(words).is_planned
