"""The captions of any story are grammatical: names, articles, agreement, pronouns, verb phrases."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from acts import Act, read
from acts.captions import VERB, singular
from tests.training.corpus.recorded import KINDS
from training.corpus.cues import Beat, Label, label, steps
from training.corpus.phrasing import OBJECTS, OWN, Names, draw_cast, fitting, phrases, reads_back, spoken
from training.corpus.telling import LONGEST, Teller

LENGTH = 60
_PERSON = r"(?:the (?:first|second|other)|another|one|an?) (?:person|man|woman|friend|player|dancer)"
_ONE = rf"(?<!and )(?:he|she|one of them|{_PERSON})"
_BOTH = r"(?:they|the two|the two of them|two (?:men|women|people|friends|players|dancers))"


def beats_of(number: int) -> list[tuple[str, str]]:
    """The cues of a and b in one to three beats, drawn by a number."""
    rng = np.random.default_rng(number)
    kinds = [KINDS[kind] for kind in rng.integers(len(KINDS), size=rng.integers(1, 4))]
    return [kind[rng.integers(len(kind))] for kind in kinds]


def labelled(number: int) -> Label:
    """The label of such beats, which last two seconds each."""
    beats = [
        Beat(pair, k * LENGTH, (k + 1) * LENGTH, relation="while" if pair[0] == pair[1] else "reply")
        for k, pair in enumerate(beats_of(number))
    ]
    return label(beats, LENGTH * len(beats))


def told(number: int, seed: int, split: str = "train") -> list[str]:
    """Captions of the scene with this number: of both people, of each, and of its first beat."""
    known = labelled(number)
    teller = Teller(np.random.default_rng(seed), known, split)
    return [*teller.tell(3), *teller.tell(1, "a"), *teller.tell(1, "b"), *teller.tell(1, only=known.beats[0])]


@cache
def verbs() -> frozenset[str]:
    """Base forms of the verbs of all phrases in the scenes; "back" is an adverb as well ("pushes him back")."""
    names = {name for kind in KINDS for pair in kind for cue in pair for g in steps(cue) for name, *_ in g}
    found = {verb for name in names for text in phrases(name) for verb in VERB.findall(text)}
    return frozenset(found) - {"back"}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_captions_are_sentences(number: int, seed: int) -> None:
    bases, thirds = verbs(), {singular(verb) for verb in verbs()}
    for text in told(number, seed):
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


def test_test_captions_use_words_that_no_training_caption_uses() -> None:
    train = {text for number in range(40) for text in told(number, number)}
    test = {text for number in range(40) for text in told(number, number, "test")}
    assert train and test and len(train & test) < 0.1 * len(test)  # where the names that are kept are not said


def test_captions_tell_acts_of_their_label_and_say_where_and_what_people_are_doing() -> None:
    rng = np.random.default_rng(3)
    texts, right = [], 0
    for number in range(150):
        known, pairs = labelled(number), beats_of(number)
        acts = {act.act for act in known.plan.acts}
        for text in Teller(rng, known, "train").tell(1):
            texts.append(text)
            found = [act.act for act in read(text).acts]
            right += bool(found) and set(found) <= acts and len(found) >= len(pairs) - 1
    assert len(texts) > 130 and right >= 0.9 * len(texts)
    going = [text for text in texts if re.search(r"\b(is|are) \w+ing\b", text)]
    assert going and not [text for text in going if " then " in text], "said of one moment alone"
    assert 8 <= sum(text.startswith(("In ", "At ", "On ")) for text in texts) <= 35


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
