"""Things: their shapes, their tracks, and their place in a duet and its file."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pygltflib
import pytest
import trimesh

from motion import Duet, InputError, formats
from motion.formats.npz import arrays_of
from motion.formats.usd import usd_bytes
from motion.looks import hex_of, linear
from motion.things import FURNITURE, KINDS, Mesh, Thing, shape
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npz

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


def test_tracks_that_are_none_are_refused():
    mesh = shape("cup")
    for turned in (np.zeros((3, 3)), -np.eye(3)):  # a mirrored thing made the player's payload fail
        with pytest.raises(InputError, match="do not rotate"):
            Thing("cup", mesh, np.zeros((3, 3)), np.tile(turned, (3, 1, 1)))
    with pytest.raises(InputError, match="not finite"):
        Thing("cup", mesh, np.full((3, 3), np.nan), np.tile(np.eye(3), (3, 1, 1)))
    with pytest.raises(InputError, match="places"):
        Thing("cup", mesh, np.zeros((3, 2)), np.tile(np.eye(3), (3, 1, 1)))
    with pytest.raises(InputError, match="a corner is missing"):
        Mesh(mesh.vertices, mesh.faces + 10_000, mesh.colours)
    with pytest.raises(InputError, match="as many"):
        Duet(PEOPLE.a, PEOPLE.b, things=(thrown().cut(2),))


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


def _damaged(**changes) -> bytes:
    """A file of ours with some arrays replaced; None leaves one out."""
    duet = Duet(PEOPLE.a, PEOPLE.b, things=(thrown(),))
    arrays = {"positions": duet.positions, "fps": np.float64(30), **arrays_of(duet.things)} | changes
    return npz(**{key: value for key, value in arrays.items() if value is not None})


@pytest.mark.parametrize(
    "changes",
    [
        {"thing_faces": None},
        {"thing_faces": np.full((3, 3), 2**31 - 1, dtype=np.int32)},
        {"thing_sizes": np.array([[2**62, 2**62]])},
        {"thing_places": np.zeros((1, FRAMES + 1, 3), dtype=np.float32)},
        {"thing_places": np.full((1, FRAMES, 3), np.inf, dtype=np.float32)},
        {"thing_kinds": np.array([])},
        {"thing_kinds": np.array(["cup"] * 99)},
    ],
)
def test_damaged_things_are_one_sentence(changes):
    with pytest.raises(InputError, match=r"^x\.npz"):
        formats.read(_damaged(**changes), name="x.npz")


NOW = np.linspace(0, 1, FRAMES)
ZERO, COS, SIN = 0 * NOW, np.cos(2 * NOW), np.sin(2 * NOW)
TURNS = np.stack([COS, -SIN, ZERO, SIN, COS, ZERO, ZERO, ZERO, ZERO + 1], axis=1).reshape(-1, 3, 3)
BALL = Thing("ball", shape("ball"), np.stack([2 * NOW, 1 + NOW, ZERO], axis=1), TURNS)
CHAIRS = tuple(Thing.at_rest("chair", shape("chair"), np.array([x, 0, 0.5]), x, FRAMES) for x in (1.0, 2.0))
DUET = replace(PEOPLE, things=(BALL, *CHAIRS))


def test_a_glb_holds_things_at_their_first_frame_in_their_colours(tmp_path):
    (path,) = formats.write(DUET, tmp_path / "x.glb")
    scene = trimesh.load_scene(path)
    for name, thing in zip(("ball", "chair", "chair 2"), DUET.things, strict=True):
        parts = [node for node in scene.graph.nodes_geometry if str(scene.graph[node][1]).startswith(f"{name}")]
        parts = [p for p in parts if (name == "chair 2") == ("chair 2" in str(scene.graph[p][1]))]
        found = np.concatenate(
            [trimesh.transform_points(scene.geometry[scene.graph[p][1]].vertices, scene.graph[p][0]) for p in parts]
        )
        np.testing.assert_allclose(found.min(axis=0), thing.at(0).min(axis=0), atol=1e-4)
        np.testing.assert_allclose(found.max(axis=0), thing.at(0).max(axis=0), atol=1e-4)
    gltf = pygltflib.GLTF2.load_from_bytes(path.read_bytes())
    light = {tuple(np.round(m.pbrMetallicRoughness.baseColorFactor[:3], 4)) for m in gltf.materials}
    for thing in DUET.things:
        for colour in thing.mesh.by_colour()[0].tolist():
            assert tuple(np.round(linear(hex_of(colour)), 4)) in light


def test_a_usd_stage_holds_things_beside_people():
    text = usd_bytes(DUET).decode()
    assert re.findall(r'^    def (?:Xform|Scope) "(\w+)"', text, flags=re.MULTILINE) == [
        "a",
        "b",
        "ball",
        "chair",
        "chair_2",
    ]
    assert text.count("xformOp:transform.timeSamples") == 1, "what stands still has one place"
    assert text.isascii() and text.count("{") == text.count("}")
