"""Mechanisms that sentences of strangers asked for, each by an example that is read wrongly without it."""

import pytest

from acts import Act, read
from acts.plan import FROM_BEHIND
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        # WordNet's verbs with their particles
        ("He is bowled over.", [("push-over", "b", "a")]),
        ("He dozes off.", [("lie-down", "a", None)]),
        # a full stop that is missing
        ("A hugs B from behind", [("hug-from-behind", "a", "b")]),
        ("dad and daughter walking hand in hand", [("walk-hand-in-hand", "ab", None)]),
        # a verb where the parser saw none
        ("make the girl wave and the boy bow", [("wave", "a", "b"), ("bow", "b", None)]),
        ("The person on the left squats twice and the other one claps.", [("crouch", "a", None), ("clap", "b", "a")]),
        # the other is the other of the one who was named first
        ("One person pushes the other and the other sits down.", [("push", "a", "b"), ("sit-down", "b", None)]),
        # "the other ducks" may be birds to the parser
        ("A man punches and the other ducks.", [("punch", "a", None), ("duck", "b", None)]),
        ("A man waves and the other claps.", [("wave", "a", "b"), ("clap", "b", "a")]),
        ("She staggers into the arms of the other.", [("stagger", "a", "b")]),
        # nouns that are people where they act
        (
            "The base lies on her back, the flyer stretches out both arms.",
            [("lie-down", "a", None), ("extend-arm", "b", None)],
        ),
        ("emma pinches jakes cheek, jake runs off", [("pinch", "a", "b"), ("run-away", "b", "a")]),
        ("the barber kisses a customers cheek", [("kiss", "a", "b")]),
        # an order about one other person is given to one
        ("carry your injured friend over your shoulder", [("carry", "a", "b")]),
        # a clause that the parser made a subject
        (
            "B waves; A leans back, then kicks the dagger out of B's hand.",
            [("wave", "b", "a"), ("lean", "a", None), ("disarm", "a", "b")],
        ),
        ("He jumps out.", [("jump", "a", None)]),
        ("tickel him", [("tickle", "a", "b")]),
        ("An elderly lady pats an old man on the back.", [("pat", "a", "b")]),
        ("She crawls on hands and knees around him.", [("crawl-under", "a", "b")]),
    ],
)
def test_a_sentence_is_read(text: str, acts: list[tuple[str, str, str | None]]) -> None:
    assert told(text) == acts


def only(text: str) -> Act:
    (act,) = read(text).acts
    return act


def test_a_noun_is_pretended_as_a_verb_is() -> None:
    assert only("She fakes a kick.").modality == "pretended"
    assert only("She drinks imaginary tea.").modality == "pretended"


def test_what_is_finished_is_done() -> None:
    assert only("She has finished stretching.").polarity == "done"


def test_a_hand_may_be_left_out() -> None:
    reach, mirrored = read("A reaches out with the left arm; B mirrors her with the right.").acts
    assert (reach.side, mirrored.side) == ("left", "right")


def test_an_answer_follows_what_is_only_tried() -> None:
    _, ducks = read("A pretends to throw a ball and B ducks.").acts
    assert [(relation.kind, relation.act) for relation in ducks.order] == [("after", "1")]


def test_a_noun_is_not_forced_to_be_a_verb() -> None:
    for text in ("Her head swims.", "The flag flaps.", "The bridge kneels.", "He looks at her hands."):
        assert not read(text).acts, text


def test_names_are_no_misspelt_verbs() -> None:
    assert [(act.act, act.agents, act.patient) for act in read("Tom pushes Leah.").acts] == [("push", ("a",), "b")]


def test_a_repeated_act_is_done_with_the_same_side_or_the_one_that_is_named() -> None:
    for words, side in (("does the same", "left"), ("mirrors it with the right", "right")):
        first, again = read(f"A raises the left arm and B {words}.").acts
        assert (first.side, again.side) == ("left", side)


def test_from_behind_is_a_manner() -> None:
    (tap,) = read("A taps B on the shoulder from behind.").acts
    assert FROM_BEHIND in tap.manner
