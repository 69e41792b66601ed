"""Beats of a second: too short for most acts, and no reason to end a scene with an error."""

from __future__ import annotations

import numpy as np

from acts.lexicon import lexicon
from webdemo.inference.engine import Engine
from webdemo.inference.run import Result
from webdemo.inference.story import Beat, SceneRequest

KINDS = ("way", "carry", "hold", "posture", "bout")
"""Fields of shapes that make another course of them."""


def kinds_of_stage() -> list[str]:
    """A sentence of one act for each sequence of shapes that the lexicon has."""
    found = {}
    for entry in lexicon().entries.values():
        if entry.stage and entry.reads:
            shapes = tuple(tuple(getattr(shape, kind, "") for kind in ("do", *KINDS)) for shape in entry.stage)
            found.setdefault(shapes, entry.reads[0])
    return list(found.values())


def test_an_act_of_each_kind_may_come_second_in_a_second(engine: Engine) -> None:
    sentences = kinds_of_stage()
    assert len(sentences) > 50
    for sentence in sentences:
        beats = (Beat("They wave.", seconds=1.0), Beat(sentence, seconds=1.0))
        *_, result = engine.run(SceneRequest(beats=beats, steps=1))
        assert isinstance(result, Result)
        assert np.isfinite(result.duets[0].positions).all(), sentence


def test_nobody_is_carried_who_is_out_of_reach_in_a_second(engine: Engine) -> None:
    beats = (Beat("They walk away from each other.", seconds=4.0), Beat("He carries her across the room.", seconds=1.0))
    *_, result = engine.run(SceneRequest(beats=beats, steps=1))
    assert isinstance(result, Result)
    assert result.duets[0].positions[1, :, 0, 1].max() < 1.05, "nobody is off the floor"
