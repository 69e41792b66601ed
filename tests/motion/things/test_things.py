"""Things: their shapes, their tracks, and their place in a duet and its file."""

from __future__ import annotations

import io

import numpy as np
import pytest

from motion import Duet, InputError, formats
from motion.formats.npz_things import KEYS
from motion.things import FURNITURE, HIGH, KINDS, WIDE, Mesh, Thing, shape
from tests.motion.bodies import marching

FRAMES = 12
PEOPLE = Duet.from_positions(np.stack([marching(FRAMES)[0], marching(FRAMES, seed=1)[0] + 1.0]), fps=30)


def thrown(kind: str = "ball") -> Thing:
    """A thing that flies and turns."""
    now = np.linspace(0, 1, FRAMES)
    places = np.stack([2 * now, 1 + now - 2 * now**2, 0 * now], axis=1)
    turned = np.tile(np.eye(3), (FRAMES, 1, 1))
    turned[:, 0, 0] = turned[:, 1, 1] = np.cos(now)
    turned[:, 0, 1], turned[:, 1, 0] = -np.sin(now), np.sin(now)
    return Thing(kind, shape(kind), places, turned)


@pytest.mark.parametrize("kind", KINDS)
def test_every_shape_is_a_closed_enough_surface_of_few_triangles(kind):
    mesh = shape(kind)
    assert len(mesh.faces) <= 900
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert (area > 0).mean() > 0.95
    volume = np.einsum("fi,fi->f", a, np.cross(b, c)).sum() / 6
    assert volume > 0, "its triangles face inwards"
    if kind in FURNITURE:
        assert abs(mesh.vertices[:, 1].min()) < 1e-6, "it does not stand on the floor"


@pytest.mark.parametrize(("kind", "height"), [("chair", 0.4), ("bench", 0.5), ("table", 0.9), ("bed", 0.3)])
def test_a_seat_or_a_top_is_as_high_as_asked(kind, height):
    mesh = shape(kind, height=height)
    level = mesh.vertices[np.abs(mesh.vertices[:, 1] - height) < 0.011]
    assert np.ptp(level[:, 0]) > 0.3 and np.ptp(level[:, 2]) > 0.3


def test_widths_and_heights_are_what_is_said_of_them():
    for kind in WIDE:
        assert shape(kind, width=0.9).size[0] == pytest.approx(0.9, abs=0.2)
    for kind in set(KINDS) - set(HIGH):
        assert shape(kind, height=0.9).size[1] == shape(kind).size[1]


def test_unknown_kinds_and_sizes_are_refused():
    with pytest.raises(InputError, match="choose one of chair, bench"):
        shape("spaceship")
    with pytest.raises(InputError, match="cannot be built"):
        shape("chair", height=30)


def test_a_thing_between_two_frames_is_between_its_places():
    ball = thrown()
    middle = ball.at(3.5).mean(axis=0)
    np.testing.assert_allclose(middle, (ball.at(3).mean(axis=0) + ball.at(4).mean(axis=0)) / 2, atol=1e-3)
    size = np.ptp(ball.at(3.5), axis=0)
    assert size == pytest.approx(np.ptp(ball.at(3), axis=0), abs=0.01), "it shrinks between frames"


def test_tracks_that_are_none_are_refused():
    mesh = shape("cup")
    with pytest.raises(InputError, match="do not rotate"):
        Thing("cup", mesh, np.zeros((3, 3)), np.zeros((3, 3, 3)))
    with pytest.raises(InputError, match="not finite"):
        Thing("cup", mesh, np.full((3, 3), np.nan), np.tile(np.eye(3), (3, 1, 1)))
    with pytest.raises(InputError, match="places"):
        Thing("cup", mesh, np.zeros((3, 2)), np.tile(np.eye(3), (3, 1, 1)))
    with pytest.raises(InputError, match="a corner is missing"):
        Mesh(mesh.vertices, mesh.faces + 10_000, mesh.colours)
    with pytest.raises(InputError, match="as many"):
        Duet(PEOPLE.a, PEOPLE.b, things=(thrown().cut(2),))


def test_cutting_cuts_things_and_other_positions_drop_them():
    duet = Duet(PEOPLE.a, PEOPLE.b, things=(thrown(),))
    assert duet.cut(3, 9).things[0].num_frames == 6
    np.testing.assert_array_equal(duet.cut(3, 9).things[0].places, duet.things[0].places[3:9])
    assert duet.with_positions(duet.positions).things == ()


def test_things_come_back_from_our_file(tmp_path):
    chair = Thing.at_rest("chair", shape("chair", height=0.4), np.array([1.0, 0, 2]), 0.5, FRAMES, "stool")
    duet = Duet(PEOPLE.a, PEOPLE.b, things=(thrown(), chair))
    formats.write(duet, tmp_path / "x.npz")
    back = formats.read(tmp_path / "x.npz")
    assert isinstance(back, Duet) and [(t.kind, t.name) for t in back.things] == [("ball", "ball"), ("chair", "stool")]
    for one, other in zip(duet.things, back.things, strict=True):
        for part in ("places", "rotations"):
            np.testing.assert_array_equal(getattr(one, part), getattr(other, part))
        for part in ("vertices", "faces", "colours"):
            np.testing.assert_array_equal(getattr(one.mesh, part), getattr(other.mesh, part))
    assert not chair.moves and thrown().moves


def test_a_file_without_things_is_as_before(tmp_path):
    formats.write(PEOPLE, tmp_path / "x.npz")
    with np.load(tmp_path / "x.npz") as stored:
        assert not set(stored) & set(KEYS)
    back = formats.read(tmp_path / "x.npz")
    assert isinstance(back, Duet) and back.things == ()


def _damaged(**changes) -> bytes:
    """A file of ours with some arrays replaced; None leaves one out."""
    buffer = io.BytesIO()
    duet = Duet(PEOPLE.a, PEOPLE.b, things=(thrown(),))
    from motion.formats.npz_things import arrays_of

    arrays = {"positions": duet.positions, "fps": np.float64(30), **arrays_of(duet.things)} | changes
    np.savez_compressed(buffer, **{key: value for key, value in arrays.items() if value is not None})
    return buffer.getvalue()


@pytest.mark.parametrize(
    "changes",
    [
        {"thing_faces": None},
        {"thing_faces": np.full((3, 3), 2**31 - 1, dtype=np.int32)},
        {"thing_sizes": np.array([[2**62, 2**62]])},
        {"thing_sizes": np.array([[-5, -5]])},
        {"thing_sizes": np.zeros((0, 2), dtype=np.int64)},
        {"thing_places": np.zeros((1, FRAMES + 1, 3), dtype=np.float32)},
        {"thing_places": np.full((1, FRAMES, 3), np.inf, dtype=np.float32)},
        {"thing_rotations": np.zeros((1, FRAMES, 3, 3), dtype=np.float32)},
        {"thing_rotations": np.zeros((1, 3), dtype=np.float32)},
        {"thing_vertices": np.zeros((3, 3), dtype=np.int64)},
        {"thing_colours": np.zeros((3, 3))},
        {"thing_kinds": np.array([])},
        {"thing_kinds": np.array(["cup"] * 99)},
        {"thing_names": np.array([["a"]])},
    ],
)
def test_damaged_things_are_one_sentence(changes):
    with pytest.raises(InputError, match=r"^x\.npz"):
        formats.read(_damaged(**changes), name="x.npz")
