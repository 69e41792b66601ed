"""The trainer of classes: what a scene's class is, runs that stop, and the folder that comes out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import torch

from models.bigraphdiff.compact import CompactBiGraphDiff
from models.weights_io import load_network
from motion import InputError
from tests.training.trainers.runs import flags, prepared, resumed
from training import prepare
from training.corpus.cues import Beat, label
from training.trainers import bigraphdiff
from training.trainers.bigraphdiff import Settings, Trainer, labels_of, of_classes

SETTINGS = Settings(
    latent_dim=32, ff_size=16, num_layers=1, num_heads=2, embed_dim=16, cond_dim=8, batch=4, steps=6, warmup=2
)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Half of the scenes are handshakes, in the others both wave; one is of two beats, which is no class."""

    def edit(rows: list[dict[str, Any]]) -> None:
        for i, row in enumerate(rows):
            cue = "shake-hands" if i % 2 else "wave"
            row["label"] = label([Beat((cue, cue), 0, row["frames"], relation="while")], row["frames"]).row()
            beat = {"start": 0, "end": row["frames"], "acts": [cue, cue], "minor": False, "captions": ["They wave."]}
            row["beats"] = [beat, beat] if i == 4 else []

    return prepared(tmp_path_factory.mktemp("classes"), scenes=13, edit=edit)


def test_labels_are_classes_and_what_most_of_their_scenes_touch_is_theirs(scenes: Path) -> None:
    loaded = of_classes(prepare.load(scenes))
    assert len(loaded.rows) == 12
    names, touches = labels_of(loaded)
    assert names == ("shake hands", "wave")
    assert touches == ((("right_wrist", "right_wrist"),), ())
    loaded.rows = [row | {"label": None} for row in loaded.rows]
    with pytest.raises(InputError, match="build the corpus anew"):
        of_classes(loaded)


def test_a_run_that_stops_goes_on_as_if_it_never_had(scenes: Path, tmp_path: Path) -> None:
    loaded = prepare.load(scenes)
    terms, kept = resumed(lambda out: Trainer(loaded, SETTINGS, out), tmp_path, steps=6)
    assert terms[-1]["total"] < terms[0]["total"]
    seen = kept["ema/denoiser.network.temporal_decoder_blocks.0.bipartite_graph.blocker.running_var"]
    assert not torch.equal(seen, torch.ones_like(seen))


def test_the_shell_writes_the_folder_that_is_shipped(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sizes = flags(SETTINGS, "latent_dim", "ff_size", "num_layers", "num_heads", "embed_dim", "cond_dim", "batch")
    words = ["--scenes", str(scenes), "--out", str(tmp_path / "run"), *sizes]
    assert bigraphdiff.main([*words, "--steps", "2", "--export", str(tmp_path / "weights")]) == 0
    model, source = load_network(tmp_path / "weights", CompactBiGraphDiff)
    assert model.config.labels == ("shake hands", "wave")
    assert source.meta["trained_steps"] == 2 and "class" in source.meta["card"]["summary"]
    assert bigraphdiff.main([*words, "--latent-dim", "40", "--steps", "2"]) == 2
    assert "multiple of 16" in capsys.readouterr().err
