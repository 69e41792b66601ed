"""Which acts the network makes by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from acts import lexicon
from training.evaluate import network_first
from training.evaluate.network_first import Made, found, table


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
