"""A reaction's promises: the given person stays as given, and the other lives in their world."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from motion import SKELETONS, Clip, Duet, InputError
from motion.transforms import leading_wrist, mirrored
from webdemo.inference import ReactRequest, Result
from webdemo.inference.engine import Engine
from webdemo.inference.requests.actor import choose_actor

from .people import waver

REQUEST = ReactRequest(actor=waver(), prompt="Two people shake hands.", seed=7, steps=6)


def react(engine: Engine, **changed: object) -> Result:
    return next(event for event in engine.run(replace(REQUEST, **changed)) if isinstance(event, Result))


@pytest.mark.parametrize("change", [{}, {"sampler": "dpm++"}, {"prompt": ""}, {"role": "b"}])
def test_the_given_person_is_kept_bit_for_bit(engine: Engine, change: dict) -> None:
    result = react(engine, samples=2, **change)
    actor, place = waver(), 1 if change.get("role") == "b" else 0
    for duet in result.duets:
        assert duet.people[place].positions.tobytes() == actor.positions.tobytes()
        assert np.isfinite(duet.positions).all()
        assert duet.roles == ("actor", "reactor")
    assert len(result.readouts) == 2


@pytest.mark.parametrize("words", ["Two people wave.", "One person waves the right hand.", ""])
def test_a_left_handed_actor_is_answered_as_the_right_handed_one_where_words_name_no_side(
    engine: Engine, words: str
) -> None:
    """Words without a side were learned from right-handed scenes alone."""
    right = waver()
    left = right.with_positions(mirrored(right.positions))
    assert (leading_wrist(right.positions), leading_wrist(left.positions)) == ("right", "left")
    one, other = (react(engine, actor=actor, prompt=words).duets[0] for actor in (right, left))
    assert other.a.positions.tobytes() == left.positions.tobytes()
    apart = np.abs(mirrored(one.b.positions) - other.b.positions).max()
    assert apart < 1e-4 if words == "Two people wave." else apart > 1e-2


def test_the_reaction_differs_by_seed_by_actor_and_by_words(engine: Engine) -> None:
    first = react(engine).duets[0].b.positions
    assert first.tobytes() == react(engine).duets[0].b.positions.tobytes()
    other = waver()
    bent = other.positions + np.linspace(0, 0.5, other.num_frames)[:, None, None] * np.array([0, 0, 1.0])
    other_actor = other.with_positions(bent)
    # The tiny network hardly heeds what it is given, but it does.
    for least, change in (
        (0.01, {"seed": 8}),
        (1e-3, {"actor": other_actor}),
        (1e-7, {"prompt": "One person waves."}),
        (1e-7, {"prompt": ""}),
    ):
        moved = np.abs(first - react(engine, **change).duets[0].b.positions).max()
        assert moved > least, change


def test_the_network_sees_the_given_person_clean_at_every_step(engine: Engine) -> None:
    """Sampling by hand: the given half is set before each network call, and its prediction overwritten."""
    from models.diffusion import make_scheduler, sample_noise

    request = replace(REQUEST, damping=0.0, cleanup=False)
    generator = engine.pipeline("intergen")
    model, layout = generator.model, generator.model.layout
    scene = generator.scene(request)
    half = layout.token_features
    empty = torch.zeros(1, layout.num_tokens(60), 2 * half)
    clean = scene.given(empty)[..., :half]
    decoded = model.positions(scene.given(empty))[0][0, 0, :60].numpy()
    expected = scene.placement.to_network(waver().positions)
    np.testing.assert_allclose(decoded, expected, atol=0.01)

    condition = generator.conditioning(request).condition
    x = sample_noise(request.seed, 1, (layout.num_tokens(60), 2 * half))
    scheduler = make_scheduler("ddim", request.steps, spacing="top")
    with torch.no_grad():
        for t in scheduler.timesteps:
            x = torch.cat([clean, x[..., half:]], -1)
            predicted = model.denoiser.guided(x, t.expand(1), condition, scale=request.guidance)
            predicted = torch.cat([clean, predicted[..., half:]], -1)
            x = scheduler.step(predicted, t, x).prev_sample
        plain = model.positions(x)[0][0, 1, :60].numpy()
    ours = react(engine, damping=0.0, cleanup=False).duets[0].b.positions
    np.testing.assert_allclose(scene.placement.to_world(plain), ours, atol=1e-5)


def test_damping_moves_no_given_number(engine: Engine) -> None:
    from webdemo.inference.finish.damping import Damping

    pipeline = engine.pipeline("intergen")
    model, given = pipeline.model, pipeline.scene(REQUEST).given
    frozen = given.frozen[0]
    x0 = given(torch.randn(2, *frozen.shape, generator=torch.Generator().manual_seed(1)))
    corrected = Damping(model, 1.0, frames=60, timesteps=[0], frozen=frozen)(x0, 0)
    assert torch.equal(corrected[:, frozen], x0[:, frozen])
    assert (corrected[:, ~frozen] != x0[:, ~frozen]).float().mean() > 0.5


def test_the_manifest_names_the_actor_without_the_motion(engine: Engine) -> None:
    import json

    manifest = react(engine, steps=1).manifest
    asked = manifest["request"]
    assert asked["kind"] == "react"
    assert asked["actor"]["name"] == "waver"
    assert asked["actor"]["frames"] == 60
    assert len(asked["actor"]["sha256"]) == 64
    assert len(json.dumps(manifest)) < 2000
    assert react(engine, steps=1, actor=waver(3.0)).manifest["request"]["actor"] != asked["actor"]


def spoiled(value: float) -> Clip:
    """A clip that went bad after it was made, as arrays can."""
    clip = waver()
    clip.positions.setflags(write=True)
    clip.positions[5, 3, 1] = value
    return clip


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"actor": waver(0.9)}, "0.90 s: give 1 s or more"),
        ({"actor": waver(12.0)}, "12.0 s: trim it to 10 s or less"),
        ({"actor": spoiled(float("nan"))}, "NaN or infinite"),
        ({"actor": Clip(np.zeros((60, 15, 3)), 30, SKELETONS["sbu15"])}, "22 joints, not sbu15's"),
        ({"actor": waver().with_positions(waver().positions * 100)}, "100 times as long"),
        ({"actor": waver().with_positions(waver().positions + 5000)}, "1000 m from the origin"),
        ({"actor": Duet(waver(), waver())}, "one person's clip"),
        ({"mode": "online"}, "choose offline"),
        ({"role": "c"}, "Role 'c'"),
    ],
)
def test_what_cannot_be_done_is_refused_with_a_sentence(change: dict, says: str) -> None:
    with pytest.raises(InputError, match=rf"\A.*{says}.*\.\Z"):
        replace(REQUEST, **change)


def test_one_person_is_chosen_and_trimmed() -> None:
    clip = waver(4.0, fps=60)
    cut = choose_actor((clip,), start=1.0, end=3.0)
    assert (cut.fps, cut.num_frames) == (30, 60)
    np.testing.assert_allclose(cut.positions[0], clip.positions[60], atol=1e-6)
    duet = Duet(clip, clip.with_positions(clip.positions + 1))
    for people in (duet.people, (clip, duet.b, clip)):
        found = choose_actor(people, person="b").positions
        np.testing.assert_allclose(found[0], duet.b.positions[0], atol=1e-6)
    at_rate = waver()
    assert choose_actor((at_rate,)).positions.tobytes() == at_rate.positions.tobytes()


@pytest.mark.parametrize(
    ("count", "change", "says"),
    [
        (3, {}, "holds three people: choose person a, b or c"),
        (3, {"person": "d"}, "Person 'd' is not known: The file has a, b or c"),
        (1, {"person": "b"}, "one person only"),
        (1, {"start": -1.0}, "start < end"),
        (1, {"start": 2.5, "end": 4.0}, "after the end of the motion"),
        (1, {"end": float("nan")}, "start < end"),
    ],
)
def test_choices_that_do_not_fit_are_refused(count: int, change: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        choose_actor((waver(),) * count, **change)
