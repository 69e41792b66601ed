"""Nouns and the kinds of things that they name."""

from __future__ import annotations

import pytest

from acts import Act, read
from acts.lexicon import is_listed, kind_of, lexicon, thing_of
from acts.things.furnishing import drawn_otherwise
from motion.things import KINDS


@pytest.mark.parametrize(
    ("noun", "kind"),
    [
        ("mugs", "cup"),
        ("paper bag", "bag"),
        ("knives", "sword"),
        ("Sofa", "bench"),
        ("piano", ""),
        ("", ""),
        ("the boss's desk", "table"),
    ],
)
def test_nouns_name_kinds(noun, kind):
    assert kind_of(noun) == kind


def test_every_kind_in_the_table_has_a_shape_and_every_shape_a_noun():
    from acts.lexicon import _tables

    assert set(_tables()[0].values()) == set(KINDS)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("They open a carpet.", "Not drawn: the carpet."),
        ("They play tug of war, then she holds a coat.", "Not drawn: the rope, the coat."),
        ("He tells a story and opens the window.", ""),
    ],
)
def test_what_is_drawn_as_something_else_or_not_at_all_is_told(words: str, told: str) -> None:
    rows = [{"name": name, "kind": kind_of(name)} for name in ("tray", "mug")]
    first, *rest = drawn_otherwise(rows, [(read(words), 0, None, None)])
    assert first == "Drawn as something like it: the tray as a book." and "".join(rest) == told


def test_a_things_noun_comes_from_the_act_and_else_from_its_words():
    act = Act(id="1", act="hold-thing", agents=("a",), thing="cup")
    assert thing_of(act, "he lifts a sword") == ("cup", "cup")
    bare = act.model_copy(update={"thing": None})
    assert thing_of(bare, "he lifts a sword") == ("sword", "sword")
    assert thing_of(bare, "he waves") == ("", "")


def test_floors_are_known():
    assert is_listed("sits on the grass", "floor") and not is_listed("sits on a chair", "floor")


def test_entries_say_what_they_do_with_their_thing():
    found = {name: entry.thing for name, entry in lexicon().entries.items()}
    assert found["hand-over"] == "gives" and found["sit-down"] == "sits" and found["wave"] == ""
