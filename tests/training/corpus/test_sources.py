"""Recordings from folders and archives, split by source, cached."""

from __future__ import annotations

import logging

import numpy as np
import pytest

from motion import InputError
from motion.transforms import heading, turn
from tests.motion.bodies import marching
from tests.motion.formats.rigs import RIGS, bvh_text
from training.corpus.sources import describe_source, load_sources


def _text(frames: int, name: str = "bandai-namco", fps: float = 30.0) -> str:
    positions, rotations = marching(frames)
    rotations = rotations.copy()
    rotations[:, 6] = np.eye(3)  # the rig has no spine2
    return bvh_text(rotations, turn(positions[:, 0], 1.0) + np.array([3, 0, 4]), RIGS[name], frame_time=1 / fps)


@pytest.fixture
def data(tmp_path):
    """16 left waves, 3 bows, a 50 s idle at 24 fps and four bad files."""
    folder = tmp_path / "data" / "bandai-namco" / "set-2" / "data"
    idle = tmp_path / "data" / "reactidle" / "acted"
    folder.mkdir(parents=True)
    idle.mkdir(parents=True)
    text = _text(20)
    for number in range(16):
        (folder / f"dataset-2_wave-left-hand_normal_{number:03}.bvh").write_text(text)
    for number in range(3):
        (folder / f"dataset-1_bow_masculinity_{number:03}.bvh").write_text(text)
    (idle / "004_acted.bvh").write_text(_text(1200, "reactidle", fps=24.0))
    last = text.splitlines()[-1]
    (folder / "dataset-1_kick_normal_001.bvh").write_text(_text(1))
    (folder / "dataset-1_kick_normal_002.bvh").write_text(text.replace(last, last.replace(last.split()[4], "nan")))
    (folder / "dataset-1_kick_normal_003.bvh").write_text(text[:900])
    (folder / "dataset-1_kick_normal_004.bvh").write_bytes(b"")
    return tmp_path / "data"


def test_clips_are_described_placed_and_split(data, tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        clips = load_sources(data, cache_dir=tmp_path / "cache")
    assert "4 of 24 recordings were left out" in caplog.text
    assert not [path for path in (tmp_path / "cache").iterdir() if path.suffix != ".npz"]
    waves = [clip for clip in clips if clip.action == "wave"]
    assert len(waves) == 16 and {(c.side, c.style, c.dataset) for c in waves} == {("left", "normal", "bandai-namco-2")}
    assert sum(clip.split == "test" for clip in waves) == 1
    bows = [clip for clip in clips if clip.action == "bow"]
    assert {(c.side, c.style, c.split) for c in bows} == {(None, "masculine", "both")} and len(bows) == 3
    idle = [clip for clip in clips if clip.action == "idle"]
    assert len(idle) == 3 and len({clip.source for clip in idle}) == 1
    assert sum(len(clip.positions) for clip in idle) == pytest.approx(1200 / 24 * 30, abs=2)
    for clip in clips:
        assert clip.positions.shape == (len(clip.positions), 22, 3)
        np.testing.assert_allclose(clip.positions[0, 0, [0, 2]], 0, atol=1e-5)
        assert abs(heading(clip.positions[0])) < 1e-4
        assert clip.positions[..., 1].min() > -0.02


def test_second_load_reads_the_cache_a_damaged_one_is_read_again_and_changes_are_noticed(data, tmp_path, monkeypatch):
    first = load_sources(data, cache_dir=tmp_path / "cache")
    with monkeypatch.context() as patch:
        patch.setattr("training.corpus.sources.read_bvh", lambda *a, **k: pytest.fail("read again"))
        second = load_sources(data, cache_dir=tmp_path / "cache")
    assert [(c.source, c.split, c.side) for c in first] == [(c.source, c.split, c.side) for c in second]
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)
    (cache,) = (tmp_path / "cache").glob("*.npz")
    cache.write_bytes(cache.read_bytes()[:1000])
    assert len(load_sources(data, cache_dir=tmp_path / "cache")) == len(first)
    next(data.rglob("*bow*000.bvh")).unlink()
    assert len(load_sources(data, cache_dir=tmp_path / "cache")) == len(first) - 1


def test_missing_empty_and_damaged_data_is_said(data, tmp_path):
    with pytest.raises(InputError, match="no motion recordings"):
        load_sources(tmp_path / "nowhere")
    for path in data.rglob("*.bvh"):
        path.write_text("HIERARCHY")
    with pytest.raises(InputError, match="24 of 24 recordings"):
        load_sources(data, cache_dir=tmp_path / "cache")
    broken = tmp_path / "broken" / "reactidle"
    broken.mkdir(parents=True)
    (broken / "idle.tar.xz").write_bytes(b"\xfd7zXZ\x00" + bytes(100))
    with pytest.raises(InputError, match=r"idle\.tar\.xz"):
        load_sources(tmp_path / "broken", cache_dir=tmp_path / "cache")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("dataset-1_byebye_not-confident_001.bvh", ("bye", "not-confident", None, "bandai-namco-1")),
        ("dataset-1_dance-short_normal_001.bvh", ("dance", "normal", None, "bandai-namco-1")),
        ("dataset-1_walk-back_sad_001.bvh", ("walk-back", "sad", None, "bandai-namco-1")),
        ("dataset-1_walk-left_sad_001.bvh", ("walk-left", "sad", "left", "bandai-namco-1")),
        ("dataset-2_walk-turn-right_active_001.bvh", ("walk-turn", "active", "right", "bandai-namco-2")),
        ("dataset-2_raise-up-both-hands_active_001.bvh", ("raise-hand", "active", "both", "bandai-namco-2")),
        ("dataset-2_wave-right-hand_active_001.bvh", ("wave", "active", "right", "bandai-namco-2")),
        ("genuine/003_genuine.bvh", ("idle", "normal", None, "reactidle")),
    ],
)
def test_names_tell_action_style_and_side(name, expected):
    action, style, side, source, dataset = describe_source(name)
    assert (action, style, side, dataset) == expected
    assert source.endswith(name.split("/")[-1].removesuffix(".bvh"))
