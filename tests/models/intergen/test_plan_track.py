"""A plan of acts as the network sees it, and a network that is grown to see it."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from models.diffusion import guide
from models.intergen.compact import CompactConfig, CompactInterGen
from models.intergen.plan_track import PACE, PlanTrack, TimedAct
from models.intergen.words import WordDenoiser
from models.motion_tokens import TokenLayout

WORDS = ("do push", "do wave", "manner sadly", "side left", "undergo push")
LAYOUT = TokenLayout()
SIZES: dict[str, Any] = {
    "latent_dim": 32, "ff_size": 32, "num_layers": 2, "num_heads": 2, "cond_dim": 16, "text_layers": 1, "words": True,
    "role_text": True,
}  # fmt: skip


def track(*acts: TimedAct, tokens: int = 6) -> torch.Tensor:
    """(2, tokens, width)"""
    made = PlanTrack(WORDS, LAYOUT)(acts, tokens)
    return made.view(tokens, 2, -1).transpose(0, 1)


def test_each_word_holds_for_whom_and_when_it_is_true() -> None:
    made = track(TimedAct("push", (0,), 8, 28, patient=1), TimedAct("wave", (1,), 0, 48, side="left"))
    share = torch.tensor([0, 1, 1, 0.5, 0, 0])
    torch.testing.assert_close(made[0, :, WORDS.index("do push")], share)
    torch.testing.assert_close(made[1, :, WORDS.index("undergo push")], share)
    assert (made[1, :, WORDS.index("do wave")] == 1).all() and (
        made[1, :, WORDS.index("side left")] == 1
    ).all()
    for person, words in ((0, ("do wave", "side left", "undergo push")), (1, ("do push",))):
        assert not made[person][:, [WORDS.index(word) for word in words]].any()


def test_the_pace_is_that_of_the_act_that_began_last() -> None:
    made = track(TimedAct("wave", (0,), 0, 48), TimedAct("push", (0,), 16, 32, speed=2.0))
    left, done, speed = made[0, :, -len(PACE) :].unbind(1)
    torch.testing.assert_close(done, torch.tensor([4 / 48, 12 / 48, 4 / 16, 12 / 16, 36 / 48, 44 / 48]))
    torch.testing.assert_close(left, 1 - done)
    torch.testing.assert_close(speed, torch.tensor([0.0, 0, 1, 1, 0, 0]))
    assert not made[1].any()


def test_words_outside_the_vocabulary_and_the_motion_leave_no_trace() -> None:
    assert not track(TimedAct("juggle", (0,), 0, 48))[..., : -len(PACE)].any()
    assert not track(TimedAct("wave", (0, 1), 48, 90)).any()
    assert PlanTrack((), LAYOUT)([TimedAct("wave", (0,), 0, 8)], 3).shape == (3, 0)


@pytest.fixture(scope="module")
def networks() -> tuple[CompactInterGen, CompactInterGen]:
    """A network with weights that are all at work, and one that is grown from it to read plans."""
    torch.manual_seed(0)
    plain = CompactInterGen(CompactConfig(**SIZES)).eval().requires_grad_(False)
    for parameter in plain.parameters():
        torch.nn.init.normal_(parameter, std=0.1)
    grown = CompactInterGen(CompactConfig(**SIZES, plan_words=WORDS)).eval().requires_grad_(False)
    grown.grow_from(plain)
    return plain, grown


def inputs(model: CompactInterGen) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    torch.manual_seed(1)
    return (
        torch.randn(2, 6, 2 * model.layout.token_features),
        torch.tensor([900, 30]),
        torch.randn(2, 3, 4, 16),
    )


def test_a_grown_network_gives_what_it_gave_whatever_the_plan(networks: Any) -> None:
    plain, grown = networks
    plan = PlanTrack(WORDS, LAYOUT)([TimedAct("push", (0,), 0, 30, patient=1)], 6)[None]
    wanted = plain.denoiser(*inputs(plain))
    torch.testing.assert_close(grown.denoiser(*inputs(grown), plan=plan.expand(2, -1, -1)), wanted)
    torch.testing.assert_close(grown.denoiser(*inputs(grown)), wanted)


def test_the_plan_moves_both_people_and_is_guided(networks: Any) -> None:
    _, grown = networks
    denoiser: WordDenoiser = grown.denoiser
    assert denoiser.plan_adapter is not None
    for layer in denoiser.plan_adapter.added:
        torch.nn.init.normal_(layer.weight, std=0.3)
    plan = PlanTrack(WORDS, LAYOUT)([TimedAct("push", (0,), 8, 30, patient=1)], 6)[None]
    x, t, cond = inputs(grown)
    told = denoiser(x, t, cond, plan=plan.expand(2, -1, -1))
    silent = denoiser(x, t, torch.zeros_like(cond))
    assert (told - denoiser(x, t, cond)).abs().amax() > 0.1
    torch.testing.assert_close(denoiser.guided(x, t, cond, plan=plan, scale=2.5), guide(told, silent, 2.5))
    torch.testing.assert_close(denoiser.guided(x, t, cond, plan=plan, scale=1.0), told)


def test_the_vocabulary_is_kept_in_the_config() -> None:
    config = CompactConfig(**SIZES, plan_words=WORDS)
    values = {"layout": {"frames_per_knot": 4, "knots_per_token": 2}, "plan_words": list(WORDS)}
    assert CompactConfig.from_dict({**SIZES, **values}) == config
    assert CompactInterGen(config).plan_track is not None
    assert CompactInterGen(CompactConfig(**SIZES)).plan_track is None


def test_weights_grow_into_a_larger_vocabulary_by_the_names_of_the_columns() -> None:
    known = CompactInterGen(CompactConfig(**SIZES, plan_words=("do push", "do wave")))
    grown = CompactInterGen(
        CompactConfig(**SIZES, plan_words=("do hug", "do push", "do wave"), traits=("energy",))
    )
    torch.nn.init.normal_(known.denoiser.plan_adapter.whole.weight)
    grown.grow_from(known)
    plan = [TimedAct("push", (0,), 0, 30, patient=1)]
    told = [
        model.denoiser.plan_adapter(model.plan_track(plan, 6).view(1, 6, 2, -1).permute(2, 0, 1, 3))[1]
        for model in (known, grown)
    ]
    assert told[0].any()
    torch.testing.assert_close(told[0], told[1])


def test_a_motion_without_a_plan_is_left_alone_beside_one_that_has_one(networks: Any) -> None:
    _, grown = networks
    adapter = grown.denoiser.plan_adapter
    for parameter in adapter.parameters():
        torch.nn.init.normal_(parameter)
    plan = PlanTrack(WORDS, LAYOUT)([TimedAct("push", (0,), 8, 30, patient=1)], 6)
    people = torch.stack([plan, torch.zeros_like(plan)]).unflatten(-1, (2, -1)).permute(2, 0, 1, 3)
    added, whole = adapter(people)
    for found in (*added, whole):
        assert found[:, 0].any() and not found[:, 1].any()


def test_traits_stand_in_columns_of_their_own_for_all_times() -> None:
    track = PlanTrack(WORDS, LAYOUT, ("energy", "tempo"))
    made = track([], 3, torch.tensor([[1.0, -0.5], [0.0, 2.0]])).view(3, 2, -1)
    assert made[..., -2:].tolist() == [[[1.0, -0.5], [0.0, 2.0]]] * 3
    assert not made[..., :-2].any()
    assert not track([], 3).any()
