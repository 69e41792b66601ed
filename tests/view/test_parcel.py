"""What a process that draws pictures is sent."""

from __future__ import annotations

import dataclasses
import pickle
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from motion import Duet
from motion.transforms import turn
from tests.motion.bodies import marching
from webdemo.view import film
from webdemo.view.camera import cameras
from webdemo.view.parcel import KINDS, Job, packed, unpacked
from webdemo.view.stage import Pane, Style

A = marching(60)[0]
DUET = Duet.from_positions(np.stack([A, turn(A, np.pi) + np.array([0, 0, 1.4])]), fps=30)


def job(**changed: object) -> Job:
    times = np.arange(4) / 30
    views = cameras([DUET, DUET.a], size=(160, 120), times=times, view="front", follow=True)
    panes = (Pane(DUET, "one"), Pane(DUET.a, ghost=DUET.b, past_until=3))
    whole = Job(panes, Style(trails=True), (320, 120), times, views, "“two” ♥")
    return dataclasses.replace(whole, **changed)


def same(one: object, other: object) -> bool:
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and one.dtype == other.dtype and np.array_equal(one, other)
    if dataclasses.is_dataclass(one):
        names = [part.name for part in dataclasses.fields(one)]
        return type(one) is type(other) and all(same(getattr(one, n), getattr(other, n)) for n in names)
    if isinstance(one, list | tuple):
        return isinstance(other, Sequence) and len(one) == len(other) and all(map(same, one, other))
    return one == other and type(one) is type(other)


def test_a_job_arrives_as_it_was_sent() -> None:
    sent = job()
    assert same(sent, unpacked(packed(sent)))


def test_a_motion_that_says_how_it_was_made_can_be_drawn() -> None:
    made = dataclasses.replace(DUET, manifest={"seed": 3, "request": {"prompt": "they “hug”", "beats": [1, None]}})
    (pane,) = unpacked(packed(job(panes=(Pane(made, "one"),)))).panes
    assert isinstance(pane.motion, Duet) and pane.motion.manifest == made.manifest


def test_only_known_classes_and_plain_data_are_sent() -> None:
    with pytest.raises(TypeError, match="cannot hold Fraction"):
        packed(job(title=Fraction(1, 2)))
    with pytest.raises(TypeError, match="cannot hold ndarray"):
        packed(job(times=np.array([object()])))


def test_nothing_else_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError):
        unpacked(pickle.dumps(job()))
    parcel = packed(job())
    monkeypatch.delitem(KINDS, "Camera")
    with pytest.raises(ValueError, match="no drawing job"):
        unpacked(parcel)


def test_child_processes_draw_what_one_process_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    times = np.arange(film._FEW + 1) / 30
    views = cameras([DUET], size=(64, 64), times=times, view="front", follow=True)
    whole = job(panes=(Pane(DUET),), size=(64, 64), times=times, views=views)
    monkeypatch.setattr(film, "usable_cores", lambda: 2)
    drawn = list(film._pictures(whole))
    assert len(drawn) == len(times)
    for child, here in zip(drawn[:4], film._draw(whole), strict=False):
        np.testing.assert_array_equal(child, here)
