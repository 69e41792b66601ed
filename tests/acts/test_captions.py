from __future__ import annotations

from typing import Any

import pytest

from acts import Act, lexicon, read
from acts.captions import beats, gerund, short, singular


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("He pats her on the back, then she leaves.", ["Person A pats person B on the back.", "Person B walks away."]),
        ("They hug.", ["They hug each other."]),
        ("He tries to hug her.", ["Person A stands still."]),
        ("She bows twice.", ["Person A bows twice."]),
        ("She raises both feet.", ["Person A lifts both feet."]),
        ("Then she bows.", ["Person A bows."]),
        ("Finally, they hug.", ["They hug each other."]),
        ("A man waves.", ["Person A waves."]),
        ("He slaps her with the left hand.", ["Person A slaps person B with the left hand."]),
        ("She kicks him with the left foot.", ["Person A kicks person B with the left foot."]),
        ("He turns to the left.", ["Person A turns around."]),
        ("Nothing.", []),
    ],
)
def test_a_plan_in_plain_words(text: str, said: list[str]) -> None:
    assert beats(read(text), lexicon()) == said


def test_third_persons_of_verbs() -> None:
    verbs = ["pass", "carry", "play", "be", "have", "go"]
    assert [singular(verb) for verb in verbs] == ["passes", "carries", "plays", "is", "has", "goes"]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"act": "pat", "patient": "b", "part": "shoulder", "side": "right", "times": 2}, "pats on right shoulder ×2"),
        ({"act": "walk-up", "patient": "b", "direction": "up"}, "walks up"),
        ({"act": "skip"}, "skips"),
        ({"act": "skip", "patient": "b"}, "skips past"),
        ({"act": "curtsy"}, "curtsies"),  # not the caption's "bows"
        ({"act": "raise-leg", "part": "leg", "side": "left"}, "lifts left leg"),
        ({"act": "raise-leg"}, "raises leg"),
        ({"act": "be-twirled", "patient": "b"}, "turns under arm"),  # its chip
        ({"act": "lift-spin", "patient": "b"}, "picks up and spins around"),
        ({"act": "put-down-thing", "thing": "cup"}, "puts down cup"),
        ({"act": "open-thing", "thing": "window"}, "opens window"),  # not the caption's door
        ({"act": "hug", "agents": ("a", "b")}, "hug each other"),
        ({"act": "face-other", "agents": ("a", "b")}, "face each other"),
        ({"act": "cover-eyes", "agents": ("a", "b")}, "cover each other's eyes"),
        ({"act": "stagger", "agents": ("a", "b")}, "stagger"),
        ({"act": "stand-close", "patient": "b"}, "stands close, face to face"),
        ({"act": "take-from", "patient": "b", "thing": "box"}, "takes box"),  # not the caption's book
        ({"act": "step-aside", "side": "left", "direction": "right", "times": 2}, "steps aside to the right ×2"),
        ({"act": "hug", "patient": "b", "modality": "tried"}, "tries to hug"),
        ({"act": "wave", "polarity": "not", "side": "left"}, "does not wave with left hand"),
        ({"act": "shake-hands", "agents": ("a", "b"), "polarity": "not"}, "do not shake hands"),
        ({"act": "turn-around", "side": "left", "manner": ("slowly",)}, "turns around to the left slowly"),
        ({"act": "of-a-lab"}, "of a lab"),
    ],
)
def test_an_act_in_a_few_words(fields: dict[str, Any], said: str) -> None:
    act = Act(**{"id": "1", "agents": ("a",), **fields})
    assert short(act, lexicon().entries.get(act.act)) == said


def test_every_act_has_few_words_without_slots() -> None:
    for name, entry in lexicon().entries.items():
        for patient in (None, "b"):
            words = short(Act(id="1", act=name, agents=("a",), patient=patient), entry)
            assert words.strip() == words and 0 < len(words) <= 60, name
            assert not set("{}[]*'") & set(words), name


@pytest.mark.parametrize(
    ("verb", "form"), [("lie", "lying"), ("tie", "tying"), ("hug", "hugging"), ("wave", "waving"), ("be", "being")]
)
def test_verbs_have_their_ing_form(verb: str, form: str) -> None:
    assert gerund(verb) == form
