"""Role swap: retrieval by features that hear roles falls, by features that do not it stays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion import Duet, InputError
from motion.transforms import heading
from training.evaluate.roles import exchanged, of_two_parts, swap_scores, table

from .puppets import play


class Heights:
    """Features for tests: how high the right hands of both are; what a sentence should show is its number."""

    def __init__(self, *, hears_roles: bool) -> None:
        self.hears_roles = hears_roles

    def motion(self, duets: list[Duet]) -> np.ndarray:
        rows = np.array([duet.positions[:, 30, 21, 1] for duet in duets], dtype=np.float64)
        return rows if self.hears_roles else np.sort(rows, axis=1)

    def text(self, captions: list[str]) -> np.ndarray:
        rows = np.array([[float(part) for part in caption.split()] for caption in captions])
        return rows if self.hears_roles else np.sort(rows, axis=1)


def scene(rng: np.random.Generator) -> Duet:
    positions = play("", 2)
    positions[:, :, 21, 1] = rng.uniform(0.5, 2.0, size=(2, 1))
    return Duet.from_positions(positions, fps=30.0)


@pytest.mark.parametrize("hears_roles", [True, False])
def test_exchanged_people_are_heard_or_not(hears_roles: bool) -> None:
    rng = np.random.default_rng(0)
    duets = [scene(rng) for _ in range(32)]
    captions = [f"{d.positions[0, 30, 21, 1]:.6f} {d.positions[1, 30, 21, 1]:.6f}" for d in duets]
    features: Any = Heights(hears_roles=hears_roles)
    found = swap_scores(duets, captions, features, [True] * 20 + [False] * 12)
    assert found["as_is"][0] == 1.0
    assert found["nearer"] == ([20, 20] if hears_roles else [0, 20])
    assert (found["swapped"][0] < 0.3) if hears_roles else (found["swapped"] == found["as_is"])


def test_exchanged_people_stand_where_a_scene_begins() -> None:
    duet = Duet.from_positions(play("gap 2; a walk 0.5 1.5 0 0.8", 2), fps=30.0)
    found = exchanged(duet)
    np.testing.assert_allclose(found.a.positions[0, 0, [0, 2]], 0.0, atol=1e-5)
    assert heading(found.a.positions)[0] == pytest.approx(0.0, abs=1e-5)
    gaps = [d.positions[0] - d.positions[1] for d in (found, duet)]
    np.testing.assert_allclose(*[np.linalg.norm(gap, axis=-1) for gap in gaps], atol=1e-5)
    assert np.ptp(found.b.positions[:, 0, 2]) == pytest.approx(0.8, abs=1e-3)  # the one who walked


def test_too_few_scenes_are_refused() -> None:
    features: Any = Heights(hears_roles=True)
    with pytest.raises(InputError, match="fewer than the 32"):
        swap_scores([], [], features, [])


def test_words_that_both_can_do_give_no_parts() -> None:
    assert of_two_parts("leave") and of_two_parts("guide-follow")
    assert not of_two_parts("meet") and not of_two_parts("no such family")


def test_the_tables_hold_both_kinds_of_motion() -> None:
    roles = {"as_is": [0.7, 0.8, 0.9], "swapped": [0.2, 0.3, 0.4], "nearer": [9, 10]}
    touch = {"hand–hand": {"precision": (3, 4), "recall": (3, 5)}}
    shown = table(
        {
            "about": "Ten.",
            "roles": {"generated": roles, "recorded": roles},
            "contacts": touch,
            "contacts_swapped": {"hand–hand": {"precision": (1, 4), "recall": (1, 5)}},
        }
    )
    assert "| R-precision top 1 | 0.700 → 0.200 exchanged |" in shown
    assert "| hand–hand | 75 % (3/4; 30–95 %) | 60 % (3/5; 23–88 %) | 20 % (1/5; 4–62 %) |" in shown
