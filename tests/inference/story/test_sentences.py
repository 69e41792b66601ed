"""Sentences and stories as beats: what goes on at once shares one, what follows has one of its own."""

from __future__ import annotations

import pytest

from acts import read
from acts.staging.stage import score_of
from motion import InputError
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.story import SceneRequest, split_sentence
from webdemo.inference.story.beats import plan_of_beat
from webdemo.inference.story.sentences import MOST_WORDS, as_scene, beats_of

ONE = [
    "Two people hug.",
    "Person A waves as she walks away and person B follows.",
    "walks away and waves back over the shoulder",
    "A points at B and laughs.",
    "One person is dancing and the other is clapping along.",
]
SEVERAL = [
    ("Person A bows and then walks to person B. Finally both wave.", ["bow", "walk-up", "wave"]),
    ("They hug before they walk away", ["hug", "walk-away"]),
    ("After a quick high five they run off.", ["high-five", "run-away"]),
    ("A stands up and leaves, B stays.", ["stand-up", "walk-away stand-still"]),
    ("Person one raises both hands and person two copies it.", ["raise-arm", "raise-arm"]),
    ("Tom is sitting. Anna walks up to him and sits down.", ["sit-down walk-up", "sit-down"]),
    ("He picks her up and spins her around. They bow.", ["lift-up twirl", "bow"]),
    ("A looks at the window. Then they hug.", ["look-at-thing", "hug"]),
    ("A sits on the chair until B taps A, then A gets up.", ["sit-down pat", "stand-up"]),
    ("He drops to one knee and proposes, and she nods.", ["kneel propose", "nod"]),
    ("A pushes B over, B falls down, then A helps B up.", ["push-over fall-down", "help-up"]),
    ("A bends down and pats B's head.", ["bend-down", "pat"]),
]
TOGETHER = [
    ("He covers his eyes until she has run off.", ["cover-face run-away"]),
    ("A sits on a chair while B stands behind and cuts A's hair.", ["sit-down stand-behind groom"]),
]


@pytest.mark.parametrize("sentence", ONE)
def test_what_goes_on_at_once_is_one_beat_in_its_own_words(sentence: str) -> None:
    (beat,) = split_sentence(sentence)
    assert beat.words == sentence and not beat.acts


@pytest.mark.parametrize(("sentence", "beats"), SEVERAL)
def test_what_follows_something_else_is_a_beat_of_its_own(sentence: str, beats: list[str]) -> None:
    split = split_sentence(sentence)
    assert [" ".join(act.act for act in beat.acts) for beat in split] == beats
    assert all(beat.words for beat in split), "the network has words to read"


@pytest.mark.parametrize(("sentence", "beats"), TOGETHER)
def test_acts_share_a_beat_as_they_are_told(sentence: str, beats: list[str]) -> None:
    assert [" ".join(act.act for act in beat.acts) for beat in beats_of(read(sentence))] == beats


def test_a_sentence_that_is_not_understood_keeps_its_words_and_its_place() -> None:
    first, second, third = split_sentence("They bow. They flurble gravely. They hug.")
    assert (first.acts[0].act, second.words, third.acts[0].act) == ("bow", "They flurble gravely.", "hug")
    assert not plan_of_beat(second).acts
    assert split_sentence("They hug. Then, he waves.")[1].words == "He waves."


def test_speech_and_remarks_are_no_acts() -> None:
    (beat,) = split_sentence('"Follow me!" She bows (he likes that).')
    score = score_of(plan_of_beat(beat).acts)
    assert score.figures["a"].figure == "bows" and not score.moves


def test_stories_longer_than_any_scene_are_refused_before_they_are_read() -> None:
    with pytest.raises(InputError, match=r"The story has [\d,]+ characters: shorten it to 30,000"):
        split_sentence("A waves. " * (MOST_WORDS // 9 + 2))
    with pytest.raises(InputError, match="more than 60 beats"):
        split_sentence("A bows. Then A jumps. " * 31)


def test_who_sits_in_a_chair_sits_from_the_start() -> None:
    score = score_of(read("Dad reads the paper in his armchair while the baby crawls about.").acts)
    assert score.changes["a"][0].already


def test_who_turns_round_at_a_tap_was_tapped_from_behind() -> None:
    beats = beats_of(read("She taps him on the shoulder, he turns around, and she gives him a letter."))
    first, second, _ = SceneRequest(beats=beats).scores
    assert first.touch is not None and first.touch.behind
    assert ("b", "face") in [(move.person, move.way) for move in second.moves]
    assert not (alone := SceneRequest(beats=beats[:1]).scores[0].touch) or not alone.behind


def test_who_bends_down_to_a_shoe_kneels_down_to_it_at_once() -> None:
    (beat,) = beats_of(read("A bends down and ties B's shoe."))
    score = score_of(beat.acts)
    assert score.touch is not None and not score.touch.late
    assert not score.changes, "a bow on the spot comes before the shoe"
    (alone,) = beats_of(read("A bends down."))
    assert [change.posture for change in score_of(alone.acts).changes["a"]] == ["bends down"]


@pytest.mark.parametrize(
    "text",
    [
        "They walk up to each other but do not kiss.",
        "They bow. They walk up to each other but do not kiss.",
        "She does not want to be kissed and pushes him away.",
    ],
)
def test_the_network_is_not_told_what_is_not_done(text: str) -> None:
    scene = as_scene(GenerateRequest(prompt=text, seconds=8.0))
    assert scene is not None and all("kiss" not in beat.sentence for beat in scene.beats)
    done = as_scene(GenerateRequest(prompt="They walk up to each other and kiss.", seconds=8.0))
    assert done is not None and any("kiss" in beat.sentence for beat in done.beats)


def test_an_act_that_the_network_makes_of_words_alone_has_those_that_it_knows() -> None:
    bumps, waves = (
        as_scene(GenerateRequest(prompt=text, seconds=6.0)) for text in ("Two kids bump fists.", "A kid waves.")
    )
    assert bumps is not None and waves is not None
    assert bumps.beats[0].sentence == "They fist-bump each other."
    assert waves.beats[0].sentence == "A kid waves."
