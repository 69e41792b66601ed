"""Who and what the words of a clause mean: pronouns, parts of the body, pretence, and what only stresses a word."""

from __future__ import annotations

from acts import Act, read


def told(text: str) -> list[tuple[str, str, str | None]]:
    return [(act.act, "".join(act.agents), act.patient) for act in read(text).acts]


def last(text: str) -> Act:
    return read(text).acts[-1]


def test_him_and_her_are_two_people() -> None:
    assert told("The ghost pulls him to her.") == [("pull", "a", "b")]


def test_who_is_a_person_and_no_ankle() -> None:
    assert told("The physio holds the ankle of the patient, who is lying down.")[1] == ("lie-down", "b", None)


def test_as_if_is_pretended() -> None:
    assert last("Walk towards each other as if to embrace.").modality == "pretended"


def test_way_makes_more_of_a_direction() -> None:
    assert told("He holds the phone way up.") == told("He holds the phone up.") != []


def test_no_said_with_a_hand_is_a_gesture() -> None:
    assert told("He says no thanks with his hand.") == [("wave-off", "a", "b")]
    assert told("The waiter nods, the guest says no with his hand.")[1] == ("wave-off", "b", "a")
    assert last("He says no with his hand.").part_of == "a"


def test_a_sofa_that_is_carried_is_it() -> None:
    assert last("They carry a sofa and put it down.").thing == "sofa"
