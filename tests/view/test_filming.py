"""The film look of films: the player's own move of the camera, haze and darker edges."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.static.test_node import newest_node
from webdemo.view.camera import cameras, sampled
from webdemo.view.filming import _VIGNETTE, move, moving_cameras
from webdemo.view.stage import Style
from webdemo.view.theme import THEMES

from .test_film import DUET, FAR, PARTING, SMALL

PLAYER = Path(__file__).parents[2] / "static" / "player"
TIMES = np.arange(PARTING.num_frames) / PARTING.fps


def test_the_move_and_the_haze_are_the_player_s() -> None:
    script = (
        f"import {{ hazy, move, VIGNETTE }} from {(PLAYER / 'filming.js').as_uri()!r};"
        f"import {{ THEMES }} from {(PLAYER / 'palette.js').as_uri()!r};"
        "const shares = [0, 0.1, 0.4, 0.75, 1], themes = Object.values(THEMES).map(hazy);"
        "const moves = [1, 5, 40].map((seconds) => shares.map((share) => move(share, seconds)));"
        "console.log(JSON.stringify({ moves, themes, VIGNETTE }));"
    )
    command = [newest_node(), "--input-type=module", "--eval", script]
    said = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    for seconds, page in zip((1, 5, 40), said["moves"], strict=True):
        aside, away = move(np.array([0, 0.1, 0.4, 0.75, 1]), seconds)
        np.testing.assert_allclose(aside, [place["yaw"] for place in page], atol=1e-12)
        np.testing.assert_allclose(away, [place["away"] for place in page])
    assert said["VIGNETTE"] == [list(stop) for stop in _VIGNETTE]
    for name, page in zip(THEMES, said["themes"], strict=True):
        own = Style(theme=name, film=True).colours
        assert own.reach == page["reach"] < Style(theme=name).colours.reach
        assert list(own.far) == pytest.approx(page["far"])
        assert own.far == own.horizon
        assert own.vignette == page["film"]["vignette"]


@pytest.mark.parametrize("view", ["threequarter", "side", "top"])
@pytest.mark.parametrize("size", [(1280, 720), (360, 640)])
def test_the_camera_goes_to_and_fro_about_its_view_and_holds_everybody(view: str, size: tuple[int, int]) -> None:
    """Two who run away from each other stay in the picture, beside two others who are seen from the same side."""
    still = cameras([PARTING, FAR], size=size, times=TIMES, view=view)
    moving = moving_cameras([PARTING, FAR], size=size, times=TIMES, view=view)
    for duet, own, before in zip((PARTING, FAR), moving, still, strict=True):
        aside = np.array([camera.yaw for camera in own]) - before[0].yaw
        assert aside[0] == pytest.approx(0) and aside[-1] == pytest.approx(0, abs=1e-9)
        assert aside.max() > 0.07 and aside.min() == pytest.approx(-aside.max(), rel=0.01)
        poses = sampled(duet.positions.astype(float), 30, TIMES)
        for i, camera in enumerate(own):
            pixels, depth = camera.project(poses[:, i])
            assert (depth > 0).all()
            assert (pixels >= 0).all() and (pixels <= np.array(size)).all(), i
    assert [camera.yaw for camera in moving[0]] == [camera.yaw for camera in moving[1]]
    turns = np.diff([camera.yaw for camera in moving[0]])
    assert np.abs(np.diff(turns)).max() < 0.001, "no jerk"


def test_it_goes_about_the_view_that_a_hand_has_chosen() -> None:
    (moving,) = moving_cameras([DUET], size=SMALL, times=np.zeros(1), yaw=2.0, elevation=0.5)
    assert (moving[0].yaw, moving[0].elevation) == (2.0, 0.5)
