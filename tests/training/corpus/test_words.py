"""Phrases and sentences: every act has words, every sentence can be staged, names and sides come out right."""

from __future__ import annotations

import re

import numpy as np

from training.corpus.beats.play import Beat
from training.corpus.beats.script import staged_by
from training.corpus.grammar import mirror_caption
from training.corpus.words import Narrator
from training.corpus.words.lexicon import count, options, pattern, phrases, sentences
from training.corpus.words.narrator import held_out
from training.corpus.words.voice import Cast, Voice, finished

PLAIN = Cast(("one person", "the other"), ("the first person", "the other"), in_turn=True)
COUPLE = Cast(("a man", "a woman"), ("the man", "the woman"), ("he", "she"))


def beat(acts: str, start: int = 0, end: int = 60, **known) -> Beat:
    (pair,) = pattern(acts)
    return Beat(pair, start, end, **known)


def test_two_thousand_sentences_are_written_by_hand() -> None:
    written, spoken = count()
    assert written >= 2000 and spoken >= 700


def test_every_sentence_tells_acts_that_have_words_and_can_be_staged() -> None:
    for story in sentences():
        for own, other in story:
            assert own in phrases() and (other == "*" or other in phrases()), story
            acts = (own, "stand" if other == "*" else other)
            # Two acts are only recorded or played together with what comes before.
            assert staged_by(acts) or acts in (("stop", "go-on"), ("formation", "formation")), story


def test_no_token_is_left_over_and_every_sentence_ends() -> None:
    for story, lines in sentences().items():
        for line in lines:
            for cast in (PLAIN, COUPLE):
                voice = Voice(np.random.default_rng(0), cast)
                voice.sides = ("left", "right")
                text = finished(voice.sentence(options(line, True), 0))
                assert not re.search(r"[@#%*\[\]{}]|\b(?:A|B)\b(?! )|  ", text), (story, text)
                assert text[0].isupper() and text[-1] in ".!?"


def test_who_acts_is_named_and_pronouns_agree() -> None:
    voice = Voice(np.random.default_rng(0), COUPLE)
    line = "A holds out @his hand, but B does not look at @him; #he turns away."
    assert (
        voice.sentence(line, 0)
        == "a man holds out his hand, but a woman does not look at him; she turns away."
    )
    assert Voice(voice.rng, COUPLE).sentence("A waves at B.", 1) == "a woman waves at a man."
    plain = Voice(voice.rng, PLAIN)
    assert plain.sentence("B waits until A has come and A bows.", 0) == (
        "one person waits until the other has come and the other bows."
    )


def test_a_side_is_named_only_where_one_is_known() -> None:
    for sides, found in ((("left", None), True), ((None, None), False)):
        scene = [beat("raise-hand / stand", sides=sides)]
        texts = Narrator(np.random.default_rng(1), scene, "train").together(12)
        assert any("left" in text for text in texts) == found
        assert not any("right" in text for text in texts)
        for text in texts:
            assert mirror_caption(mirror_caption(text)) == text
            assert ("right" in mirror_caption(text)) == ("left" in text)


def test_captions_name_beats_in_their_order() -> None:
    scene = [beat("bow / stand"), beat("jump / stand", 60, 120), beat("walk-away / stand", 120, 180)]
    texts = Narrator(np.random.default_rng(2), scene, "train").together(30)
    signs = (r"bow|bend", r"jump|leap|hop", r"leav|left|walk|go|away|depart|off\b|behind")
    assert len(texts) > 15
    for text in texts:
        places = [re.search(sign, text, re.IGNORECASE) for sign in signs]
        assert all(places), text
        spots = [place.start() for place in places if place]
        assert spots[0] < spots[1], text
        assert text.count(" before ") or re.search(r"jump|leap|hop", text[: max(
            m.start() for m in re.finditer(signs[2], text, re.IGNORECASE))], re.IGNORECASE), text  # fmt: skip


def test_each_person_has_sentences_without_the_other_ones_part() -> None:
    narrator = Narrator(
        np.random.default_rng(3), [beat("push / fall"), beat("stand / walk-away", 60, 120)], "train"
    )
    for person, own, other in (
        (0, r"push|shov", r"\bfall|collapse|faint|tumbl"),
        (1, r"fall|collaps|faint|tumbl", r"push|shov"),
    ):
        texts = narrator.alone(person, 6)
        assert len(texts) >= 3
        assert all(re.search(own, text) and not re.search(other, text) for text in texts), texts


def test_splits_share_no_held_out_phrase() -> None:
    rng = np.random.default_rng(4)
    story = next(s for s, lines in sentences().items() if len(s) == 2 and any(map(held_out, lines)))
    scene = [Beat(acts, 60 * k, 60 * k + 60) for k, acts in enumerate(story)]
    train, test = (set(Narrator(rng, scene, split).together(60)) for split in ("train", "test"))
    assert train and test and not train & test


def test_about_a_sixteenth_is_held_out() -> None:
    lines = [line for found in sentences().values() for line in found]
    assert 0.03 < np.mean([held_out(line) for line in lines]) < 0.1
