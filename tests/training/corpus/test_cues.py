"""Cues are acts of the lexicon, and a scene's label is their plan."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from acts.plan import beats as groups
from motion import InputError
from training.corpus.cues import STILL, Beat, Label, class_of, label, steps

CUES = (STILL, "wave", "pat:shoulder", "raise-arm@both", "shake-hands?", "walk-up+wave", "fall-down>stand-up")
beats = st.lists(
    st.builds(
        lambda one, other, relation, first, minor, side: Beat(
            (one, other), 0, 30, first, relation, (side, None), ("slow", "normal"), minor
        ),
        st.sampled_from(CUES),
        st.sampled_from(CUES),
        st.sampled_from(("reply", "while", "order")),
        st.sampled_from((0, 1)),
        st.booleans(),
        st.sampled_from(("left", "right", None)),
    ),
    min_size=1,
    max_size=4,
)


def placed(rows: list[Beat]) -> list[Beat]:
    """The beats one after the other, 30 frames each."""
    for k, beat in enumerate(rows):
        beat.start, beat.end = 30 * k, 30 * (k + 1)
    return rows


def test_a_cue_names_acts_with_part_side_and_offer() -> None:
    assert steps("walk-up+wave@left") == ((("walk-up", None, None, False), ("wave", None, "left", False)),)
    assert steps("fall-down>pat:shoulder?") == ((("fall-down", None, None, False),), (("pat", "shoulder", None, True),))
    assert steps("") == ()


@given(beats)
def test_a_label_survives_the_index_and_covers_its_beats(rows: list[Beat]) -> None:
    found = label(placed(rows), 30 * len(rows))
    assert Label.model_validate(found.row()) == found
    ids = [act.id for act in found.plan.acts]
    assert sorted(found.spans) == sorted(ids) == sorted(i for part in found.beats for i in part)
    for beat, part in zip(rows, found.beats, strict=True):
        assert part and all(beat.start <= found.spans[i][0] < found.spans[i][1] <= beat.end for i in part)
        assert all((i in found.minor) == beat.minor for i in part)


@given(beats)
def test_exchanging_the_people_exchanges_them_in_the_label(rows: list[Beat]) -> None:
    one = label(placed(rows), 30 * len(rows)).plan.acts
    other = label([beat.swapped() for beat in rows], 30 * len(rows)).plan.acts
    swap = {"a": "b", "b": "a"}
    assert [(act.act, {swap[who] for who in act.agents}, act.order) for act in one] == [
        (act.act, set(act.agents), act.order) for act in other
    ]


def test_what_both_do_at_once_is_one_act_and_waiting_goes_on_beside() -> None:
    handshake = label([Beat(("shake-hands", "shake-hands"), 0, 30, relation="while")], 30).plan.acts
    assert [(act.act, act.agents) for act in handshake] == [("shake-hands", ("a", "b"))]
    waits = label([Beat(("wave", STILL), 0, 30), Beat(("bow", STILL), 30, 60)], 60).plan.acts
    shown = [[(act.act, act.agents) for act in group] for group in groups(waits)]
    assert shown == [[("wave", ("a",)), (STILL, ("b",))], [("bow", ("a",)), (STILL, ("b",))]]


def test_the_class_is_what_happens_and_a_scene_without_a_label_is_refused() -> None:
    rows = [Beat(("walk-up", STILL), 0, 30, minor=True), Beat(("punch", "dodge"), 30, 60)]
    assert class_of({"label": label(rows, 60).row()}) == "punch, dodge"
    assert class_of({"label": label([Beat((STILL, STILL), 0, 30)], 30).row()}) == "stand still"
    with pytest.raises(InputError, match="A scene of interhuman has no label"):
        class_of({"family": "interhuman", "label": None})
