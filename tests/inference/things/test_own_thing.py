"""One's own thing from a file, in the hands or under a person who sits."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from motion import Duet, InputError
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result
from webdemo.inference.things import with_own_thing

from .furnishing import FPS, palms, sitting, standing


def owned(people: np.ndarray, prompt: str, tmp_path) -> Result:
    trimesh.creation.box((0.1, 0.2, 0.1)).export(tmp_path / "mine.stl")
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    result = Result(duets=(duet,), manifest={})
    return with_own_thing(result, GenerateRequest(prompt=prompt, seconds=4.0), tmp_path / "mine.stl")


def test_ones_own_thing_is_held_where_the_words_name_one(tmp_path):
    made_ = owned(standing(), "A holds a cup.", tmp_path)
    (thing,) = made_.duets[0].things
    assert thing.kind == "own" and thing.name == "cup"
    assert np.linalg.norm(thing.places - palms(standing())[0], axis=2).max(axis=1).min() < 0.07
    assert made_.manifest["own_thing"]["file"] == "mine.stl"


def test_ones_own_seat_stands_under_who_sits(tmp_path):
    (thing,) = owned(sitting(), "A sits down.", tmp_path).duets[0].things
    assert thing.kind == "own" and thing.at(0)[:, 1].min() == pytest.approx(0.0, abs=1e-3)
    assert np.abs(thing.places[0, [0, 2]]).max() < 0.2


def test_ones_own_thing_stands_beside_where_the_words_name_none(tmp_path):
    (thing,) = owned(standing(), "They wave.", tmp_path).duets[0].things
    assert thing.at(0)[:, 1].min() == pytest.approx(0.0, abs=1e-3)
    assert np.linalg.norm(thing.places[0] - standing()[:, 0, 0], axis=1).min() > 0.4


def test_a_file_that_is_no_thing_is_one_sentence(tmp_path):
    (tmp_path / "mine.stl").write_bytes(b"nonsense")
    result = Result(duets=(Duet.from_positions(standing(), fps=FPS),), manifest={})
    with pytest.raises(InputError, match=r"mine\.stl"):
        with_own_thing(result, GenerateRequest(prompt="They wave.", seconds=4.0), tmp_path / "mine.stl")
