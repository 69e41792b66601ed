"""The engine's promises: true steps, one result, cancel within a step, same bytes for the same request."""

import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22, InputError
from motion.kinematics import bone_lengths
from tests.inference.runs import run
from webdemo.inference import Cancelled, CancelToken, GenerateRequest, Progress, Result
from webdemo.inference.engine import Engine

REQUEST = GenerateRequest(prompt="Two people shake hands.", seconds=2.0, seed=7, steps=6, split=False, planned=False)


def test_progress_counts_every_step_and_ends_in_one_result(engine: Engine) -> None:
    events = list(engine.run(REQUEST))
    steps = [(e.step, e.total) for e in events if isinstance(e, Progress) and e.stage == "sample"]
    assert steps == [(i + 1, 6) for i in range(6)]
    assert [isinstance(event, Result) for event in events].count(True) == 1
    assert isinstance(events[-1], Result)
    elapsed = [event.elapsed for event in events if isinstance(event, Progress)]
    assert elapsed == sorted(elapsed)


def test_the_same_request_gives_the_same_bytes_and_another_seed_does_not(engine: Engine) -> None:
    first, again = run(engine, REQUEST), run(engine, REQUEST)
    other = run(engine, replace(REQUEST, seed=8))
    assert first.duets[0].positions.tobytes() == again.duets[0].positions.tobytes()
    assert first.manifest == again.manifest
    assert not np.allclose(first.duets[0].positions, other.duets[0].positions)


def test_cleanup_ends_on_constant_bones_above_the_floor(engine: Engine) -> None:
    result = run(engine, replace(REQUEST, seconds=3.0))
    positions = result.duets[0].positions
    np.testing.assert_allclose(bone_lengths(positions) - SMPL22.bone_lengths[1:], 0, atol=2e-3)
    assert result.readouts[0]["after"]["bone_drift"] < 0.1


def test_damping_zero_is_the_plain_sampler_bit_for_bit(engine: Engine) -> None:
    import torch

    from models.diffusion import make_scheduler, sample_noise

    request = replace(REQUEST, damping=0.0, cleanup=False)
    ours = run(engine, request).duets[0].positions

    generator = engine.pipeline("intergen")
    model, layout = generator.model, generator.model.layout
    condition = generator.conditioning(request).condition
    x = sample_noise(request.seed, 1, (layout.num_tokens(60), 2 * layout.token_features))
    scheduler = make_scheduler("ddim", request.steps, spacing="top")
    with torch.no_grad():
        for t in scheduler.timesteps:
            predicted = model.denoiser.guided(x, t.expand(1), condition, scale=request.guidance)
            x = scheduler.step(predicted, t, x).prev_sample
        plain = model.positions(x)[0][0, :, :60].numpy()
    assert ours.tobytes() == plain.tobytes()


def test_cancel_takes_effect_within_one_step_and_the_next_run_works(engine: Engine) -> None:
    token, seen = CancelToken(), []
    with pytest.raises(Cancelled):
        for event in engine.run(replace(REQUEST, steps=50), cancel=token):
            if isinstance(event, Progress) and event.stage == "sample":
                seen.append(event.step)
                if event.step == 3:
                    token.cancel()
    assert seen == [1, 2, 3]
    assert run(engine, REQUEST).duets


def test_what_cannot_be_shown_is_said(engine: Engine) -> None:
    three = run(engine, replace(REQUEST, prompt="Three people hug.")).notes
    assert any("Only two people" in note for note in three)
    for prompt, unread in (
        ("They consider their taxes.", True),
        ("He proposes to her.", False),
        ("They dance a tango.", False),
    ):
        notes = " ".join(run(engine, replace(REQUEST, prompt=prompt)).notes)
        assert ("Not understood" in notes) is unread, prompt
        assert "far from anything" not in notes or (unread and ".”." not in notes), prompt


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"seconds": float("nan")}, "Length"),
        ({"seed": "one"}, "Seed"),
        ({"damping": 1.5}, "Damping"),
        ({"sampler": "euler"}, "Sampler"),
    ],
)
def test_requests_out_of_range_are_refused_with_a_sentence(change: dict, says: str) -> None:
    with pytest.raises(InputError, match=rf"\A.*{says}.*\.\Z"):
        replace(REQUEST, **change)


@pytest.mark.parametrize(
    ("name", "damage"),
    [("config.json", "missing"), ("model.safetensors", "altered"), ("captions.safetensors", "empty")],
)
def test_missing_or_altered_weights_are_refused(weights: Path, tmp_path: Path, name: str, damage: str) -> None:
    copy = tmp_path / "weights"
    shutil.copytree(weights, copy)
    file = copy / "intergen" / name
    if damage == "missing":
        file.unlink()
    elif damage == "empty":
        file.write_bytes(b"")
    else:
        data = bytearray(file.read_bytes())
        data[len(data) // 2] ^= 0xFF
        file.write_bytes(data)
    with pytest.raises(InputError, match="restore"):
        list(Engine(copy).run(REQUEST))


def test_two_threads_warm_up_once(monkeypatch: pytest.MonkeyPatch) -> None:
    engine, runs = Engine(), []
    monkeypatch.setattr(engine, "run", lambda request: (time.sleep(0.1), runs.append(request), iter(()))[2])
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda _: engine.warm_up(), range(2)))
    assert len(runs) == 1
