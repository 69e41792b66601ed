"""The things and the looks of a result, and one's own thing from a file."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from acts import read
from motion import Duet, InputError
from motion.looks import UNSAID
from motion.skeleton import SBU15
from tests.acts.things.furnishing import FPS, palms, sitting, standing
from webdemo.inference.finish.looks import furnished, with_own_thing
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result


def owned(people: np.ndarray, prompt: str, tmp_path) -> Result:
    trimesh.creation.box((0.1, 0.2, 0.1)).export(tmp_path / "mine.stl")
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    result = Result(duets=(duet,), manifest={})
    return with_own_thing(result, GenerateRequest(prompt=prompt, seconds=4.0), tmp_path / "mine.stl")


def test_ones_own_thing_is_held_where_the_words_name_one(tmp_path):
    result = owned(standing(), "A holds a cup.", tmp_path)
    (thing,) = result.duets[0].things
    assert thing.kind == "own" and thing.name == "cup"
    assert np.linalg.norm(thing.places - palms(standing())[0], axis=2).max(axis=1).min() < 0.07
    assert result.manifest["own_thing"]["file"] == "mine.stl"


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


def test_other_skeletons_stay_as_they_are():
    duet = Duet.from_positions(np.random.default_rng(0).normal(size=(2, 9, 15, 3)), fps=30, skeleton=SBU15)
    same = furnished(Result(duets=(duet,), manifest={}), [(read("A holds a cup."), 0, None, None)])
    assert same.duets[0] is duet and same.manifest == {}


def test_people_look_as_their_plans_say():
    """A later plan adds what an earlier one leaves open and changes nothing that it says."""
    result = Result(duets=(Duet.from_positions(standing().astype(np.float32), fps=FPS),), manifest={})
    first, second = read("She bows."), read("An old man waves at a boy.")
    both = furnished(result, [(first, 0, 60, 0), (second, 60, None, 1)]).duets[0]
    assert both.looks == ("old-woman", "boy")
    assert furnished(result, []).duets[0].looks == UNSAID
