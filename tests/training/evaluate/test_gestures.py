"""The recogniser's scores, gesture by gesture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tests.training.trainers.runs import write_corpus
from training.evaluate.gestures import main, table


def test_the_worst_gesture_comes_first() -> None:
    found = table({"wave": 0.5, "bow": 0.25}, {"wave": 4, "bow": 8}).splitlines()
    assert found[2:] == ["| bow | 25 % | 8 |", "| wave | 50 % | 4 |"]


def test_the_shipped_recogniser_is_scored_on_the_test_split(tmp_path: Path, capsys) -> None:
    folder = write_corpus(tmp_path / "corpus", scenes=8)
    motions = np.load(folder / "motions.npy")
    rows = json.loads((folder / "index.json").read_text())
    for i, row in enumerate(rows):
        row |= {"family": ("wave-back", "bow-back")[i % 2], "split": "test" if i < 6 else "train"}
        row |= {"start": 0, "frames": min(90, len(motions))}
    (folder / "index.json").write_text(json.dumps(rows))
    out = tmp_path / "gestures.json"
    assert main(["--corpus", str(folder), "--windows", "2", "--answered", "4", "--out", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["windows"] == 12 and found["looks"]["wave"] == found["looks"]["bow"] == 6
    assert found["looks"]["hug"] == 0 and set(found["by gesture"]) == {"wave", "bow"}
    assert found["all looks"]["scenes"] == 4
    assert "| Gesture |" in capsys.readouterr().out
    assert main(["--corpus", str(tmp_path / "none")]) == 2
