"""Everyday phrases in plain words, and the past in the present."""

from __future__ import annotations

import re
import tomllib

import pytest

from webdemo.inference.story.clauses import clauses
from webdemo.inference.story.ways import Way, way_of
from webdemo.inference.story.wording import (
    PHRASEBOOK,
    in_plain_words,
    in_present,
    participle,
    past,
    singular,
)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("person a legs it", "person a runs away"),
        ("they leg it", "they run away"),
        ("she hit out at him", "she punches him"),
        ("they hit out at him", "they punch him"),
        ("they duke it out", "they fight"),
        ("he gave her a piggyback ride", "he carries her on his back"),
        ("legging it", "running away"),
        ("the thief bolted and the cop gave chase", "the thief runs away and the cop chases the other"),
        ("she gives him the cold shoulder", "she turns around"),
        ("tom made a beeline for the waiter", "tom walks up to the waiter"),
        ("he plonks himself down on a chair", "he sits down on a chair"),
        ("he was knocked out", "he falls down"),
        ("a salesman trails after her but she goes on", "a salesman follows her but she goes on"),
        ("she leaves him standing there", "she walks away"),
        # the same words for something else
        ("he drops the ball", "he drops the ball"),
        ("they turn up the music", "they turn up the music"),
        ("he leaves her hand", "he leaves her hand"),
        ("she moves over to him", "she moves over to him"),
        ("person a scoots over to person b", "person a scoots over to person b"),
        ("she moves over to the side", "she steps aside to the side"),
        ("person a stands by person b", "person a stands by person b"),
        ("she leaves her seat", "she leaves her seat"),
        ("he splits the wood", "he splits the wood"),
    ],
)
def test_phrases_become_plain_words(text: str, plain: str) -> None:
    assert in_plain_words(text) == plain


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        ("went away", "goes away"), ("walked off", "walks off"), ("hugged him", "hugs him"),
        ("hurried over", "hurries over"), ("chased her", "chases her"), ("passed by", "passes by"),
        ("pulled her up", "pulls her up"), ("sat down", "sits down"), ("approached", "approaches"),
        ("seated on a chair", "seated on a chair"), ("walks", "walks"), ("red in the face", "red in the face"),
    ],
)  # fmt: skip
def test_the_past_becomes_the_present(said: str, plain: str) -> None:
    assert in_present(said) == plain


def test_verbs_are_inflected() -> None:
    assert [singular(verb) for verb in ("go", "push", "hurry", "stay", "be")] == [
        "goes", "pushes", "hurries", "stays", "is"
    ]  # fmt: skip
    assert [participle(verb) for verb in ("run", "lie", "make", "flee", "turn")] == [
        "running", "lying", "making", "fleeing", "turning"
    ]  # fmt: skip
    assert past("hop") == ("hopped",) and past("carry") == ("carried",) and past("flee") == ("fled",)


def test_every_phrase_is_found_once_and_in_plain_words() -> None:
    book = tomllib.loads(PHRASEBOOK.read_text(encoding="utf-8"))
    phrases = [phrase for listed in book.values() for phrase in listed]
    assert len(phrases) == len(set(phrases)) > 400
    names = {"o": "him", "os": "his", "his": "his", "he": "he", "self": "himself"}
    for plain, listed in book.items():
        for phrase in listed:
            verb, _, rest = re.sub(r"{(\w+)}", lambda m: names[m[1]], phrase).partition(" ")
            said = f"he {singular(verb)} {rest}".strip()
            wanted = plain.replace("{o}", "him" if "{o}" in phrase else "the other")
            start, _, end = wanted.partition(" ")
            assert in_plain_words(said) == f"he {singular(start)} {end}".strip(), phrase


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("A pushy salesman follows her.", "a:follows her"),
        ("The rich lady on the bench ignores him.", "a:on the bench stands still"),
        ("Player walks up, npc waves.", "a:walks up b:waves"),
        ("Dancer 2 jumps while dancer 1 bows.", "b:jumps a:bows"),
        ("Worn out, he sits down; his wife stays on her feet.", "a:sits down b:stays on her feet"),
        ("Mommy is sitting and I jump.", "a:is sitting b:jump"),
        ("(beat) Joe kneels. Ana walks away.", "a:kneels b:walks away"),
        ("After the match the players come together.", "ab:come together"),
        ("The referee's right arm goes up.", "a:raises his right arm"),
        ("The man went home and the woman stayed.", "a:goes home b:stays"),
        ("A is on the floor. B backs off.", "a:is on the floor b:backs off"),
        ("Karate kid kicks, the other guy falls.", "a:kicks b:falls"),
        ("Person A bows and after a short moment he walks off.", "a:bows a:walks off"),
        ("He reads until Max finally arrives.", "a:reads b:walks up to the other"),
    ],
)
def test_who_does_something_is_found(sentence: str, found: str) -> None:
    assert " ".join(f"{clause.who}:{clause.words}" for clause in clauses(sentence)) == found


def test_moves_are_read_from_phrases() -> None:
    for sentence, person, way in (
        ("She legs it.", "a", Way.AWAY),
        ("Both did a runner.", "ab", Way.AWAY),
        ("He whips round.", "a", Way.TURN),
    ):
        (clause,) = clauses(sentence)
        assert clause.who == person and way_of(clause.words) is way
