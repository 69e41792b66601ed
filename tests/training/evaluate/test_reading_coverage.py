from __future__ import annotations

import lzma
from pathlib import Path

import pytest

from training.evaluate.reading_coverage import coverage, main, sampled


def test_the_sample_is_the_same_each_time_and_has_each_caption_once(tmp_path: Path) -> None:
    file = tmp_path / "captions.txt.xz"
    with lzma.open(file, "wt", encoding="utf-8") as packed:
        packed.writelines(f"a person takes {i % 9} steps.\n" for i in range(90))
    assert sampled(file, 5) == sampled(file, 5)
    assert len(set(sampled(file))) == 9


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "captions.xz").write_bytes(b"not packed")
    for name in ("captions.xz", "none.txt"):
        assert main([str(tmp_path / name)]) == 2
        assert f"{name} holds no captions" in capsys.readouterr().err


def test_what_is_left_over_is_counted() -> None:
    found = coverage(["A person waves.", "A person glorps a wumpus."])
    assert found["whole"] == 0.5 and "wumpus" in found["left"]
    assert found["read"][0] == {"caption": "A person waves.", "acts": ["a wave"], "unread": [], "doubts": []}
