"""Acts with their times, and a network that is told them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import torch

from acts import read
from models.intergen.plan_track import PACE
from tests.inference.conftest import PLAN_WORDS
from webdemo.inference import Engine, GenerateRequest
from webdemo.inference.story.beats import Beat
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.timed import acts_of, timed


def test_acts_that_follow_each_other_share_the_time() -> None:
    acts = timed(read("A waves with the left hand, then B punches A.").acts, 30, 90)
    assert [(act.name, act.agents, act.patient, act.side, act.start, act.stop) for act in acts] == [
        ("wave", (0,), 1, "left", 30, 60),
        ("punch", (1,), 0, None, 60, 90),
    ]


def test_what_does_not_happen_is_not_told() -> None:
    assert [act.name for act in timed(acts_of(Beat("A waves, but B does not bow.")), 0, 60)] == ["wave"]
    assert timed((), 0, 60) == ()


@contextmanager
def told(engine: Engine) -> Iterator[list[torch.Tensor]]:
    """The plans (B, tokens, 2, width) that the network is told."""
    seen: list[torch.Tensor] = []

    def keep(module: object, args: tuple[torch.Tensor, ...], kwargs: dict[str, torch.Tensor]) -> None:
        plan = kwargs.get("plan", args[5] if len(args) > 5 else None)
        assert plan is not None
        seen.append(plan.unflatten(-1, (2, -1)))

    handle = engine.pipeline("intergen").model.denoiser.register_forward_pre_hook(keep, with_kwargs=True)
    try:
        yield seen
    finally:
        handle.remove()


def test_a_sentence_is_told_as_its_acts_and_guided_by_them(planning_engine: Engine) -> None:
    request = GenerateRequest(prompt="Two people shake hands.", seconds=1.0, steps=2, planned=False)
    with told(planning_engine) as seen:
        list(planning_engine.run(request))
    shake = PLAN_WORDS.index("do shake-hands")
    assert len(seen) == 2
    for conditional, unconditional in (plan.chunk(2) for plan in seen):
        assert (conditional[0, :3, :, shake] == 1).all()
        assert not unconditional.any()


def test_a_window_is_told_what_went_before_it(planning_engine: Engine) -> None:
    beats = (Beat("They shake hands.", seconds=2.0), Beat("One person waves.", seconds=2.0))
    with told(planning_engine) as seen:
        list(planning_engine.run(SceneRequest(beats=beats, steps=1)))
    (first, second) = (plan[0] for plan in seen)
    shake, wave = PLAN_WORDS.index("do shake-hands"), PLAN_WORDS.index("do wave")
    assert first[:6, :, shake].all() and not first[:6, :, wave].any()
    assert second[:5, :, shake].all() and second[7:12, 0, wave].all() and not second[7:, :, shake].any()


@pytest.mark.parametrize("prompt", ["They shake hands.", "They walk away from each other."])
def test_the_plan_changes_the_motion(planning_engine: Engine, prompt: str) -> None:
    model = planning_engine.pipeline("intergen").model
    request = GenerateRequest(prompt=prompt, seconds=1.0, steps=2, planned=False)
    (*_, whole) = planning_engine.run(request)
    track = model.__dict__.pop("plan_track")
    model.__dict__["plan_track"] = None
    try:
        (*_, silent) = planning_engine.run(request)
    finally:
        model.__dict__["plan_track"] = track
    assert track.width == len(PLAN_WORDS) + len(PACE)
    assert not np.allclose(whole.duets[0].positions, silent.duets[0].positions, atol=1e-3)
