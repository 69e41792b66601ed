"""Acts with their times, and a network that is told them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
import torch

from acts import read
from models.intergen.plan_track import PACE
from motion import InputError
from tests.inference.conftest import PLAN_WORDS, tiny_weights
from training.trainers.traits import TRAITS
from webdemo.inference import Engine, GenerateRequest, methods
from webdemo.inference.batch import run_batch
from webdemo.inference.cancel import CancelToken
from webdemo.inference.methods.intergen import takes
from webdemo.inference.results import Progress
from webdemo.inference.story.beats import Beat
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.timed import timed
from webdemo.inference.traits import SPREAD


def test_acts_that_follow_each_other_share_the_time() -> None:
    acts = timed(read("A waves with the left hand, then B punches A.").acts, 30, 90)
    assert [(act.name, act.agents, act.patient, act.side, act.start, act.stop) for act in acts] == [
        ("wave", (0,), 1, "left", 30, 60),
        ("punch", (1,), 0, None, 60, 90),
    ]


def test_what_does_not_happen_is_not_told() -> None:
    assert [act.name for act in timed(read("A waves, but B does not bow.").acts, 0, 60)] == ["wave"]
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
        assert not unconditional[..., : -len(TRAITS)].any()
        assert torch.equal(unconditional[..., -len(TRAITS) :], conditional[..., -len(TRAITS) :])


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
    assert track.width == len(PLAN_WORDS) + len(PACE) + len(TRAITS)
    assert not np.allclose(whole.duets[0].positions, silent.duets[0].positions, atol=1e-3)


@pytest.fixture
def takes_plans(monkeypatch: pytest.MonkeyPatch) -> None:
    """Requests for InterGen may set what only a network that reads plans takes."""
    method = methods.method("intergen")
    known = {**methods._registered, "intergen": replace(method, takes=method.takes | {"plan"})}
    monkeypatch.setattr(methods, "_registered", known)


@pytest.mark.parametrize("setting", ["energy", "tempo", "plan_guidance"])
def test_a_network_that_reads_no_plans_refuses_what_it_cannot_take(setting: str) -> None:
    with pytest.raises(InputError, match=f"leave {setting.replace('_', ' ')} out"):
        GenerateRequest(prompt="They wave.", model="bigraphdiff", **{setting: 1.0})


def test_settings_of_few_networks_are_kept_where_they_are_set(takes_plans: None) -> None:
    told = GenerateRequest(prompt="They wave.", energy=1.5, plan_guidance=0.0).to_dict()
    assert (told["energy"], told["plan_guidance"]) == (1.5, 0.0) and "tempo" not in told
    scene = SceneRequest(beats=(Beat("They wave."),), tempo=-1.0)
    assert SceneRequest.from_dict(scene.to_dict()).tempo == -1.0
    with pytest.raises(InputError, match="Energy must be from -2 to 2"):
        GenerateRequest(prompt="They wave.", energy=3.0)


def told_traits(engine: Engine, request: GenerateRequest | SceneRequest) -> list[torch.Tensor]:
    """The traits (2, traits) in each call of the network, of its first motion."""
    with told(engine) as seen:
        list(engine.run(request))
    return [plan[0, 0, :, -len(TRAITS) :] for plan in seen]


def test_people_are_drawn_by_the_seed_around_what_is_asked(
    planning_engine: Engine, takes_plans: None
) -> None:
    asked = {"prompt": "They dance.", "seconds": 1.0, "steps": 1, "planned": False}
    draws = [
        told_traits(planning_engine, GenerateRequest(seed=seed, energy=1.0, **asked))[0] for seed in range(40)
    ]
    drawn = torch.stack(draws)
    assert drawn.mean((0, 1)).tolist() == pytest.approx([1.0, 0.0], abs=0.25)
    assert drawn.std((0, 1)).tolist() == pytest.approx([SPREAD] * 2, abs=0.15)
    again = told_traits(planning_engine, GenerateRequest(seed=7, energy=1.0, **asked))[0]
    assert torch.equal(again, drawn[7])


def test_people_stay_who_they_are_from_beat_to_beat(planning_engine: Engine) -> None:
    beats = (Beat("They shake hands.", seconds=2.0), Beat("One person waves.", seconds=2.0, seed=5))
    (first, second) = told_traits(planning_engine, SceneRequest(beats=beats, steps=1, seed=11))
    assert first.any() and torch.equal(first, second)


def test_the_plan_has_a_guidance_of_its_own(planning_engine: Engine, takes_plans: None) -> None:
    asked = {"prompt": "They shake hands.", "seconds": 1.0, "steps": 2, "planned": False, "guidance": 3.0}
    results = []
    for scale in (None, 3.0, 1.0):
        (*_, result) = planning_engine.run(GenerateRequest(plan_guidance=scale, **asked))
        results.append(result.duets[0].positions)
    np.testing.assert_array_equal(results[0], results[1])
    assert not np.allclose(results[0], results[2], atol=1e-3)


def test_requests_that_share_a_pass_keep_their_plans_and_scales(
    planning_engine: Engine, takes_plans: None
) -> None:
    asked = {"seconds": 1.0, "steps": 2, "planned": False}
    wanted = [
        GenerateRequest(prompt="They shake hands.", plan_guidance=1.5, **asked),
        GenerateRequest(prompt="One person waves.", seed=3, tempo=1.0, **asked),
    ]
    found = {
        i: event
        for i, event in run_batch(planning_engine, [(each, CancelToken()) for each in wanted])
        if not isinstance(event, Progress)
    }
    for i, request in enumerate(wanted):
        (*_, alone) = planning_engine.run(request)
        np.testing.assert_allclose(found[i].duets[0].positions, alone.duets[0].positions, atol=2e-4)


def test_only_weights_that_read_plans_take_what_is_said_of_them(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    plain = tiny_weights(tmp_path_factory.mktemp("plain"), words=True) / "intergen"
    reads = tiny_weights(tmp_path_factory.mktemp("reads"), words=True, plan_words=PLAN_WORDS) / "intergen"
    assert "plan" not in takes(plain) and takes(reads) == takes(plain) | {"plan"}
    assert "plan" not in methods.method("intergen").takes, "the shipped weights read none"
    (plain / "config.json").write_text('{"model": []}')
    assert takes(plain) == takes(plain / "nowhere") == {"words", "actor", "either role"}
