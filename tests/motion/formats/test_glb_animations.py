"""A .glb of several animations: the first or the chosen one is read, and a sentence says which."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import Clip, InputError
from motion.formats import animation_note, read, read_everyone
from motion.formats.choices import ImportChoices
from motion.formats.glb_animations import Animations
from motion.formats.glb_motion import animations_in, read_glb
from motion.formats.importing import Imported, import_motion
from motion.formats.on_rig import on_rig
from tests.motion.bodies import marching

from .characters import glb_motion, glb_takes, packed, unpacked
from .rigs import RIGS, bvh_text

POSITIONS, ROTATIONS = marching(30)
ROOT = POSITIONS[:, 0]
FILE = glb_takes(ROTATIONS, ROOT, ["Walk", "glide", "3", "2"])
NOTE = "Of the 4 animations in x.glb, {} was taken; the others are {}."


def limbs(found: Imported) -> float:
    """Metres by which the wrists move against the pelvis: none where the person glides."""
    moved = found.people[0].positions - found.people[0].positions[:, :1]
    return float(np.ptp(moved[:, [20, 21]], axis=0).max())


def imported(animation: Any = None, data: bytes = FILE) -> Imported:
    return import_motion(data, name="x.glb", choices=ImportChoices(animation=animation))


def noted(found: Imported) -> str:
    assert found.animations is not None
    return found.animations.note


def test_one_animation_needs_no_choice_and_no_note() -> None:
    found = imported(data=glb_motion(ROTATIONS, ROOT))
    assert noted(found) == "" and limbs(found) > 0.1
    np.testing.assert_array_equal(
        imported(1, glb_motion(ROTATIONS, ROOT)).people[0].positions, found.people[0].positions
    )


def test_the_first_of_several_is_read_and_the_others_are_named() -> None:
    found = imported()
    assert limbs(found) > 0.1
    assert noted(found) == NOTE.format("1 (“Walk”)", "2 (“glide”), 3 (“3”) and 4 (“2”)")


@pytest.mark.parametrize(
    ("choice", "number"),
    [("Walk", 1), ("walk", 1), (1, 1), ("1", 1), ("glide", 2), (" GLIDE ", 2), (2, 2), ("2", 4), ("3", 3), ("4", 4)],
)
def test_another_is_chosen_by_its_name_or_else_by_its_number(choice: Any, number: int) -> None:
    found = imported(choice)
    assert found.animations is not None and found.animations.taken == (number,)
    assert (limbs(found) > 0.1) == (number == 1)


@pytest.mark.parametrize("choice", [5, "5", "run", 10**12, "9" * 5000, "²", "\ud800"])
def test_one_that_is_not_there_is_a_sentence_that_lists_them(choice: Any) -> None:
    with pytest.raises(InputError) as error:
        imported(choice)
    listed = "1 (“Walk”), 2 (“glide”), 3 (“3”) or 4 (“2”)"
    assert str(error.value) == f"x.glb has no such animation: choose {listed}."


@pytest.mark.parametrize("choice", [0, -1, True, 1.5, "", "  ", ["walk"]])
def test_a_choice_is_a_name_or_a_number(choice: Any) -> None:
    with pytest.raises(InputError, match="is neither a name nor a number from 1"):
        ImportChoices(animation=choice)
    with pytest.raises(InputError, match="is neither a name nor a number from 1"):
        read_glb(FILE, name="x.glb", animation=choice)


def test_every_reader_takes_the_choice(tmp_path: Path) -> None:
    path = tmp_path / "x.glb"
    path.write_bytes(FILE)
    found = (
        read(path, choices=ImportChoices(animation="glide")),
        read_everyone(path, choices=ImportChoices(animation=2)),
        read(FILE, name="x.glb", choices=ImportChoices(animation="2")),
    )
    for clip in found:
        assert isinstance(clip, Clip)
        np.testing.assert_array_equal(clip.positions, found[0].positions)
    assert np.abs(found[0].positions - read(path).positions).max() > 0.1
    assert animation_note(path, "glide") == NOTE.format("2 (“glide”)", "1 (“Walk”), 3 (“3”) and 4 (“2”)")


def test_other_formats_have_none_to_choose(tmp_path: Path) -> None:
    path = tmp_path / "x.bvh"
    path.write_text(bvh_text(ROTATIONS, ROOT, RIGS["mixamo"]))
    assert animation_note(path) == ""
    for reading in (
        lambda: read(path, choices=ImportChoices(animation="walk")),
        lambda: read_everyone(path, choices=ImportChoices(animation=1)),
        lambda: import_motion(path, choices=ImportChoices(animation=1)),
    ):
        with pytest.raises(InputError, match=r"^x\.bvh is no \.glb file and has no animations to choose from"):
            reading()


def test_people_with_animations_of_their_own_keep_them() -> None:
    data = glb_motion(ROTATIONS, ROOT, people=2)
    assert animations_in(data, name="x.glb") == Animations("x.glb", ("walk 0", "walk 1"), (1, 2))
    assert animations_in(data, name="x.glb").note == "", "both are read"
    document, blob = unpacked(data)
    document["animations"].append({**document["animations"][1], "name": "wave 1"})
    several = packed(document, blob)
    people, found = read_glb(several, name="x.glb", animation="wave 1")
    assert len(people) == 2 and found.taken == (1, 3)
    assert found.note == (
        "Of the 3 animations in x.glb, 1 (“walk 0”) and 3 (“wave 1”) were taken; the other is 2 (“walk 1”)."
    )


def test_animations_of_other_things_do_not_count() -> None:
    document, blob = unpacked(FILE)
    props = {**document["animations"][0], "name": "door", "channels": []}
    document["animations"].insert(0, props)
    assert noted(imported(data=packed(document, blob))) == noted(imported())


def test_a_partner_stands_in_the_world_of_the_chosen_animation(tmp_path: Path) -> None:
    high = glb_takes(ROTATIONS, ROOT + np.array([0, 5.0, 0]), ["high"])
    document, blob = unpacked(high)
    still = {
        "name": "low",
        "samplers": document["animations"][0]["samplers"],
        "channels": [c for c in document["animations"][0]["channels"] if c["target"]["path"] == "rotation"],
    }
    document["animations"].append(still)
    path = tmp_path / "x.glb"
    path.write_bytes(packed(document, blob))
    made = {
        choice: read_glb(on_rig(Clip(POSITIONS, 30.0), path, animation=choice), name="y.glb")[0][0].positions
        for choice in (1, "low")
    }
    lower = made[1][:, 0, 1].mean() - made["low"][:, 0, 1].mean()
    assert lower == pytest.approx(5.0 + ROOT[:, 1].mean(), abs=0.3), "the floor is where that animation has it"


HOSTILE = ["first\nline\x00\u202e\ud800", "<b>bold</b>", "y" * 100_000, None, {"a": 1}, "z"]


def test_names_are_shown_on_one_line_and_cut() -> None:
    note = noted(imported(data=glb_takes(ROTATIONS, ROOT, HOSTILE)))
    assert note == (
        "Of the 6 animations in x.glb, 1 (“first line”) was taken; the others are 2 (“<b>bold</b>”), "
        f"3 (“{'y' * 39}…”), 4, 5 and 6 (“z”)."
    )
    assert imported("y" * 100_000, glb_takes(ROTATIONS, ROOT, HOSTILE)).animations.taken == (3,)


def test_thousands_of_animations_are_a_short_sentence_soon() -> None:
    data = glb_takes(ROTATIONS[:4], ROOT[:4], [f"take {i}" for i in range(600)])
    document, blob = unpacked(data)
    tiny = {**document["animations"][1], "samplers": [], "channels": document["animations"][1]["channels"][:1]}
    document["animations"] = [document["animations"][0], *({**tiny, "name": f"{i}"} for i in range(1, 15_000))]
    data = packed(document, blob)
    began = time.process_time()
    note = noted(imported(data=data))
    assert note.startswith("Of the 15,000 animations") and note.endswith("6 (“5”) and 14,994 more.")
    with pytest.raises(InputError, match=r"or 14,995 more\."):
        imported("none of them", data)
    assert time.process_time() - began < 4
