"""Reactions of forty seconds: takes are cut, parts go on where the last one ended, figures are per ten seconds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion import Duet, InputError
from motion.formats import write
from tests.motion.bodies import marching
from training.evaluate import long_reactions
from training.evaluate.long_reactions import by_part, figures, in_parts, takes

POSITIONS, _ = marching(60)
BOTH = np.stack([POSITIONS, POSITIONS * [-1, 1, -1] + [0, 0, 1.5]])


def lasting(frames: int) -> np.ndarray:
    """Two people who march on the spot for so long."""
    rounds = np.tile(BOTH - BOTH[:, :, :1] * [1, 0, 1], (1, -(-frames // 60), 1, 1))[:, :frames]
    return rounds + np.array([[0, 0, 0], [0, 0, 1.5]])[:, None, None]


@pytest.mark.parametrize("frames", [300, 301, 599, 605, 700, 1200])
def test_parts_go_on_from_the_pose_before_and_cover_the_take(frames: int) -> None:
    seen: list[tuple[int, np.ndarray]] = []

    def react(part: np.ndarray) -> np.ndarray:
        seen.append((part.shape[1], part[1, 0].copy()))
        return part[1, :1] + 0.001 * np.arange(part.shape[1])[:, None, None]

    people = lasting(frames)
    made = in_parts(react, people)
    assert made.shape == people[1].shape and all(31 <= length <= 300 for length, _ in seen)
    np.testing.assert_allclose(made, people[1, :1] + 0.001 * np.arange(frames)[:, None, None], atol=1e-9)
    np.testing.assert_array_equal(seen[0][1], people[1, 0])


def test_figures_say_how_far_and_how_alive_a_reactor_is() -> None:
    people = lasting(300)
    still = np.repeat(people[1, :1], 300, axis=0)
    pelvises, inside, facing, speed, jerk, _, off = figures(people, people[1])
    assert pelvises == pytest.approx(1.5, abs=0.01) and inside == 0 and facing < 15
    assert speed == 1 and jerk > 0 and off == 0
    assert figures(people, still)[3:5].tolist() == [0, 0]
    turned = figures(people, people[1] * [-1, 1, -1] + [0, 0, 3.0])
    assert turned[2] > 165
    assert figures(people, people[0])[1] == 100


def test_a_last_part_counts_from_five_seconds_on() -> None:
    pairs = [lasting(frames) for frames in (1200, 449, 450)]
    found = by_part(pairs, [people[1] for people in pairs])
    assert [count for count, _ in found] == [3, 2, 1, 1]


def test_takes_of_ten_seconds_are_read_and_cut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="beside"):
        takes(tmp_path)
    monkeypatch.setattr(long_reactions, "LONGEST", 310)
    for name, frames in (("01", 299), ("02", 320)):
        write(Duet.from_positions(lasting(frames), fps=30.0), tmp_path / f"{name}.bvh")
    (found,) = takes(tmp_path)
    np.testing.assert_allclose(found, lasting(310), atol=0.02)


def test_the_command_prints_a_row_for_each_ten_seconds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(long_reactions, "takes", lambda folder: [lasting(600)])
    monkeypatch.setattr(
        long_reactions, "methods", lambda engine, seed: {"Recorded": lambda people: people[1]}
    )
    assert long_reactions.main(["--takes", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4 and lines[3].startswith("| Recorded | 10 to 20 (1) |")
