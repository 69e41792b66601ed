"""The captions of any story are grammatical: names, articles, agreement, pronouns, verb phrases."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acts import Act
from acts.captions import gerund, singular
from training.corpus.beats.stories import stories
from training.corpus.cues import Beat, label, steps
from training.corpus.people import OBJECTS, OWN, Names, draw_cast
from training.corpus.phrasing import fitting, held_out, phrases, reads_back, spoken
from training.corpus.telling import LONGEST, Teller, Told

LENGTH = 60
_PERSON = r"(?:the (?:first|second|other)|another|one|an?) (?:person|man|woman|friend|player|dancer)"
_ONE = rf"(?<!and )(?:he|she|one of them|{_PERSON})"
_BOTH = r"(?:they|the two|the two of them|two (?:men|women|people|friends|players|dancers))"


def told(number: int, seed: int, split: str = "train") -> list[Told]:
    """Captions of the story with this number: of both people, of each, and of its first beat."""
    pairs = stories()[number % len(stories())]
    beats = [
        Beat(pair, k * LENGTH, (k + 1) * LENGTH, relation="while" if pair[0] == pair[1] else "reply")
        for k, pair in enumerate(pairs)
    ]
    known = label(beats, LENGTH * len(pairs))
    teller = Teller(np.random.default_rng(seed), known, split)
    return [*teller.scene(3), *teller.alone("a", 1), *teller.alone("b", 1), *teller.beat(known.beats[0], 1)]


@cache
def verbs() -> frozenset[str]:
    """Base forms of the verbs of all phrases in the stories; "back" is an adverb as well ("pushes him back")."""
    names = {name for pairs in stories() for pair in pairs for cue in pair for g in steps(cue) for name, *_ in g}
    found = {verb for name in names for text in phrases(name) for verb in re.findall(r"\[([a-z-]+)\]", text)}
    return frozenset(found) - {"back"}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_captions_are_sentences(number: int, seed: int) -> None:
    bases, thirds = verbs(), {singular(verb) for verb in verbs()}
    for one in told(number, seed):
        text = one.text
        assert len(text) <= LONGEST and not re.search(r"[{}\[\]\0]|\s\s|\s[.,]|[.,]{2}|\bNone\b", text), text
        assert text.endswith(".") and re.fullmatch(r"[A-Z].*", text), text
        assert all(part[0].isupper() for part in re.split(r"(?<=[.]) ", text)), text
        assert not re.search(r"\ba [aeio]\w|\ban [^aeiouAEIOU\s]", text), text
        low = text.lower()
        for match in re.finditer(rf"\b{_ONE} ([a-z-]+)", low):
            assert match[1] not in bases - thirds, (match[0], text)
        for match in re.finditer(rf"\b{_BOTH} ([a-z-]+)", low):
            assert match[1] not in thirds - bases, (match[0], text)
        assert not re.search(r"\b(he|she|they) (him|her|them)\b", low), text


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_in_the_plan_of_a_caption_a_is_the_person_named_first(number: int, seed: int) -> None:
    for one in told(number, seed):
        agents = {who for act in one.plan.acts for who in act.agents}
        patients = {act.patient for act in one.plan.acts} - {None}
        assert one.plan.acts and agents | patients <= {"a", "b"}
        if one.plan.acts[0].agents == ("b",):  # a is the person named first
            assert "a" in one.plan.acts[0].agents or one.plan.acts[0].patient == "a"


def test_test_captions_use_words_that_no_training_caption_uses() -> None:
    train = [one for number in range(40) for one in told(number, number)]
    test = [one for number in range(40) for one in told(number, number, "test")]
    assert train and test
    assert not any(one.test for one in train) and all(one.test for one in test)


@given(st.integers(0, 100_000))
def test_a_person_is_introduced_once_and_then_known(seed: int) -> None:
    rng = np.random.default_rng(seed)
    names = Names(rng, draw_cast(rng))
    first, other = names.subject("a"), names.object("b")
    assert first == names.cast.first[0] and other == names.cast.first[1]
    assert names.subject("a") == names.cast.later[0]
    assert names.object("b") in (names.cast.later[1], OBJECTS.get(names.cast.pronouns[1]))
    assert names.object("b", pronoun=False) == names.cast.later[1]
    assert names.order == ["a", "b"] and names.own(("b",)) == OWN[names.cast.pronouns[1]]


@given(st.integers(0, 100_000))
def test_two_people_who_began_together_are_told_apart_later(seed: int) -> None:
    rng = np.random.default_rng(seed)
    names = Names(rng, draw_cast(rng, joint=True))
    both = names.subject("ab")
    assert both == names.cast.group or "two" in both or both == "they"
    assert not re.match(r"an? ", names.subject("a")) and names.subject("a") != names.subject("b")
    assert "two" in names.subject("ab") or names.order == ["a", "b"]


@pytest.mark.parametrize(
    ("verb", "third", "ing"),
    [
        ("hug", "hugs", "hugging"),
        ("wave", "waves", "waving"),
        ("lie", "lies", "lying"),
        ("push", "pushes", "pushing"),
        ("high-five", "high-fives", "high-fiving"),
        ("carry", "carries", "carrying"),
        ("see", "sees", "seeing"),
        ("listen", "listens", "listening"),
        ("be", "is", "being"),
        ("bow", "bows", "bowing"),
    ],
)
def test_verbs_are_inflected(verb: str, third: str, ing: str) -> None:
    assert (singular(verb), gerund(verb)) == (third, ing)


def test_a_phrase_is_spoken_of_one_of_two_and_beside_another() -> None:
    wave = Act(id="1", act="wave", agents=("a",), patient="b", side="left")
    assert spoken(wave, "{a} [wave] at {b} with {limb}", "the other person", "his", "s") == (
        "waves at the other person with the left hand"
    )
    both = Act(id="1", act="bow", agents=("a", "b"))
    assert spoken(both, "{a} [lower] their head to {b}", "each other", "their", "plural") == (
        "lower their heads to each other"
    )
    assert spoken(wave, "{a} [wave] at {b}", "her", "his", "ing") == "waving at her"


def test_a_phrase_that_reads_as_another_act_is_not_used() -> None:
    assert reads_back("wave", "{a} [wave]", both=False)
    assert not reads_back("wave", "{a} [bow]", both=False)
    jump = Act(id="1", act="jump", agents=("a",))
    used = fitting(jump, sided=False)
    assert used and all(reads_back("jump", phrase, both=False) for phrase in used)
    assert set(phrases("jump")) - set(used)  # "springs up" is read as standing up


def test_an_act_is_told_by_all_verbs_and_plain_frames_that_are_read_as_it() -> None:
    used = fitting(Act(id="1", act="walk-up", agents=("a",)), sided=False)
    assert {"{a} [step] up to {b}", "{a} [come] towards {b}", "{a} [come]"} <= set(used)
    assert "{a} [hurry] up to {b}" in phrases("walk-up"), "a frame has it"
    assert "{a} [hurry] up to {b}" not in used, "it says how fast"
    assert spoken(Act(id="1", act="wave", agents=("a",)), "{a} [wave]", "her", "his", "is") == "is waving"


def test_a_sided_act_is_told_with_its_side_where_asked() -> None:
    wave = Act(id="1", act="wave", agents=("a",), side="left")
    assert all("{limb}" in text or "{side}" in text for text in fitting(wave, sided=True))
    assert not any("{limb}" in text or "{side}" in text for text in fitting(wave, sided=False))
    assert not held_out("one personanother person")
