"""A network that listens moves with the sentence more than with the seed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22
from motion.transforms import turn
from training.evaluate.listening import listening, main


def standing(frames: int = 5, raised: float = 0.0) -> np.ndarray:
    """Two people (2, T, 22, 3) who stand, a hand raised by so many metres."""
    pose = np.tile(SMPL22.rest_positions(), (2, frames, 1, 1)).astype(np.float64)
    pose[:, :, SMPL22.index("left_wrist"), 1] += raised
    return pose


def test_what_the_seed_changes_is_told_from_what_the_sentence_changes() -> None:
    found = listening([[standing(), standing(raised=0.22)], [standing(7, 0.44), standing(7, 0.66)]])
    assert found == pytest.approx((1.0, 2.0))


def test_where_people_are_and_where_they_face_is_no_difference() -> None:
    moved = turn(standing(), 1.0) + np.array([2.0, 0.0, -1.0])
    assert listening([[standing(), moved], [standing(raised=0.22)]]) == pytest.approx((0.0, 1.0), abs=1e-9)


def test_the_command_reads_a_folder_of_motions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, raised in (("wave-1f-0", 0.0), ("wave-1f-1", 0.22), ("bow-2e-0", 0.44)):
        np.save(tmp_path / f"{name}.npy", standing(raised=raised))
    assert main([str(tmp_path)]) == 0
    assert "1.0 cm apart, of two sentences of a seed 2.0 cm" in capsys.readouterr().out
    (tmp_path / "plain").mkdir()
    np.save(tmp_path / "plain" / "bow-2e-0.npy", standing())
    assert main([str(tmp_path)]) == 2 and "several settings" in capsys.readouterr().err
    (tmp_path / "plain" / "bow-2e-0.npy").unlink()
    (tmp_path / "bow-2e-0.npy").unlink()
    assert main([str(tmp_path)]) == 2
