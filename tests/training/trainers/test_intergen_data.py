"""Batches of InterGen's trainer: sentences for each person, and beats continued from what came before."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from tests.training.trainers.runs import SETTINGS, begin, prepared
from training import prepare
from training.core.text_features import CaptionFeatures
from training.corpus.cues import STILL
from training.trainers import intergen
from training.trainers.given import Shares
from training.trainers.intergen_data import LEAST, SENTENCES, balanced


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return prepared(tmp_path_factory.mktemp("made"))


def with_sentences_for_each(scenes: Path, out: Path) -> Path:
    """The prepared scenes, each with sentences for a and for b alone; what is missing in the first is in the rest."""
    loaded = prepare.load(scenes)
    for i, row in enumerate(loaded.rows[1:]):
        a = ["They put out the right hand.", "They reach out."]
        row["alone"] = [a, ["They wait." if i % 2 else "They turn to the left."]]
    prepare.save(loaded, out)
    return out


def test_sentences_for_each_person_are_read_and_left_out(scenes: Path, tmp_path: Path) -> None:
    trainer = begin(with_sentences_for_each(scenes, tmp_path / "each.safetensors"), tmp_path)
    shares = {tuple(read): 0 for read in SENTENCES} | {(0, 0, 0): 0}
    for step in range(60):
        batch = trainer.data.batch(step)
        conditions = intergen.condition(trainer.model, batch)
        assert conditions.shape[:2] == (4, 3)
        # A sentence that is read has rows, and no other has.
        assert torch.equal((conditions != 0).any(-1).any(-1), batch.read.bool())
        for read in batch.read.bool().tolist():
            shares[tuple(read)] += 1
    assert all(shares.values()), shares
    assert shares[True, False, False] > shares[False, True, True] > shares[False, False, True]


def test_person_sentences_change_sides_with_the_mirror(scenes: Path, tmp_path: Path) -> None:
    path = with_sentences_for_each(scenes, tmp_path / "each.safetensors")
    data = begin(path, tmp_path, replace(SETTINGS, cond_drop_prob=0.0)).data
    seen = set()
    data.features = lambda captions: (seen.update(captions), CaptionFeatures.batch(data.captions, captions))[1]
    for step in range(40):
        data.batch(step)
    assert {"They turn to the left.", "They turn to the right."} <= seen


def with_beats(scenes: Path, out: Path) -> Path:
    """The prepared scenes, each of three beats: an unnamed one in the middle is minor."""
    loaded = prepare.load(scenes)
    for row in loaded.rows:
        beat = {"start": 0, "end": 10, "acts": ["stand", "stand"], "captions": ["They wait."]}
        row["beats"] = [
            beat,
            beat | {"minor": True},
            beat | {"start": 12, "end": 40, "acts": ["bow", "bow"], "captions": ["They bow."]},
        ]
    prepare.save(loaded, out)
    return out


def test_a_later_beat_is_learned_with_what_came_before_it_given(scenes: Path, tmp_path: Path) -> None:
    path = with_beats(scenes, tmp_path / "beats.safetensors")
    given = Shares(*[0.0] * 9)
    trainer = begin(path, tmp_path, replace(SETTINGS, continued=0.5, cond_drop_prob=0.0, given=given))
    read, cut, data = [], 0, trainer.data

    def features(captions: list[str]) -> tuple[torch.Tensor, torch.Tensor]:
        read.extend(captions)
        return CaptionFeatures.batch(data.captions, captions)

    data.features = features
    for step in range(12):
        read.clear()
        batch = trainer.data.batch(step)
        known = trainer.known(batch, torch.Generator().manual_seed(0))
        for i, past in enumerate(batch.past.tolist()):
            if not past:
                assert read[i] != "They bow."
                continue
            cut += 1
            assert read[i] == "They bow." and past == 12
            assert batch.frame_mask[i].sum() >= past + LEAST
            assert torch.equal(known.mask[i].any(-1).sum(-1), torch.tensor([past, past]))
            root = known.rows[i, 0, 0, :3]
            assert root[[0, 2]].abs().max() < 1e-4  # canonical again
            assert known.heading[i, 0, 0, 1] > 0.999
        assert np.isfinite(trainer.train_step()["total"])
    assert 12 < cut < 36


def test_rare_families_and_rare_acts_are_drawn_up_to_five_times() -> None:
    def row(family: str, *acts: str) -> dict[str, Any]:
        return {"family": family, "beats": [{"acts": [act, STILL]} for act in acts]}

    common = [row("beats", "walk") for _ in range(60)] + [row("hug") for _ in range(60)]
    rare = [row("beats", "walk", "jump") for _ in range(40)] + [row("beats", "crawl") for _ in range(4)]
    scarce = [row("whisper") for _ in range(40)]
    rows = [*common, *rare, *scarce]
    drawn = balanced(rows)
    repeats = [sum(other is each for other in drawn) for each in (rows[0], rows[60], rare[0], rare[-1], scarce[0])]
    assert repeats == [1, 1, 2, 5, 2]
