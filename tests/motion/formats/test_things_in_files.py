"""Things in .glb and .usda: where they are, in which colours; OpenUSD reads them where ``usd-core`` is installed."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pygltflib
import pytest
import trimesh

from motion import Duet, formats
from motion.colours import hex_of, linear
from motion.formats.glb import glb_bytes
from motion.formats.usd import usd_text
from motion.things import KINDS, Thing, shape
from tests.motion.bodies import marching

FRAMES = 10
NOW = np.linspace(0, 1, FRAMES)
ZERO, COS, SIN = 0 * NOW, np.cos(2 * NOW), np.sin(2 * NOW)
TURNS = np.stack([COS, -SIN, ZERO, SIN, COS, ZERO, ZERO, ZERO, ZERO + 1], axis=1).reshape(-1, 3, 3)
BALL = Thing("ball", shape("ball"), np.stack([2 * NOW, 1 + NOW, ZERO], axis=1), TURNS)
CHAIRS = tuple(Thing.at_rest("chair", shape("chair"), np.array([x, 0, 0.5]), x, FRAMES) for x in (1.0, 2.0))
PEOPLE = Duet.from_positions(np.stack([marching(FRAMES)[0], marching(FRAMES, seed=1)[0] + 1.0]), fps=30)
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


def test_only_what_moves_is_animated_in_a_glb():
    gltf = pygltflib.GLTF2.load_from_bytes(glb_bytes(DUET))
    names = [gltf.nodes[channel.target.node].name for channel in gltf.animations[0].channels]
    assert names.count("ball") == 2 and "chair" not in names


def test_people_are_read_back_from_a_glb_with_things(tmp_path):
    paths = [formats.write(duet, tmp_path / name)[0] for duet, name in ((PEOPLE, "a.glb"), (DUET, "b.glb"))]
    plain, crowded = (formats.read(path) for path in paths)
    assert isinstance(plain, Duet) and isinstance(crowded, Duet)
    np.testing.assert_allclose(crowded.positions, plain.positions, atol=1e-5)


def test_a_usd_stage_holds_things_beside_people():
    text = usd_text(DUET)
    assert re.findall(r'^    def (?:Xform|Scope) "(\w+)"', text, flags=re.MULTILINE) == [
        "a",
        "b",
        "ball",
        "chair",
        "chair_2",
    ]
    assert text.count("xformOp:transform.timeSamples") == 1, "what stands still has one place"
    assert text.isascii() and text.count("{") == text.count("}")


def test_a_thing_called_as_a_person_has_a_name_of_its_own():
    text = usd_text(replace(DUET, things=(replace(BALL, name="A"),)))
    assert 'def Xform "A_"' in text


def test_openusd_puts_things_where_they_are(tmp_path):
    usd = pytest.importorskip("pxr.Usd", reason="usd-core is not installed")
    geom = pytest.importorskip("pxr.UsdGeom")
    (path,) = formats.write(DUET, tmp_path / "x.usda")
    stage = usd.Stage.Open(str(path))
    mesh = geom.Mesh(stage.GetPrimAtPath("/duet/ball/ball_mesh"))
    place = np.array(geom.XformCache(7).GetLocalToWorldTransform(mesh.GetPrim()))
    points = np.c_[np.array(mesh.GetPointsAttr().Get()), np.ones(len(BALL.mesh.vertices))] @ place
    np.testing.assert_allclose(points[:, :3], BALL.at(7), atol=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_every_normal_has_unit_length(kind):
    from motion.formats.glb_buffer import unit_normals

    np.testing.assert_allclose(
        np.linalg.norm(unit_normals(shape(kind).vertices, shape(kind).faces), axis=1), 1.0, atol=1e-6
    )
