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


def test_who_is_a_person_and_no_ankle() -> None:
    assert told("The physio holds the ankle of the patient, who is lying down.")[1] == ("lie-down", "b", None)


def test_as_if_is_pretended() -> None:
    assert last("Walk towards each other as if to embrace.").modality == "pretended"


def test_way_makes_more_of_a_direction() -> None:
    assert told("She takes the phone but he holds it way up.")[1] == ("hold-thing", "b", None)


def test_no_said_with_a_hand_is_a_gesture() -> None:
    assert told("He says no thanks with his hand.") == [("wave-off", "a", "b")]
    assert told("The waiter nods, the guest says no with his hand.")[1] == ("wave-off", "b", "a")
    assert last("He says no with his hand.").part_of == "a"


def test_they_after_a_letter_are_both_and_after_somebody_are_one() -> None:
    assert told("A walks away. Then they shake hands.")[1] == ("shake-hands", "ab", None)
    assert told("Someone walks in. They sit down.")[1] == ("sit-down", "a", None)


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


def test_the_hand_that_is_held_out_is_the_others() -> None:
    text = "Instead of taking the hand that is held out to him, the second person turns his back."
    taken, offered, turned = read(text).acts
    assert (taken.act, taken.polarity) == ("hold-hands", "not")
    assert (offered.act, offered.agents, offered.patient) == ("offer-thing", ("a",), "b")
    assert (turned.act, turned.agents) == ("turn-away", ("b",))


def test_a_part_that_is_ones_own_is_not_the_other_persons() -> None:
    assert last("A touches B's shoulder and then touches his own shoulder.").part_of == "a"


def test_her_back_is_a_part_of_the_body_where_something_is_done_to_it() -> None:
    touched = read("He touches her back and then she runs.").acts[0]
    assert (touched.part, touched.part_of, touched.direction) == ("back", "b", None)
    assert last("She hugs him and he hugs her back.").act == "hug"


def test_the_knee_of_the_one_who_is_handled() -> None:
    assert told("The physio holds the ankle of the patient and bends the knee.")[1] == ("move-other", "a", "b")
    assert told("She holds the ankle of the patient and raises a hand.")[1][0] == "raise-arm"


def test_his_chest_is_his_own_where_it_may_be_either_s() -> None:
    assert told("The man nods and the other man grabs his chest.")[1] == ("hand-on-chest", "b", None)


def test_neither_denies_for_both() -> None:
    act = last("They push each other, but neither gives way.")
    assert (act.agents, act.polarity) == (("a", "b"), "not")


def test_what_stands_against_each_other_is_no_object() -> None:
    assert told("They push each other over, palms against palms.") == [("push-palms", "ab", None)]


def test_a_sleeper_lies() -> None:
    lying = read("The sleeper's arm is lifted by the visitor and falls back when it is let go.").acts
    assert ("lie-down", ("a",), True) in [(act.act, act.agents, act.already) for act in lying]
    assert ("free", ("b",)) in [(act.act, act.agents) for act in lying]


def test_backing_out_is_walking_backwards() -> None:
    assert told("The servant backs out of the room.")[0][0] == "step-back"


def test_with_a_hand_on_his_back_is_a_touch() -> None:
    stops = last("A man crawls until a woman stops him with a hand on his back.")
    assert (stops.act, stops.agents, stops.part, stops.part_of) == ("catch-person", ("b",), "back", "a")


def test_what_goes_between_two_goes_to_each() -> None:
    act = last("They roll a ball to and fro between them.")
    assert (act.act, act.direction) == ("bowl", None)


def test_one_who_is_held_tugs_meanwhile() -> None:
    (relation,) = read("A holds on to B's wrist, and B tugs backwards.").acts[1].order
    assert relation.kind == "with"


def test_it_is_no_plural() -> None:
    assert last("A throws a ball to B, who catches it with both hands and throws it back.").thing == "ball"


def test_a_name_that_looks_like_a_plural_is_one_person() -> None:
    assert told("Romeo kneels before Juliet and kisses her hand.") == [("kneel", "a", "b"), ("kiss-hand", "a", "b")]


def test_an_object_that_the_parser_took_for_a_remark() -> None:
    checks = last("One person lies down on the back and the other checks the pulse at the neck.")
    assert (checks.act, checks.patient, checks.part) == ("examine", "a", "neck")


def test_what_is_asked_of_somebody_is_theirs() -> None:
    assert told("She coaxes him to sit down.")[-1][:2] == ("sit-down", "b")


def test_who_does_not_flinch_stands_still() -> None:
    for name in ("move-about", "flinch"):
        assert [shape.do for shape in lexicon().entries[name].refused] == ["stay"]
    assert (last("He does not react.").act, last("He does not budge.").act) == ("flinch", "move-about")


def test_what_is_tried_is_countered() -> None:
    assert read("He goes in for a kiss but she turns her head away.").acts[0].modality == "tried"
    assert read("He goes in for a kiss and she turns her head away.").acts[0].modality == "told"


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


def test_the_friend_behind_her_owns_no_catches() -> None:
    acts = read("the bride throws the bouquet over her shoulder and the friend behind her catches it").acts
    assert [(act.act, act.agents, act.thing) for act in acts][1] == ("catch-thing", ("b",), "bouquet")


def test_one_and_the_other_with_half_a_verb() -> None:
    assert told("Two people dance a waltz, one leading and the other following.")[-1] == ("follow", "b", "a")


def test_right_only_stresses_a_place() -> None:
    assert last("The other one stops right there.").side is None


def test_who_draws_somebody_after_them_leads() -> None:
    assert told("The ghost draws him after her.") == [("lead", "a", "b")]


def test_who_is_stopped_does_not_fall() -> None:
    falls = last("She stops him from falling.")
    assert (falls.act, falls.agents, falls.polarity) == ("fall-down", ("b",), "not")


def test_trying_something_at_the_same_time_is_one_act() -> None:
    assert told("Both try to pick up the pen at the same time.") == [("pick-up-thing", "ab", None)]


def test_what_stands_between_commas_is_done_meanwhile() -> None:
    assert told("The mother, kneeling, ties the child's shoelaces.")[0] == ("kneel", "a", None)


def test_who_is_lying_down_lies_already() -> None:
    assert last("He waves to the patient, who is lying down.").already


def test_frozen_on_one_leg_is_on_one_leg() -> None:
    assert [name for name, _, _ in told("The first is frozen on one leg.")] == ["freeze", "stand-on-one-leg"]


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


@pytest.mark.parametrize("text", ["Two kids fight, mom comes", "Two men fight, a woman walks up to them."])
def test_who_is_unlike_the_two_is_a_third_person(text: str) -> None:
    plan = read(text)
    assert said(text) == ["ab fight"] and "third person" in plan.unread[0].why
    assert said("Two children play, the boy waves.")[-1] == "a wave b", "he is one of them"


def test_slow_circles_are_done_and_nothing_slows() -> None:
    assert said("He does slow arm circles.") == ["a circle-arms"]
    assert said("does slow arm circles") == ["ab circle-arms"]
    assert said("They do shake hands.") == ["ab shake-hands"]


def test_march_is_no_month_where_it_begins() -> None:
    assert said("march in step, then salute") == ["ab walk-together", "ab unison", "ab salute"]
    assert said("March forward in step, then halt.") == ["ab walk-together", "ab unison", "ab stand-still"]
