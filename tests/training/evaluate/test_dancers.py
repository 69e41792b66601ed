"""Errors of predicted dancers: after which frames, and of which future."""

import numpy as np

from training.evaluate.dancers import errors, table
from webdemo.inference import Engine

from .test_futures import pair


def test_parts_are_compared_after_so_many_frames_and_the_nearest_future_apart() -> None:
    found = errors(Engine(), [pair(1.5, frames=100), pair(1.2, frames=80)])
    assert {rows.shape for rows in found.values()} == {(1, 4)}  # the second take is too short
    held = next(rows for name, rows in found.items() if "Zero velocity" in name)
    np.testing.assert_allclose(held, 0.0, atol=1e-3)
    drawn, nearest = (found[name] for name in found if name.startswith("InterGen"))
    assert 0 < nearest.mean() <= drawn.mean()
    assert "| 1 parts, mm | 0.2 s |" in table(found)
