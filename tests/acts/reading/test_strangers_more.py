"""More mechanisms that sentences of strangers asked for: who does it, and what hangs on what."""

import pytest

from acts import read
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        # an adverb that the parser takes for a verb, and a safe verb that it takes for an auxiliary
        ("The waiter bows stiffly and pours wine for the lady.", [("bow", "a", None), ("pour-for", "a", "b")]),
        ("These two shake hands.", [("shake-hands", "ab", None)]),
        ("They both reply with a nod.", [("nod", "ab", None)]),
        # "who" that hangs on something else than its person
        ("The girl skips beside her grandfather, who shuffles along.", [("skip", "a", "b"), ("strut", "b", None)]),
        ("She takes a picture of the model, who bows.", [("photo", "a", "b"), ("bow", "b", None)]),
        # a part of the body as the subject
        (
            "The guard frisks the prisoner, whose hands are clasped behind his head.",
            [("search-person", "a", "b"), ("hands-behind-head", "b", None)],
        ),
        # a participle of what was done to the subject
        ("Shoved hard in the chest, the drunk topples backward.", [("push", "b", "a"), ("fall-down", "a", None)]),
        ("Seated on the floor, she claps.", [("sit-on-floor", "a", None), ("clap", "a", "b")]),
        ("It is a tango where he dips her.", [("dip", "a", "b")]),
        ("The lead bows and the follow curtsies.", [("bow", "a", None), ("curtsy", "b", None)]),
        ("Lead dips the follow.", [("dip", "a", "b")]),
        ("He walks up to her, hands over a parcel and leaves.",
         [("walk-up", "a", "b"), ("hand-over", "a", "b"), ("walk-away", "a", "b")]),
        (
            "hold hands, swing arms, walk",
            [("hold-hands", "ab", None), ("swing-arms", "ab", None), ("walk-together", "ab", None)],
        ),
        ("couple slow dancing", [("waltz", "ab", None)]),
        ("Spin her out, and dip her low.", [("twirl", "a", "b"), ("dip", "a", "b")]),
        ("One grabs the other by the wrist and drags her a few steps to the left.",
         [("hold-hands", "a", "b"), ("drag", "a", "b")]),
        ("person 2 tails person 1 down the street", [("follow", "b", "a")]),
        ("ninjas circling one another", [("circle-together", "ab", None)]),
        ("they bump heads picking up the same pencil", [("headbutt", "ab", None), ("pick-up-thing", "ab", None)]),
        ("Tom helps Jerry up off the ground.", [("help-up", "a", "b")]),
        ("A shuffles stage right.", [("step-aside", "a", None)]),
        ("two dudes leaning on eachother lol", [("head-on-shoulder", "ab", None)]),
        ("The one on the left waves, and the one on the right bows.", [("wave", "a", "b"), ("bow", "b", None)]),
    ],
)  # fmt: skip
def test_a_sentence_is_read(text: str, acts: list[tuple[str, str, str | None]]) -> None:
    assert told(text) == acts


def test_what_was_done_first_comes_first() -> None:
    plan = read("Shoved in the chest, he falls down.")
    assert [sorted(act.act for act in beat) for beat in plan.beats()] == [["push"], ["fall-down"]]


@pytest.mark.parametrize(
    "text",
    [
        "Waltz three bars counter-clockwise, then separate to arm's length and salute.",
        "Counter-punch, block-and-push, hug.",
    ],
)
def test_a_verb_within_a_word_is_no_verb_of_its_own(text: str) -> None:
    plan = read(text)
    assert plan.acts


def test_verbs_of_distant_meaning_are_left_alone() -> None:
    """Two steps through WordNet lead anywhere: "tucks" to opening something, "lands" to following."""
    assert read("He tucks the letter into his pocket.").acts == ()
