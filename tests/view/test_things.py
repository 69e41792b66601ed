"""Things in films, sheets and the player's payload."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from motion import SMPL22, Duet
from motion.things import KINDS, Thing, shape
from webdemo.view.camera import cameras
from webdemo.view.payload import player_payload
from webdemo.view.sheet import write_sheet
from webdemo.view.stage import Pane, Stage, Style
from webdemo.view.things import divided, thing_payload

REST = SMPL22.rest_positions() + np.array([0.0, 0.95, 0.0])
PEOPLE = Duet.from_positions(np.repeat(np.stack([REST, REST + np.array([0, 0, 3.0])])[:, None], 4, axis=1), fps=30)
BALL = Thing.at_rest("ball", shape("ball", width=0.6), np.array([1.6, 0.5, 1.5]), 0.0, 4)
WITH_BALL = replace(PEOPLE, things=(BALL,))


def red(picture: np.ndarray) -> int:
    """Pixels as red as the ball is, which no body wears."""
    levels = picture[..., :3].astype(int)
    red, green, blue = levels[..., 0], levels[..., 1], levels[..., 2]
    return int(((red > 120) & (red > 2 * green) & (abs(green - blue) < 20)).sum())


def drawn(duet: Duet, **style: object) -> np.ndarray:
    (views,) = cameras([PEOPLE], size=(320, 240), times=np.zeros(1))
    return np.asarray(next(Stage(Pane(duet), Style(**style), (320, 240)).pictures(np.zeros(1), views)))


@pytest.mark.parametrize("look", ["bodies", "skeletons", "both"])
def test_a_film_shows_things_with_every_look(look):
    assert red(drawn(WITH_BALL, look=look)) > 100 > red(drawn(PEOPLE, look=look))


def test_sheets_show_things(tmp_path):
    paths = [write_sheet(d, tmp_path / f"{i}.png", frames=1, width=400) for i, d in enumerate((PEOPLE, WITH_BALL))]
    assert red(np.asarray(Image.open(paths[0]))) < 50 < red(np.asarray(Image.open(paths[1])))


@pytest.mark.parametrize("kind", KINDS)
def test_dividing_changes_neither_area_nor_colours(kind):
    def areas(mesh):
        a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return {tuple(c): area[(mesh.colours == c).all(axis=1)].sum() for c in np.unique(mesh.colours, axis=0)}

    whole, fine = shape(kind), divided(shape(kind))
    assert areas(fine) == pytest.approx(areas(whole), rel=1e-4)
    edges = fine.vertices[fine.faces] - np.roll(fine.vertices[fine.faces], 1, axis=1)
    assert np.linalg.norm(edges, axis=2).max() < 0.141 and len(fine.faces) < 6001


def test_the_payload_holds_things_only_where_there_are_some():
    assert "things" not in player_payload(PEOPLE)["samples"][0]
    (thing,) = player_payload(WITH_BALL)["samples"][0]["things"]
    assert thing["frames"] == 1, "one that stands still is sent once"
    assert thing["kind"] == "ball" and len(thing["palette"]) == 2


def test_quaternions_do_not_jump_between_frames():
    angle = np.linspace(0, 4 * np.pi, 40)
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(40)
    turns = np.stack([c, -s, zero, s, c, zero, zero, zero, zero + 1], axis=1).reshape(-1, 3, 3)
    import base64

    packed = thing_payload(Thing("ball", shape("ball"), np.zeros((40, 3)), turns))
    sent = np.frombuffer(base64.b64decode(packed["turns"]), "<i2").reshape(-1, 4) / 32767
    assert np.abs(np.diff(sent, axis=0)).max() < 0.4


def test_a_window_is_in_view_while_somebody_is_at_it_and_only_then():
    way = np.linspace(0, 4, 90)[:, None, None] * np.array([1.0, 0.0, 0.0])
    people = Duet.from_positions(np.stack([REST - way, REST + [0, 0, 1.0] + 0 * way]), fps=30)
    window = Thing.at_rest("window", shape("window"), np.array([-4.6, 0.0, 0.0]), np.pi / 2, 90)
    corners = window.mesh.vertices @ window.rotations[0].T + window.places[0]
    times = np.array([0.0, 2.9])
    held = []
    for motion in (people, replace(people, things=(window,))):
        (views,) = cameras([motion], size=(640, 400), times=times, view="side", around=0.0)
        pixels = [view.project(corners.astype(float))[0] for view in views]
        held.append([bool(((at >= 0) & (at <= [640, 400])).all()) for at in pixels])
    assert held == [[False, False], [False, True]]
    assert thing_payload(window)["stands"] and not thing_payload(BALL)["stands"]
