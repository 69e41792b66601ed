"""Who wears which body, and where that is kept."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from motion import InputError
from motion.clip import Duet
from motion.formats import read, write
from motion.looks import LOOKS, UNSAID, looks_of

STILL = Duet.from_positions(np.random.default_rng(0).normal(size=(2, 4, 22, 3)), fps=30)


def test_people_look_as_the_words_say() -> None:
    assert looks_of([("", ""), ("", "")]) == UNSAID
    assert looks_of([("f", ""), ("m", "")]) == ("woman", "man")
    assert looks_of([("m", ""), ("m", "old")]) == ("man", "old-man")
    assert looks_of([("f", ""), ("f", "child")]) == ("woman", "woman")


def test_who_is_not_named_can_be_told_from_the_other() -> None:
    assert looks_of([("f", ""), ("", "")]) == ("woman", "man")
    assert looks_of([("", "old"), ("m", "")]) == ("old-woman", "man")


def test_any_two_people_have_looks_that_ship() -> None:
    each = list(product(("", "m", "f"), ("", "old", "child")))
    assert {look for pair in product(each, each) for look in looks_of(pair)} == set(LOOKS)


def test_a_file_keeps_the_looks(tmp_path) -> None:
    path = tmp_path / "two.npz"
    write(replace(STILL, looks=("old-woman", "woman")), path)
    assert read(path).looks == ("old-woman", "woman")
    write(STILL, path)
    with np.load(path) as arrays:
        assert "looks" not in arrays
    assert read(path).looks == UNSAID


@pytest.mark.parametrize("looks", [("man",), ("man", "king"), ("../a", "man"), ("man", "man", "man")])
def test_unknown_looks_are_refused(looks, tmp_path) -> None:
    with pytest.raises(InputError, match="looks"):
        replace(STILL, looks=looks)
    path = tmp_path / "two.npz"
    write(STILL, path)
    with np.load(path) as stored:
        arrays = dict(stored)
    np.savez(path, **arrays, looks=np.array(looks))
    with pytest.raises(InputError, match=r"two\.npz: The looks"):
        read(path)


def test_looks_stay_when_a_part_is_cut_out() -> None:
    assert replace(STILL, looks=("woman", "woman")).cut(1, 3).looks == ("woman", "woman")
