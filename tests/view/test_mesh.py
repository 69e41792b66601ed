"""Meshes of one moment, read again by trimesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from motion import Clip, Duet, InputError
from motion.body import load_body, skin
from tests.motion.bodies import marching
from webdemo.view.mesh import mesh, write_mesh

POSITIONS, _ = marching(12)
DUET = Duet.from_positions(np.stack([POSITIONS, POSITIONS + np.array([0, 0, 1.5])]), fps=30)


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_the_file_holds_both_bodies_at_the_frame(suffix: str, tmp_path: Path) -> None:
    path = write_mesh(DUET, tmp_path / f"x{suffix}", frame=7)
    found = trimesh.load(path, process=False, maintain_order=True)
    bodies = [load_body("man"), load_body("woman")]
    wanted = [skin(body, person.positions[7][None])[0] for body, person in zip(bodies, DUET.people, strict=True)]
    assert len(found.faces) == sum(len(body.faces) for body in bodies)
    np.testing.assert_allclose(found.bounds[0], np.concatenate(wanted).min(axis=0), atol=1e-4)
    np.testing.assert_allclose(found.bounds[1], np.concatenate(wanted).max(axis=0), atol=1e-4)
    other = write_mesh(DUET, tmp_path / f"y{suffix}", frame=0)
    assert other.read_bytes() != path.read_bytes()


def test_people_wear_their_colours() -> None:
    a, b = mesh(DUET, 0)
    blue, orange = (np.asarray(one.visual.vertex_colors)[:, :3].astype(int) for one in (a, b))
    assert len(np.unique(blue, axis=0)) > 3
    assert (blue[:, 2] > blue[:, 0]).mean() > (orange[:, 2] > orange[:, 0]).mean() + 0.3


def test_one_person_and_the_last_frame() -> None:
    assert len(mesh(DUET.a, -1)) == 1


def test_what_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="frames 0 to 11"):
        mesh(DUET, 12)
    with pytest.raises(InputError, match=r"\.ply or \.obj"):
        write_mesh(DUET, tmp_path / "x.stl", frame=0)
    from motion.skeleton import SBU15

    with pytest.raises(InputError, match="22 joints"):
        mesh(Clip(np.zeros((2, 15, 3)), 15.0, SBU15), 0)
    assert not list(tmp_path.iterdir())
