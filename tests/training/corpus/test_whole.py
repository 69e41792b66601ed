"""Acts that recordings show whole: what is played is what the label says, and where."""

from __future__ import annotations

import numpy as np
import pytest

from tests.training.corpus.recorded import SOURCES, main, path, staged, walk
from training.corpus.beats.acts import ACTS
from training.corpus.beats.script import opening
from training.corpus.cues import STILL, SourceClip
from training.corpus.library import Library


def lowered(frames: int, start: float, stop: float) -> np.ndarray:
    """A person who sinks from ``start`` to ``stop`` metres."""
    body = walk(frames, speed=0.0).copy()
    body[..., 1] -= np.linspace(start, stop, frames)[:, None]
    return body


def clip(positions: np.ndarray, action: str, side: str | None = None) -> SourceClip:
    return SourceClip(positions, action, "normal", side, f"train-{action}", "made-up", "train")


@pytest.fixture(scope="module")
def library() -> Library:
    own = [
        clip(lowered(50, 0.0, 0.45), "crouch-down", "right"),
        clip(lowered(50, 0.45, 0.0), "crouch-up", "right"),
        clip(walk(200, speed=2.0), "skip"),
        clip(lowered(300, 0.0, 0.0), "sway"),
        clip(lowered(300, 0.0, 0.0), "shadow-box"),
    ]
    return Library([*SOURCES, *own], "train")


def test_who_skips_passes_the_other_who_stays(library: Library) -> None:
    scene = staged(library, ("skip", "skip", STILL))
    beat = main(scene)[0]
    i = beat["acts"].index("skip")
    own, other = path(scene, i, beat), path(scene, 1 - i, beat)
    ahead = (other[0] - own[0]) / np.linalg.norm(other[0] - own[0])
    assert (own[-1] - other[0]) @ ahead > 0.2 > (own[0] - other[0]) @ ahead
    assert np.linalg.norm(other[-1] - other[0]) < 0.3
    assert all("skip" in text or "pranc" in text or "gallop" in text for text in scene.captions)


def test_clips_that_follow_each_other_are_mirrored_alike(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    sides: list[str | None] = []
    take = library.take

    def seen(rng: np.random.Generator, action: str, **wanted):
        drawn = take(rng, action, **wanted)
        sides.append(drawn.side)
        return drawn

    monkeypatch.setattr(library, "take", seen)
    for seed in range(8):
        ACTS["crouch>stand-up"].make(opening(np.random.default_rng(seed), library), 0)
    assert sides[::2] == sides[1::2] and set(sides) == {"left", "right"}
