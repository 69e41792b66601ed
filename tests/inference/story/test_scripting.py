"""The beats of plans: what goes on at once shares one, what follows something else has one of its own."""

from __future__ import annotations

import pytest

from acts import read
from acts.staging.stage import staged
from acts.staging.ways import Way
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.story.prompted import as_scene
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.story.scripting import beats_of

BEATS = [
    ("walks away and waves back over the shoulder", ["walk-away wave"]),
    ("A points at B and laughs.", ["point laugh"]),
    ("One person is dancing and the other is clapping along.", ["dance clap"]),
    ("They hug before they walk away", ["hug", "walk-away"]),
    ("After a quick high five they run off.", ["high-five", "run-away"]),
    ("The two hug goodbye, and he leaves while she stays.", ["hug", "walk-away stand-still"]),
    ("A stands up and leaves, B stays.", ["stand-up", "walk-away stand-still"]),
    ("Person one raises both hands and person two copies it.", ["raise-arm", "raise-arm"]),
    ("Tom is sitting. Anna walks up to him and sits down.", ["sit-down walk-up", "sit-down"]),
    ("They walk up to each other, shake hands and part again.", ["walk-up shake-hands", "part"]),
    ("He picks her up and spins her around. They bow.", ["lift-up twirl", "bow"]),
    ("A sits on the chair until B taps A, then A gets up.", ["sit-down pat", "stand-up"]),
    ("He covers his eyes until she has run off.", ["cover-face run-away"]),
    ("He drops to one knee and proposes, and she nods.", ["kneel propose", "nod"]),
    ("A pushes B over, B falls down, then A helps B up.", ["push-over fall-down", "help-up"]),
    ("A sits on a chair while B stands behind and cuts A's hair.", ["sit-down stand-behind groom"]),
    ("A bends down and ties B's shoe.", ["bend-down tie-other-shoes"]),
    ("A bends down and pats B's head.", ["bend-down", "pat"]),
]


@pytest.mark.parametrize(("sentence", "beats"), BEATS)
def test_acts_share_a_beat_as_they_are_told(sentence: str, beats: list[str]) -> None:
    assert [" ".join(act.act for act in beat.acts) for beat in beats_of(read(sentence))] == beats


def test_speech_and_remarks_are_no_acts() -> None:
    plan = read('"Follow me!" She bows (he likes that).')
    assert [act.act for act in plan.acts] == ["bow"]


def test_who_gives_what_somebody_gets_does_it() -> None:
    (act,) = read("He gets a shoulder massage from her.").acts
    assert (act.act, act.agents, act.patient) == ("massage", ("b",), "a")


def test_people_sit_side_by_side_where_they_are_said_to() -> None:
    told = staged(read("Two strangers sit next to each other on a park bench.").acts)
    assert told.keeps_place and told.placed is not None and set(told.changes) == {"a", "b"}


def test_who_sits_in_a_chair_sits_from_the_start() -> None:
    told = staged(read("Dad reads the paper in his armchair while the baby crawls about.").acts)
    assert told.changes["a"][0].already


def test_a_lifted_person_is_turned_round_with_the_carrier() -> None:
    lifted = staged(read("He picks her up and spins her around.").acts).lift
    assert lifted is not None and lifted.spins


def test_who_kneels_to_tie_a_shoe_kneels() -> None:
    told = staged(read("A kneels down to tie his shoe while B waits.").acts)
    assert set(told.changes) == {"a"} and not told.limbs


def test_who_keeps_their_back_turned_stands_so() -> None:
    told = staged(read("She keeps her back turned to him while he is talking to her.").acts)
    assert [(move.person, move.way) for move in told.moves] == [("a", Way.AVERTED), ("b", Way.STAY)]


def test_a_simile_is_nothing_that_is_used() -> None:
    acts = read("Dancer 1 spins like a top while dancer 2 crouches low.").acts
    assert [(act.act, act.agents) for act in acts] == [("spin", ("a",)), ("crouch", ("b",))]


def test_who_lies_down_beside_the_other_begins_there() -> None:
    told = staged(read("He stretches out on the grass beside her.").acts)
    assert told.keeps_place and set(told.changes) == {"a"}


def test_who_turns_round_at_a_tap_was_tapped_from_behind() -> None:
    beats = beats_of(read("She taps him on the shoulder, he turns around, and she gives him a letter."))
    first, second, _ = SceneRequest(beats=beats).told
    assert first.contact is not None and first.contact.behind
    assert ("b", Way.FACE) in [(move.person, move.way) for move in second.moves]
    assert not (alone := SceneRequest(beats=beats[:1]).told[0].contact) or not alone.behind


def test_who_jumps_on_the_others_back_runs_up_from_behind() -> None:
    placed = staged(read("A runs up and jumps onto B's back.").acts).placed
    assert placed is not None and placed.places[0, 1] < placed.places[1, 1] - 1.0


def test_who_bends_down_to_a_shoe_kneels_down_to_it_at_once() -> None:
    (beat,) = beats_of(read("A bends down and ties B's shoe."))
    told = staged(beat.acts)
    assert told.contact is not None and not told.contact.late
    assert not told.changes, "a bow on the spot comes before the shoe"
    (alone,) = beats_of(read("A bends down."))
    assert [change.posture.value for change in staged(alone.acts).changes["a"]] == ["bends down"]


@pytest.mark.parametrize(
    "text", ["They walk up to each other but do not kiss.", "They bow. They walk up to each other but do not kiss."]
)
def test_the_network_is_not_told_what_is_not_done(text: str) -> None:
    scene = as_scene(GenerateRequest(prompt=text, seconds=8.0))
    assert scene is not None and all("kiss" not in beat.sentence for beat in scene.beats)
    done = as_scene(GenerateRequest(prompt="They walk up to each other and kiss.", seconds=8.0))
    assert done is not None and any("kiss" in beat.sentence for beat in done.beats)
