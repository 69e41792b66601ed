"""Who and what the words of a clause mean: pronouns, parts of the body, pretence, and what only stresses a word."""

from __future__ import annotations

import pytest

from acts import Act, lexicon, read
from tests.acts.reading.reading import told


def said(text: str) -> list[str]:
    """The acts as "a hug b"."""
    return [f"{who} {act} {whom or ''}".strip() for act, who, whom in told(text)]


def last(text: str) -> Act:
    return read(text).acts[-1]


def test_as_if_is_pretended() -> None:
    assert last("Walk towards each other as if to embrace.").modality == "pretended"


def test_a_word_right_before_a_name_is_a_verb() -> None:
    assert told("A walks around the chair and taps B on the shoulder.")[1] == ("pat", "a", "b")
    assert told("A drops the book and kicks B.")[1] == ("kick", "a", "b")


@pytest.mark.parametrize(
    ("text", "act", "times"),
    [("B does push-ups beside him.", "push-ups", None), ("He does ten sit-ups.", "sit-ups", 10)],
)
def test_a_deed_with_a_hyphen_is_one_word(text: str, act: str, times: int | None) -> None:
    plan = read(text)
    assert [(found.act, found.times) for found in plan.acts] == [(act, times)] and not plan.unread


def test_a_sofa_that_is_carried_is_it() -> None:
    assert last("They carry a sofa and put it down.").thing == "sofa"


def test_a_part_that_is_ones_own_is_not_the_other_persons() -> None:
    assert last("A touches B's shoulder and then touches his own shoulder.").part_of == "a"


def test_the_knee_of_the_one_who_is_handled() -> None:
    assert told("The physio holds the ankle of the patient and bends the knee.")[1] == ("move-other", "a", "b")
    assert told("She holds the ankle of the patient and raises a hand.")[1][0] == "raise-arm"


def test_neither_denies_for_both() -> None:
    act = last("They push each other, but neither gives way.")
    assert (act.agents, act.polarity) == (("a", "b"), "not")


def test_one_who_is_held_tugs_meanwhile() -> None:
    (relation,) = read("A holds on to B's wrist, and B tugs backwards.").acts[1].order
    assert relation.kind == "with"


def test_a_name_that_looks_like_a_plural_is_one_person() -> None:
    assert told("Romeo kneels before Juliet and kisses her hand.") == [("kneel", "a", "b"), ("kiss-hand", "a", "b")]


def test_what_is_asked_of_somebody_is_theirs() -> None:
    assert told("She coaxes him to sit down.")[-1][:2] == ("sit-down", "b")


def test_who_does_not_flinch_stands_still() -> None:
    for name in ("move-about", "flinch"):
        assert [shape.do for shape in lexicon().entries[name].refused] == ["stay"]
    assert (last("He does not react.").act, last("He does not budge.").act) == ("flinch", "move-about")


def test_what_is_done_instead_is_all_that_is_done() -> None:
    shaken, bowed = read("Rather than shake hands, they bow.").acts
    assert (shaken.polarity, bowed.polarity) == ("not", "done")


def test_who_acts_like_it_only_pretends() -> None:
    assert read("He acts like he's gonna throw the ball.").acts[0].modality == "pretended"


def test_a_verb_without_its_person_is_done_to_the_other() -> None:
    assert told("One pushes and the other falls.") == [("push", "a", "b"), ("fall-down", "b", None)]
    assert told("B feints a stab with the dagger.") == [("sword-fight", "b", "a")]
    assert told("He dares to hope.") == []
    assert "lead" not in [name for name, _, _ in told("A leads with slow arm circles, B follows.")]


def test_them_are_things_that_were_dropped() -> None:
    assert told("she drops her keys he picks them up") == [("let-go", "a", None), ("pick-up-thing", "b", "a")]


def test_who_is_stopped_does_not_fall() -> None:
    falls = last("She stops him from falling.")
    assert (falls.act, falls.agents, falls.polarity) == ("fall-down", ("b",), "not")


def test_who_is_lying_down_lies_already() -> None:
    assert last("He waves to the patient, who is lying down.").already


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A hugs B and he waves", ["a hug b", "a wave b"]),
        ("A hugs B. He waves.", ["a hug b", "a wave b"]),
        ("A hugs B and they wave", ["a hug b", "ab wave"]),
        ("A woman hugs a man and he waves", ["a hug b", "b wave a"]),
        ("A pushes B and he falls", ["a push b", "b fall-down"]),
        ("A and B hug and he waves", ["ab hug", "a wave b"]),
    ],
)
def test_a_pronoun_behind_what_two_do_together_goes_on_with_its_subject(text: str, acts: list[str]) -> None:
    assert said(text) == acts


def test_slow_circles_are_done_and_nothing_slows() -> None:
    assert said("He does slow arm circles.") == ["a circle-arms"]
    assert said("does slow arm circles") == ["a circle-arms"]
    assert said("They do shake hands.") == ["ab shake-hands"]


def test_what_comes_next_follows_what_then_brings() -> None:
    acts = read("a man walks forward, then pivots on his foot and does a half turn, and claps.").acts
    assert [[relation.act for relation in act.order] for act in acts] == [[], ["1"], ["2"], ["3"]]


def test_a_part_on_which_something_lies_is_not_what_acts() -> None:
    assert last("a person is walking with a purse on their left arm.").side is None
    assert last("a person hops on the left foot.").side == "left"


def test_steps_are_a_length_and_no_repetition() -> None:
    few = last("a person walks a few steps forward.")
    assert (few.times, few.distance) == (3, pytest.approx(2.1))
    jogs = last("a person jogs 2 steps to the right.")
    assert (jogs.times, jogs.distance) == (None, pytest.approx(1.4))


def test_a_count_behind_a_part_is_no_part_of_it() -> None:
    pats = last("One person taps the other on the back four times with the left hand.")
    assert (pats.part, pats.part_of, pats.times, pats.side) == ("back", "b", 4, "left")
