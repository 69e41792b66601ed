"""The caption grammar: correct English, true of the scene, many ways to say the same."""

from __future__ import annotations

import re

import numpy as np
import pytest

from training.corpus.captions import FAMILIES, Phrasebook
from training.corpus.grammar import conjugate, expand, mirror_caption
from training.corpus.phrases import ACTIONS

CHOSEN = {
    "ordered": {"act_a": "bow", "act_b": "wave"},
    "together": {"act_a": "dance"},
    "copy": {"act_a": "raise-hands"},
    "watch": {"act_a": "kick"},
    "sequence": {"first": "bow", "second": "wave"},
}


def _slots(rng: np.random.Generator, family: str) -> dict:
    slots: dict = dict(CHOSEN.get(family, {}))
    if rng.random() < 0.3:
        slots["manner_a"] = str(
            rng.choice(["tired", "proud", "elderly", "active", "not-confident", "normal"])
        )
        slots["manner_b"] = slots["manner_a"] if rng.random() < 0.5 else None
    if rng.random() < 0.2:
        slots["speed"] = str(rng.choice(["slow", "fast"]))
    if rng.random() < 0.2:
        slots["distance"] = str(rng.choice(["near", "far"]))
    return slots


def test_two_thousand_captions_are_clean_english():
    rng = np.random.default_rng(0)
    captions: list[str] = []
    while len(captions) < 2000:
        for family in FAMILIES:
            captions += Phrasebook(family).sample(rng, _slots(rng, family), 3)
    for text in captions:
        assert not re.search(r"[{}*|()_]", text), text
        assert "  " not in text and text == text.strip(), text
        assert text[0].isalpha(), text
        assert not re.search(
            r"\b(an person|a other|a elderly|a old|a energetic|a object|an book)\b", text, re.I
        )
        assert not re.search(
            r"\b(they|the two|two (people|friends|persons|partners)) (is|walks|has)\b", text, re.I
        )
        singular = r"(?<!and )\b(he|she|one person|the other person) (are|have|walk|wave)\b"
        assert not re.search(singular, text, re.I), text
        assert not re.search(r"\b(\w+) \1\b", text), text
        assert not re.search(r"\s[.,;:]|[.,;:]{2}|,\.", text), text
        assert mirror_caption(mirror_caption(text)) == text


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_has_forty_phrasings_in_training_and_some_held_out(family):
    rng = np.random.default_rng(1)
    book = Phrasebook(family)
    slots = CHOSEN.get(family, {})
    train = book.sample(rng, slots, 300, split="train")
    test = book.sample(rng, slots, 40, split="test")
    assert len({_without_people(text) for text in train}) >= 40
    assert len({_without_people(text) for text in test}) >= 5
    assert not {text.lower().rstrip(".") for text in train} & {text.lower().rstrip(".") for text in test}


def _without_people(text: str) -> str:
    """The phrasing alone: case, punctuation and the names of the people and things taken out."""
    text = re.sub(r"\b(one of them|(one|the other|another|first|second|the|a|an|their|his|her) "
                  r"?(first |second |other )?(person|man|woman|partner|friends|people|one)s?|someone( else)?|"
                  r"person [ab12]|one|the (first|second|other|two)|they|them|him|her|his|their|"
                  r"two (people|friends|persons|partners)|both people)\b", "X", text.lower())  # fmt: skip
    text = re.sub(
        r"\b(an?|the) (object|book|cup|box|phone|bottle|gift|letter|apple)\b|something", "THING", text
    )
    return re.sub(r"[^a-zX ]", "", text).strip()


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    "family", ["wave-back", "raise-watch", "handshake", "high-five", "punch", "kick", "pat-back"]
)
def test_a_side_that_is_given_is_named_and_the_other_is_not(family, side):
    captions = Phrasebook(family).sample(np.random.default_rng(2), {"side_a": side}, 20)
    assert len(captions) == 20
    other = {"left": "right", "right": "left"}[side]
    for text in captions:
        assert re.search(rf"\b{side}\b", text), text
        assert not re.search(rf"\b{other}\b", text), text


def test_order_words_follow_the_order_of_the_actions():
    captions = Phrasebook("ordered").sample(np.random.default_rng(3), CHOSEN["ordered"], 60)
    checked = 0
    for text in captions:
        words = text.lower()
        bow = re.search(r"\bbow", words)
        wave = re.search(r"\bwav", words)
        assert bow and wave, text
        if " after " in f" {words}" and "after that" not in words and "after which" not in words:
            in_front = words.startswith("after")
            assert (bow.start() < wave.start()) == in_front, text
        else:
            assert bow.start() < wave.start(), text
        checked += 1
    assert checked == 60


def test_mirror_swaps_sides_and_keeps_case():
    assert mirror_caption("Left, then the RIGHT hand.") == "Right, then the LEFT hand."
    assert mirror_caption("circles clockwise") == "circles counterclockwise"
    assert mirror_caption("a bright, upright person leaves") == "a bright, upright person leaves"


@pytest.mark.parametrize(
    ("verb", "forms"),
    [
        ("wave", ("waves", "wave", "waving", "wave")),
        ("push", ("pushes", "push", "pushing", "push")),
        ("carry", ("carries", "carry", "carrying", "carry")),
        ("pat", ("pats", "pat", "patting", "pat")),
        ("is", ("is", "are", "being", "be")),
        ("high-five", ("high-fives", "high-five", "high-fiving", "high-five")),
        ("flee", ("flees", "flee", "fleeing", "flee")),
    ],
)
def test_verbs_agree(verb, forms):
    assert tuple(conjugate(verb, form) for form in ("s", "plural", "ing", "inf")) == forms


def test_same_seed_same_captions():
    first, second = (Phrasebook("hug").sample(np.random.default_rng(7), {}, 12) for _ in range(2))
    assert first == second and len(set(first)) == 12


def test_alternatives_expand_fully():
    assert expand("*step (back|away( fast|))") == ("*step back", "*step away fast", "*step away")


def test_every_action_makes_an_ordered_pair():
    rng = np.random.default_rng(4)
    for act_a in ACTIONS:
        for act_b in ("idle", "wave"):
            assert len(Phrasebook("ordered").sample(rng, {"act_a": act_a, "act_b": act_b}, 4)) == 4


def test_unknown_names_say_what_exists():
    with pytest.raises(KeyError, match="handshake"):
        Phrasebook("hand-shake")
    with pytest.raises(KeyError, match="side_a"):
        Phrasebook("hug").sample(np.random.default_rng(0), {"hand": "left"})
