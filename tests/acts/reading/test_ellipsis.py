"""Sentences without a verb: acts that nouns say, how parts of the body are held, and where somebody is."""

import pytest

from acts import lexicon, read
from acts.reading.ellipsis import Ellipsis
from acts.reading.spelling import Speller
from acts.reading.wording import prepared
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "parsed"),
    [
        ("Two hops, a half turn, then a bow.", "perform two hops . turn around , then perform a bow ."),
        ("Therapist behind, arms crossed.", "Therapist is behind , with arms crossed ."),
        ("Both in a deep plie.", "Both are in a deep plie ."),
        ("She throws left, right, left.", "She throws to the left and throws to the right and throws to the left ."),
        # no ellipsis: another clause, an act's own noun, a person
        ("A hug makes her happy.", "A hug makes her happy ."),
        ("He gives her a hug.", "He gives her a hug ."),
        ("A man waves.", "A man waves ."),
        ("Two boxers throw punches.", "Two boxers throw punches ."),
        ("With a wave and a bow he leaves.", "With a wave and a bow he leaves ."),
    ],
)
def test_a_verb_is_supplied_where_one_is_left_out(text: str, parsed: str) -> None:
    assert prepared(text, Speller(lexicon())).parsed == parsed


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        # nouns of acts
        ("Two hops, a half turn, then a bow.", ["jump ab 2", "turn-around ab", "bow ab"]),
        ("Four jumping jacks, then a deep lunge.", ["jumping-jacks ab 4", "lunge ab"]),
        ("high five!! then a hip bump", ["high-five ab", "bump-into ab"]),
        (
            "He boxes, two jabs with the left and a cross with the right.",
            ["fight a", "punch a left 2", "punch a right"],
        ),
        ("March in step, eight counts forward.", ["walk-together ab", "unison ab", "walk-together ab"]),
        ("Both in a deep plie.", ["bend-knees ab"]),
        ("Two deep lunges, both in unison.", ["lunge ab 2", "unison ab"]),
        ("A leads with slow arm circles.", ["circle-arms a"]),
        ("A slap, and he doesn't even move.", ["slap b", "move-about a"]),
        ("A pat on the back, then a bow.", ["pat a", "bow ab"]),
        # the same to another side
        ("The athlete throws left, right, left.", ["punch a left", "punch a right", "punch a left"]),
        # parts of the body, and whose they are
        ("Left hands behind the back: they lunge.", ["hands-behind-back ab left", "lunge ab"]),
        ("police guy cuffs the thief hands behind his back", ["tie-up a", "hands-behind-back b both"]),
        (
            "Weight on the right leg, left knee at hip height, partner mirrors it facing you.",
            ["stand-on-one-leg a right", "raise-knee a left", "raise-knee b right"],
        ),
        (
            "Both in a plie, backs straight, knees out, then rise.",
            ["bend-knees ab", "stand-tall ab", "turn-out ab both", "stand-tall ab"],
        ),
        ("Left arm overhead, right hand on the hip.", ["raise-arm ab left", "hands-on-hips ab right"]),
        # where somebody is
        (
            "Therapist behind, both hands under the patient's shoulder blades; the patient rises from the chair.",
            ["stand-behind a", "hand-on a both", "stand-up b"],
        ),
        ("One dancer on her knees, the other behind her.", ["kneel a both", "stand-behind b"]),
    ],
)
def test_a_sentence_without_a_verb_has_its_acts(text: str, acts: list[str]) -> None:
    found = read(text).acts
    assert [" ".join(filter(None, (a.act, "".join(a.agents), a.side, str(a.times or "")))) for a in found] == acts


def test_formations_without_a_verb_go_with_the_act_before() -> None:
    assert [[act.act for act in beat] for beat in read("Two deep lunges, both in unison.").beats()] == [
        ["lunge", "unison"]
    ]


def test_an_act_without_a_verb_names_the_words_that_say_it() -> None:
    for text in ("two B hugs", "Two hops, then a bow."):
        assert all(act.words.start < act.words.stop for act in read(text).acts)


def looks(words: list[str]) -> int:
    """Times that a word is looked at while the verbs that a text lacks are found."""
    counted = 0

    def lower(i: int) -> str:
        nonlocal counted
        counted += 1
        return words[i] if 0 <= i < len(words) else ""

    ellipsis = Ellipsis(lower, Speller(lexicon()))
    for i in range(len(words)):
        ellipsis.before(i)
    return counted


@pytest.mark.parametrize("part", [["a", "hop", ","], ["left", ","], ["a", "b"]])
def test_an_ellipsis_is_read_in_linear_time(part: list[str]) -> None:
    assert looks(part * 400) < 2.2 * looks(part * 200)


def test_nose_to_nose_is_close() -> None:
    assert told("Begin nose to nose, then circle without losing eye contact.") == [
        ("stand-close", "ab", None),
        ("circle-together", "ab", None),
        ("turn-to", "ab", None),
    ]
