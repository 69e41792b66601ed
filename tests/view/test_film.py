"""Films and figures of a motion, opened with another program's reader."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from motion import Duet, InputError
from motion.skeleton import SMPL22
from motion.transforms import turn
from tests.motion.bodies import marching
from tests.static.node import newest_node
from webdemo.view import film
from webdemo.view.camera import VIEWS, Camera, cameras, sampled
from webdemo.view.sheet import write_sheet
from webdemo.view.stage import Pane, Stage, Style
from webdemo.view.theme import THEMES

A = marching(12)[0]
DUET = Duet.from_positions(np.stack([A, turn(A, np.pi) + np.array([0, 0, 1.4])]), fps=30)
SLOW = Duet.from_positions(DUET.positions, fps=5)
SMALL = (160, 120)
PALETTE = Path(__file__).resolve().parents[2] / "static" / "player" / "palette.js"


def _frames(path: Path) -> list[np.ndarray]:
    with av.open(str(path)) as opened:
        return [frame.to_ndarray(format="rgb24") for frame in opened.decode(video=0)]


def _look(picture: np.ndarray, red_over_blue: bool) -> float:
    """The share of pixels that are plainly orange, more so than skin, or plainly blue."""
    difference = picture[..., 0].astype(int) - picture[..., 2]
    return float((difference > 130 if red_over_blue else difference < -70).mean())


@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_a_film_has_every_frame_at_its_rate_and_size(tmp_path, suffix):
    path = film.write_film([Pane(DUET)], tmp_path / f"x{suffix}", size=SMALL)
    with av.open(str(path)) as opened:
        (stream,) = opened.streams.video
        assert (stream.width, stream.height, stream.average_rate) == (*SMALL, 30)
    pictures = _frames(path)
    assert len(pictures) == 12
    assert _look(pictures[0], True) > 0.005 and _look(pictures[0], False) > 0.005
    assert np.abs(pictures[0].astype(int) - pictures[8]).max() > 60  # they march


def test_a_gif_moves_and_goes_round(tmp_path):
    path = film.write_film([Pane(DUET)], tmp_path / "x.gif", size=SMALL)
    with Image.open(path) as picture:
        assert picture.size == SMALL and picture.n_frames == 10  # 0.4 s at 25 frames a second
        assert picture.info["duration"] == 40 and picture.info["loop"] == 0
    slower = film.write_film([Pane(DUET)], tmp_path / "slower.gif", size=SMALL, fps=15)
    with Image.open(slower) as picture:
        assert (picture.info["duration"], picture.n_frames) == (70, 6)  # hundredths of a second are whole


def test_panes_stand_side_by_side_under_their_captions(tmp_path):
    near = Duet(DUET.a, DUET.b.with_positions(DUET.b.positions + np.array([0, 0, 0.5])))
    one, two = (
        film.write_film(panes, tmp_path / f"{len(panes)}.gif", size=(320, 120))
        for panes in ([Pane(DUET)], [Pane(DUET, "left"), Pane(near, "right")])
    )
    with Image.open(one) as alone, Image.open(two) as both:
        assert alone.size == both.size == (320, 120)
        halves = np.asarray(both.convert("RGB")).reshape(120, 2, 160, 3).swapaxes(0, 1)
    for half in halves:
        assert _look(half, True) > 0.005 and _look(half, False) > 0.005


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"path": "x.avi"}, "Films end in"),
        ({"fps": 0.0}, "frames a second"),
        ({"size": (10, 10)}, "64 to 3840"),
        ({"size": (101, 100)}, "are even"),
        ({"view": "moon"}, "no view"),
        ({"size": (3840, 3840), "panes": [Pane(SLOW)]}, "too large"),
        ({"panes": []}, "no motion"),
    ],
)
def test_what_cannot_be_filmed_is_one_sentence(tmp_path, change, sentence):
    asked = {"panes": [Pane(DUET)], "path": "x.gif", "size": SMALL} | change
    panes, path = asked.pop("panes"), tmp_path / str(asked.pop("path"))
    with pytest.raises(InputError, match=sentence):
        film.write_film(panes, path, **asked)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("look", ["bodies", "skeletons", "both"])
@pytest.mark.parametrize("theme", THEMES)
def test_people_are_seen_in_every_look_and_theme(look, theme):
    stage = Stage(Pane(DUET), Style(look=look, theme=theme), SMALL)
    times = np.zeros(1)
    (picture,) = stage.pictures(times, cameras([DUET], size=SMALL, times=times)[0])
    assert picture.size == SMALL
    assert _look(np.asarray(picture), True) > 0.003 and _look(np.asarray(picture), False) > 0.003


FAR = Duet(DUET.a, DUET.b.with_positions(DUET.b.positions + np.array([1.0, 0, 1.5])))


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("size", [(1280, 720), (360, 640)])
def test_every_view_holds_everybody_in_each_pane(view, size):
    """Two who run away from each other for three seconds stay in the picture, at each moment and from every side."""
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    way = np.array([0.4 + 3.0 * max(i / 30 - 1, 0) for i in range(120)])[:, None, None] * np.array([0.3, 0, 1])
    running = Duet.from_positions(np.stack([rest - way, rest + way]).astype(np.float32), fps=30)
    times = np.arange(48) / 12
    for follow in (True, False):
        panes = cameras([running, FAR], size=size, times=times, view=view, follow=follow)
        for duet, own in zip((running, FAR), panes, strict=True):
            poses = sampled(duet.positions.astype(float), 30, times)
            for i, camera in enumerate(own):
                pixels, depth = camera.project(poses[:, i])
                assert (depth > 0).all()
                assert (pixels >= 0).all() and (pixels <= np.array(size)).all(), (follow, i)


@pytest.mark.parametrize("follow", [True, False])
def test_panes_are_seen_from_one_side_each_about_its_own_people(follow):
    """A pair twenty metres away is as large and as much in the middle as one at the origin."""
    away = np.array([20.0, 0, -7.0])
    moved = Duet(*(person.with_positions(person.positions + away) for person in DUET.people))
    times = np.arange(12) / 30
    here, there, wide = cameras([DUET, moved, FAR], size=SMALL, times=times, follow=follow)
    for one, other, third in zip(here, there, wide, strict=True):
        np.testing.assert_allclose(other.eye - one.eye, away, atol=1e-6)
        assert (one.yaw, one.elevation, one.distance) == (third.yaw, third.elevation, third.distance)
    (alone,) = cameras([DUET], size=SMALL, times=times, follow=follow)
    assert alone[0].distance < here[0].distance, "the widest pair decides how far all are"


def test_the_camera_sees_right_on_the_right_and_up_above():
    camera = Camera(np.array([0.0, 1.0, 0.0]), 0.0, 0.0, 5.0, (200, 100))
    pixels, depth = camera.project(np.array([[0.0, 1, 0], [1, 1, 0], [0, 2, 0], [0, 1, 1]]))
    np.testing.assert_allclose(pixels[0], (100, 50))
    assert pixels[1, 0] > 100 and pixels[2, 1] < 50
    np.testing.assert_allclose(depth, [5, 5, 5, 4])


def test_colours_are_those_of_the_player():
    """The page's modules turn the one file into the numbers that films are drawn with."""
    script = f"import {{ THEMES }} from {PALETTE.as_uri()!r}; console.log(JSON.stringify(THEMES));"
    command = [newest_node(), "--input-type=module", "--eval", script]
    said = subprocess.run(command, capture_output=True, text=True, check=True, cwd=PALETTE.parent).stdout
    for name, page in json.loads(said).items():
        own = THEMES[name]
        for place in ("sky", "horizon", "floor", "far", "grid", "ghost", "ink", "shade"):
            assert getattr(own, place) == pytest.approx(page[place]), (name, place)
        for lamp in ("key", "sky", "ground", "rim", "shine"):
            assert getattr(own.lamps, lamp) == pytest.approx(page["lamps"][lamp]), (name, lamp)
        for ours, theirs in ((own.bodies, page["bodies"]), (own.given_bodies, page["givenBodies"])):
            for one, other in zip(ours, theirs, strict=True):
                assert {zone: pytest.approx(colour) for zone, colour in one.items()} == other
        for ours, theirs in ((own.people, page["people"]), (own.given, page["given"])):
            for one, other in zip(ours, theirs, strict=True):
                assert list(one) == [pytest.approx(other[side]) for side in ("middle", "left", "right")]


@pytest.mark.parametrize("suffix", [".png", ".pdf"])
@pytest.mark.parametrize("look", ["bodies", "skeletons"])
def test_sheets_of_chosen_width_open(tmp_path, suffix, look):
    path = write_sheet(
        DUET, tmp_path / f"x{suffix}", frames=[0, 6], width=600, title="March", style=Style(look=look, names=False)
    )
    data = path.read_bytes()
    if suffix == ".png":
        with Image.open(path) as picture:
            assert picture.width == 600
            pixels = np.asarray(picture.convert("RGB"))
        assert _look(pixels, True) > 0.002 and _look(pixels, False) > 0.002
    else:
        assert data.startswith(b"%PDF") and b"[ 0 0 144.0" in data  # 600 pixels at 300 an inch, in points
