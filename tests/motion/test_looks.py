"""Who wears which body, and where that is kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acts import read as read_words
from motion import InputError
from motion.clip import Duet
from motion.formats import read, write
from motion.looks import UNSAID, looks_of

STILL = Duet.from_positions(np.random.default_rng(0).normal(size=(2, 4, 22, 3)), fps=30)


def test_people_look_as_the_words_say() -> None:
    assert looks_of([("", ""), ("", "")]) == UNSAID
    assert looks_of([("f", ""), ("m", "")]) == ("woman", "man")
    assert looks_of([("m", ""), ("m", "old")]) == ("man", "old-man")
    assert looks_of([("f", ""), ("f", "child")]) == ("woman", "girl")
    assert looks_of([("", "child"), ("m", "old")]) == ("girl", "old-man")


@pytest.mark.parametrize(
    ("sentence", "looks"),
    [
        ("A mother and her son hold hands and walk.", ("woman", "boy")),
        ("A man and a girl give each other a high five.", ("man", "girl")),
        ("The grandmother hugs her grandson.", ("old-woman", "boy")),
        ("A man carries a toddler.", ("man", "girl")),
        ("Two boys fight.", ("boy", "boy")),
        ("The child's mother waves.", ("woman", "man")),
        ("Two people dance like children.", UNSAID),
    ],
)
def test_words_say_who_is_a_child(sentence: str, looks: tuple[str, str]) -> None:
    assert looks_of([(person.sex, person.age) for person in read_words(sentence).people]) == looks


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
