"""What the scores of futures are made of: distances, facings, and which recordings count."""

import numpy as np
import pytest

from motion import SMPL22, Duet
from motion.transforms import heading_matrix
from training.corpus.scene import Scene
from training.evaluate.futures import FUTURE, errors, facings, held_out, methods, table
from webdemo.inference import Engine

REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def pair(gap: float, angle: float = 0.0, frames: int = 5) -> np.ndarray:
    """a at the origin, turned by an angle in degrees from b, who is so many metres in front of them and looks back."""
    a = REST @ heading_matrix(np.radians(angle)).T
    b = REST @ heading_matrix(np.pi).T + np.array([0, 0, gap])
    return np.repeat(np.stack([a, b])[:, None], frames, axis=1)


def test_people_who_look_at_each_other_face_straight() -> None:
    np.testing.assert_allclose(np.cos(facings(pair(1.0))), 1.0, atol=1e-6)


def test_errors_are_in_centimetres_and_degrees_the_short_way_round() -> None:
    assert errors(pair(1.2), pair(1.0)) == (pytest.approx(20.0, abs=1e-3), pytest.approx(0.0, abs=1e-3))
    assert errors(pair(1.0, 170.0), pair(1.0, -170.0))[1] == pytest.approx(
        10.0, abs=1e-3
    )  # the mean of both people


def test_only_long_recordings_of_the_test_lists_count() -> None:
    def scene(split: str, frames: int) -> Scene:
        return Scene(positions=pair(1.0, frames=frames), family="x", sources=("x",), split=split)

    wanted = scene("benchmark", 45)
    assert held_out([scene("train", 90), scene("benchmark", 35), wanted]) == [wanted]


def test_the_table_has_means_and_their_errors() -> None:
    shown = table({"both": np.array([[10.0, 2.0], [20.0, 4.0]])})
    assert "| 2 recorded pairs |" in shown and "| both | 15.0 ± 3.5 | 3.0 ± 0.7 |" in shown


def test_a_motion_is_predicted_by_all_methods() -> None:
    past = Duet.from_positions(pair(1.5, frames=30), fps=30.0)
    for foretell in methods(Engine(), steps=1).values():
        futures = foretell(past, "They wave.")
        assert futures and all(f.shape == (2, FUTURE, 22, 3) for f in futures)
