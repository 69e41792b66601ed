"""Motion on one page."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from motion import Clip, Duet
from motion.skeleton import SBU15
from motion.transforms import turn
from tests.motion.bodies import marching
from webdemo.view.contact_sheet import contact_sheet

A = marching(90)[0]
DUET = Duet.from_positions(np.stack([A, turn(A, np.pi) + np.array([0, 0, 3.0])]), fps=30)
BLUE, ORANGE = (31, 95, 168), (196, 84, 10)


def _share(picture: Image.Image, colour: tuple[int, int, int]) -> float:
    return float((np.asarray(picture) == colour).all(axis=-1).mean())


def test_two_people_in_two_colours_a_on_the_left(tmp_path):
    picture = contact_sheet(DUET, tmp_path / "sheet.png", title="march")
    assert Image.open(tmp_path / "sheet.png").size == picture.size == (8 * 200, 512)
    assert _share(picture, BLUE) > 0.002 and _share(picture, ORANGE) > 0.002
    first_tile = np.asarray(picture)[26 : 26 + 270, :200]
    columns = [np.flatnonzero((first_tile == colour).all(axis=-1).any(axis=0)).mean() for colour in (BLUE, ORANGE)]
    assert columns[0] < columns[1]


def test_one_person_has_one_colour_and_the_left_hand_is_light_and_on_the_right():
    picture = np.asarray(contact_sheet(Clip(A, 30), frames=1, tile=300))
    assert not (picture == ORANGE).all(axis=-1).any()
    upper = picture[: int(300 * 1.35)]
    dark, light = (np.flatnonzero((upper == c).all(axis=-1).any(axis=0)) for c in (BLUE, (120, 175, 232)))
    assert light.max() > dark.max()


@pytest.mark.parametrize("frames", [1, 3, 8])
def test_short_motions_and_other_skeletons(frames):
    clip = Clip(np.random.default_rng(0).normal(size=(3, 15, 3)), 15, SBU15)
    assert contact_sheet(clip, frames=frames).width == 200 * min(frames, 3)


def test_a_motion_in_one_point_is_drawn():
    assert contact_sheet(Clip(np.zeros((2, 22, 3)), 30)).height > 100
