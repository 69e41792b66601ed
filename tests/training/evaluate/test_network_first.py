"""Which acts the network makes by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from acts import lexicon
from acts.staging.poses import upright
from acts.staging.window import KnownFrames, KnownPath
from training.evaluate import network_first
from training.evaluate.network_first import Made, found, places_of, table


def test_of_poses_the_places_are_left() -> None:
    frames = list(range(0, 61, 4))
    poses = np.stack([upright(np.array([0.0, t / 60]), 0.5) for t in frames])
    way = KnownPath(1, [3], np.zeros((1, 2)))
    body, (_, hand) = KnownFrames(0, frames, poses), (0, KnownFrames(0, frames, poses, joints=(20, 21)))
    path, same = places_of([body, hand, way])
    assert same is way and isinstance(path, KnownPath) and path.frames == [0, 32, 60]
    np.testing.assert_allclose(path.places, poses[[0, 8, 15], 0][:, [0, 2]])
    assert path.turned and path.headings == pytest.approx([0.5] * 3)
    low, path = places_of([KnownFrames(0, frames, poses - np.outer(np.arange(16) > 7, [0.0, 0.6, 0.0])[:, None])])
    assert isinstance(low, KnownFrames) and low.joints == (0,) and low.frames == frames[8:]
    assert isinstance(path, KnownPath) and not path.turned and path.headings is None, "the hips of who lies say nothing"
    assert path.frames == [0, 28]


@pytest.mark.parametrize(
    ("shown", "zeros", "done", "tried", "own"),
    [((1, 2, 3), False, 3, 3, True), ((1, 2, 3), True, 0, 0, False), ((2,), False, 1, 3, False)],
)
def test_an_act_is_the_network_s_with_three_of_four_seeds_and_without_zeros(
    shown: tuple[int, ...], zeros: bool, done: int, tried: int, own: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, int, bool]] = []

    def run(request: Any, empty: bool) -> Any:
        asked.append((request.beats[0].words, request.seed, empty))
        return zeros if empty else request.seed in shown

    monkeypatch.setattr(network_first, "checked", lambda plan, duet: [SimpleNamespace(done=duet)])
    each = found(run, "wave", lexicon().entries["wave"])
    assert each is not None and each.by_network is own and asked[0][2] and not any(empty for *_, empty in asked[1:])
    assert each == Made("wave", ("gesture",), each.words, done, tried, zeros)
    assert ("wave" in table([each]).splitlines()[-1]) is own


def test_further_wordings_are_tried_until_one_makes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(network_first, "checked", lambda plan, duet: [SimpleNamespace(done=duet)])
    first: list[str] = []

    def run(request: Any, empty: bool) -> Any:
        first.append(request.beats[0].words)
        return request.beats[0].words != first[0]

    each = found(run, "nod", lexicon().entries["nod"])
    assert each is not None and each.by_network and each.words != first[0] and each.tried == 3
