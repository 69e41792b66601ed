"""One's own thing: read within limits, in metres, and hostile files are one sentence, soon."""

from __future__ import annotations

import struct
import time

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from motion import InputError
from motion.formats.glb_file import packed
from motion.formats.thing_files import MOST_DRAWN, SUFFIXES, read_thing
from motion.things import Mesh

CUBE = trimesh.creation.box((0.2, 0.4, 0.6))
SECONDS = 3.0
"""The most that a file of these sizes may keep the processor."""


def stored(mesh: trimesh.Trimesh, suffix: str) -> bytes:
    data = mesh.export(file_type=suffix[1:])
    return data if isinstance(data, bytes) else data.encode()


VALID = {suffix: stored(CUBE, suffix) for suffix in SUFFIXES} | {
    ".stl ascii": trimesh.exchange.stl.export_stl_ascii(CUBE).encode()
}


@pytest.mark.parametrize("kind", VALID)
def test_a_box_comes_as_it_is_about_its_middle(kind):
    mesh = read_thing(VALID[kind], name=f"x{kind.split()[0]}")
    up = [0.4, 0.6, 0.2] if kind.split()[0] in (".stl", ".ply") else [0.2, 0.4, 0.6]
    assert mesh.size == pytest.approx(up, abs=1e-4) and len(mesh.faces) == 12
    assert mesh.vertices.mean(axis=0) == pytest.approx([0, 0, 0], abs=1e-4)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    assert np.einsum("fi,fi->", a, np.cross(b, c)) > 0, "it is inside out"
    assert len(mesh.vertices) == 24, "sharp edges are split"


def _glb(document: dict, blob: bytes = b"") -> bytes:
    return packed({"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(blob)}], **document}, blob)


POINTS = np.zeros((3, 3), "<f4").tobytes()
_VIEW = {
    "bufferViews": [{"buffer": 0, "byteLength": len(POINTS)}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
}
HOSTILE = {
    "counts.ply": b"ply\nformat ascii 1.0\nelement vertex 99999999999\nelement face 1\nend_header\n",
    "lists.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n"
    + bytes(36)
    + b"\xff\xff\xff\xff",
    "no-header.ply": b"ply\n" + b"comment x\n" * 100_000,
    "counts.stl": bytes(80) + struct.pack("<I", 2**32 - 1),
    "counts-ascii.stl": b"solid x\n" + b"facet normal 0 0 0\nendfacet\n" * 450_000,
    "many.obj": b"v 0 0 0\n" * 3 + b"\nf 1 2 3" * 500_000,
    "corners.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf" + b" 1 2 3" * 1_100_000,
    "materials.obj": b"v 0 0 0\nv 1 0 0\n" + b"".join(b"usemtl m%d\nf 1 2 2\n" % i for i in range(60_000)),
    "far.obj": b"\nv 1e300 nan inf\nv 0 0 0\nv 1 0 0\nf 1 2 3\n",
    "missing.obj": b"\nv 0 0 0\nv 1 0 0\nf 1 2 99999999\n",
    "files.obj": b"mtllib /etc/passwd\nusemtl x\n\nv 0 0 0\nv 0 1 0\nv 1 0 0\n\nf 1 2 9\n",
    "nothing.obj": b"\nv 0 0 0\n",
    "copies.glb": _glb(
        {
            **_VIEW,
            "nodes": [{"mesh": 0}] * 4999 * 1,
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 2**30, "type": "VEC3"}],
        },
        POINTS,
    ),
    "circle.glb": _glb({**_VIEW, "nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]}, POINTS),
    "outside.glb": _glb(
        {**_VIEW, "nodes": [{"mesh": 0}], "bufferViews": [{"buffer": 0, "byteLength": 2**31 - 1}]}, POINTS
    ),
    "scale.glb": _glb({**_VIEW, "nodes": [{"mesh": 0, "scale": [1e300, 1, 1]}]}, POINTS),
    "flat.glb": _glb({**_VIEW, "nodes": [{"mesh": 0}]}, POINTS),
    "colour.glb": _glb(
        {
            **_VIEW,
            "nodes": [{"mesh": 0}],
            "materials": [{"pbrMetallicRoughness": {"baseColorFactor": ["x", 1, 1, 1]}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        },
        POINTS,
    ),
    "empty.glb": b"",
    "short.stl": b"solid",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_one_sentence_soon(name):
    began = time.process_time()
    with pytest.raises(InputError) as caught:
        read_thing(HOSTILE[name], name=name)
    assert time.process_time() - began < SECONDS
    assert str(caught.value).endswith(".") and "Traceback" not in str(caught.value)


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    kind=st.sampled_from(sorted(VALID)),
    edits=st.lists(st.tuples(st.integers(0, 10**6), st.binary(min_size=1, max_size=8)), min_size=1, max_size=6),
    end=st.integers(1, 10**6),
)
@example(kind=".obj", edits=[(65, b"\x0b")], end=335)  # trimesh gives vertices of one number
def test_damaged_files_give_a_thing_or_one_sentence_soon(kind, edits, end):
    data = bytearray(VALID[kind])
    for at, new in edits:
        at %= len(data)
        data[at : at + len(new)] = new
    data = data[: max(end % (2 * len(data)), 1)]
    began = time.process_time()
    try:
        found = read_thing(bytes(data), name=f"x{kind.split()[0]}")
    except InputError as error:
        assert str(error).endswith(".")
    else:
        assert isinstance(found, Mesh) and len(found.faces) <= MOST_DRAWN
    assert time.process_time() - began < SECONDS


def test_the_largest_file_is_read_in_a_few_seconds():
    side = 310
    x, z = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    points = np.stack([x, 0.1 * np.sin(9 * x) * np.cos(7 * z), z], axis=-1).reshape(-1, 3)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1) + 1).ravel()
    lines = [b"v %.4f %.4f %.4f" % tuple(p) for p in points]
    lines += [b"f %d %d %d" % (c, c + side, c + 1) for c in corner]
    lines += [b"f %d %d %d" % (c + 1, c + side, c + side + 1) for c in corner]
    began = time.process_time()
    mesh = read_thing(b"\n" + b"\n".join(lines), name="x.obj")
    assert time.process_time() - began < 12.0
    assert 1000 < len(mesh.faces) <= MOST_DRAWN and mesh.size[0] == pytest.approx(1.0, abs=0.05)
