"""Particles that no frame of a verb has make another verb of it, which nothing is read from."""

from __future__ import annotations

import pytest

from acts import read


@pytest.mark.parametrize("words", ["A bows out.", "A plays up.", "He calls off.", "She sits out."])
def test_a_particle_that_no_frame_has_is_another_verb(words: str) -> None:
    assert read(words).acts == ()


@pytest.mark.parametrize("words", ["A bows.", "She sits down.", "A picks up a book."])
def test_a_particle_that_a_frame_has_is_a_part_of_it(words: str) -> None:
    assert len(read(words).acts) == 1


def test_round_behind_a_verb_is_a_direction_and_no_noun() -> None:
    found = [act.act for act in read("They hold both hands and spin round.").acts]
    assert found == ["hold-hands", "ring"]
