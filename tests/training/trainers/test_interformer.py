"""The compact InterFormer's trainer, on scenes that take a moment to make."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from models.interformer.compact import CompactInterFormer
from models.weights_io import load_network
from motion import SMPL22
from motion.transforms import heading
from tests.training.trainers.runs import flags, resumed
from training.corpus.pairs import Pair
from training.trainers import interformer
from training.trainers.interformer import Settings, Trainer, varied

SETTINGS = Settings(joint_width=4, ff_size=16, batch=4, steps=6, warmup=2, rounds=2, own_past=0.5)


@pytest.fixture(scope="module")
def scenes() -> list[np.ndarray]:
    """Two people a metre apart; the one gives way as much as the other comes, each time at another speed."""
    rest = SMPL22.rest_positions() + np.array([0.0, 0.98, 0.0])
    found = []
    for i in range(10):
        way = np.linspace(0, 0.2 + 0.05 * i, 40 + 2 * i)[:, None, None] * np.array([0.0, 0.0, 1.0])
        found.append(np.stack([rest + way, rest * np.array([-1.0, 1.0, -1.0]) + [0, 0, 1.0] + way]))
    return found


def test_a_run_that_stops_goes_on_as_if_it_had_not(scenes, tmp_path: Path) -> None:
    resumed(lambda out: Trainer(scenes, SETTINGS, out), tmp_path)


def test_training_changes_the_attention_and_leaves_the_linear_part(scenes, tmp_path: Path) -> None:
    trainer = Trainer(scenes, SETTINGS, tmp_path)
    before = {name: p.clone() for name, p in trainer.model.named_parameters()}
    for _ in range(3):
        terms = trainer.train_step()
    assert {"sequence", "velocity", "first_frame", "interaction", "total"} == terms.keys()
    assert all(np.isfinite(value) for value in terms.values())
    after = dict(trainer.model.named_parameters())
    assert torch.equal(after["linear.weight"], before["linear.weight"])
    assert not torch.equal(after["decoder.0.other_space.out.weight"], before["decoder.0.other_space.out.weight"])


def test_a_varied_scene_is_of_the_networks_rate_and_seen_from_the_actor(scenes) -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        people = varied(scenes[0], SETTINGS, rng)
        assert 9 <= people.shape[1] <= 27  # 40 frames at 30 a second, a quarter faster or slower
        np.testing.assert_allclose(people[0, 0, 0, [0, 2]], 0.0, atol=1e-9)
        assert abs(heading(people[0, 0])) <= np.radians(SETTINGS.turn) + 1e-6
        gap = np.linalg.norm(people[1, :, 0] - people[0, :, 0], axis=-1)
        assert np.ptp(gap) < 1e-6 and abs(gap[0] - 1) <= SETTINGS.size + 1e-6


def test_benchmark_clips_stay_out_and_weights_are_written(scenes, tmp_path: Path, monkeypatch, capsys) -> None:
    pairs = [Pair(people, "push", "sbu", str(i), i == 9, 0.0) for i, people in enumerate(scenes)]
    monkeypatch.setattr(interformer, "load_pairs", lambda *_: pairs)
    seen = []
    monkeypatch.setattr(interformer, "Trainer", lambda given, *rest: seen.append(given) or Trainer(given, *rest))
    sizes = flags(SETTINGS, "joint_width", "ff_size", "batch", "warmup", "rounds")
    command = ["--data", "x", "--out", str(tmp_path / "run"), "--export", str(tmp_path / "w"), *sizes]
    assert interformer.main([*command, "--steps", "2"]) == 0
    assert len(seen[0]) == 9
    model, source = load_network(tmp_path / "w", CompactInterFormer)
    assert source.meta["trained_steps"] == 2 and model.stance[:, 1].max() > 1.4
    assert json.loads((tmp_path / "run" / "log.jsonl").read_text().splitlines()[-1])["step"] == 2
    assert interformer.main([*command, "--steps", "3"]) == 2
    assert "other settings" in capsys.readouterr().err
