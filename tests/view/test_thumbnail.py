"""The thumbnails of motions: how tall people are in them."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np

from motion import Duet
from tests.ui.stub_engine import walking
from webdemo.view.thumbnail import FRAMES, JOINTS, thumbnail


def tall(motion: Duet) -> float:
    """The height of person A at first, as a share of the picture's."""
    drawn = np.frombuffer(base64.b64decode(thumbnail(motion))[2:], np.uint8).reshape(2, FRAMES, len(JOINTS), 2)
    return float(np.ptp(drawn[0, 0, :, 1].astype(float))) / 255


def test_people_far_apart_are_about_as_tall_as_others() -> None:
    near = walking(1.0)
    far = replace(near, b=replace(near.b, positions=near.b.positions + np.array([0.0, 0.0, 8.0], np.float32)))
    assert tall(far) > 0.6 * tall(near) > 0.3
