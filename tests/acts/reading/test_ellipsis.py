"""Sentences without a verb: acts that nouns say, how parts of the body are held, and where somebody is."""

import pytest

from acts import lexicon, read
from acts.reading.ellipsis import Ellipsis
from acts.reading.spelling import Speller
from acts.reading.wording import prepared


@pytest.mark.parametrize(
    ("text", "parsed"),
    [
        ("She throws left, right, left.", "She throws to the left and throws to the right and throws to the left ."),
        ("He turns his head left then right.", "He turns his head to the left then turns his head to the right ."),
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
        ("Four jumping jacks, then a deep lunge.", ["jumping-jacks ab 4", "lunge ab"]),
        ("high five!! then a hip bump", ["high-five ab", "hip-bump ab"]),
        (
            "He boxes, two jabs with the left and a cross with the right.",
            ["fight a", "punch a left 2", "punch a right"],
        ),
        ("A leads with slow arm circles.", ["circle-arms a"]),
        # the same to another side
        ("The athlete throws left, right, left.", ["punch a left", "punch a right", "punch a left"]),
        # parts of the body, and whose they are
        ("Left arm overhead, right hand on the hip.", ["raise-arm ab left", "hands-on-hips ab right"]),
    ],
)
def test_a_sentence_without_a_verb_has_its_acts(text: str, acts: list[str]) -> None:
    found = read(text).acts
    assert [" ".join(filter(None, (a.act, "".join(a.agents), a.side, str(a.times or "")))) for a in found] == acts


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
