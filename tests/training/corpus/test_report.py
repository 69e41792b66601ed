"""The report of a corpus of three scenes."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from motion import SMPL22
from training.corpus import report
from training.corpus.cues import STILL, Beat, label

WRIST = SMPL22.index("right_wrist")
TOUCH = {"a": "right_wrist", "b": "right_wrist", "start": 10, "end": 20}


def people(gap: float) -> np.ndarray:
    """(60, 2, 22, 3): b stands before a with the right wrists ``gap`` metres apart from frame 10 to 20."""
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    pair = np.stack([np.broadcast_to(rest + np.array([0, 0, z]), (60, 22, 3)) for z in (0, 1)], axis=1).copy()
    pair[10:21, 1, WRIST] = pair[10:21, 0, WRIST] + [0, 0, gap]
    return pair


@pytest.fixture
def corpus(tmp_path: Path) -> Path:
    rows = [("shake", [TOUCH], "train"), ("shake", [TOUCH], "test"), ("stand", None, "train")]
    index = [
        {"start": 60 * i, "frames": 60, "family": family, "captions": [f"{family} {i}"], "split": split}
        | {"events": {"contact": touch} if touch else {}, "sources": ["x"]}
        for i, (family, touch, split) in enumerate(rows)
    ]
    np.save(tmp_path / "motions.npy", np.concatenate([people(g) for g in (0.06, 0.10, 0.5)]).astype("f4"))
    (tmp_path / "index.json").write_text(json.dumps(index))
    return tmp_path


def test_the_report_counts_acts_people_and_the_share_of_recorded_duets(
    corpus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    index = json.loads((corpus / "index.json").read_text())
    beats = [Beat(("dance", "dance"), 0, 45, relation="while"), Beat(("twirl", ""), 45, 60, relation="while")]
    made = label(beats, 60).row()
    index[0] |= {"sources": ["cmu-salsa/05"], "label": made}
    index[1] |= {
        "sources": ["accad_Female1_A07_Crouch", "cmu-solo_10_01", "cmu-iclone_002_06"],
        "label": label([Beat(("shake-hands", "hug?"), 0, 60), Beat((STILL, STILL), 0, 60)], 60).row(),
    }
    index[2] |= {"sources": ["sbu/s01s02/06/001", "bandai"]}
    (corpus / "index.json").write_text(json.dumps(index))
    out = tmp_path / "docs"
    assert report.main(["--corpus", str(corpus), "--out", str(out)]) == 0
    text = (out / "corpus.md").read_text()
    assert text.strip() == capsys.readouterr().out.strip()
    assert "3 scenes, 0.0 hours" in text and "1 scenes are for testing" in text
    assert "2 scenes (0 minutes, 66.7 %) are recorded duets." in text
    rows = {line.split("|")[1].strip(): line for line in text.splitlines() if line.startswith("| ")}
    assert rows["shake-hands"] == "| shake-hands | 1 | 0.0 | 0.0 | 10 | [sheet](corpus/shake-hands.png) |"
    assert rows["stand-still"].endswith("| – |")
    drawn = {path.stem for path in (out / "corpus").iterdir()}
    assert drawn == {"dance", "twirl", "shake-hands", "hug-offered"}
    assert Image.open(out / "corpus" / "dance.png").width == report.PICTURE_WIDTH // 6 * 6


def test_a_folder_without_a_corpus(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert report.main(["--corpus", str(tmp_path), "--out", str(tmp_path / "docs")]) != 0
    assert "python -m training.corpus" in capsys.readouterr().err
    assert not (tmp_path / "docs").exists()
