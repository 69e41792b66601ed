"""Acts of a plan in the terms of the stage: what each entry's shapes become, and who stands by."""

from __future__ import annotations

import numpy as np
import pytest

from acts import lexicon, read
from acts.plan import Act, Plan, Relation
from acts.shapes import Figure
from acts.staging.score import Score, at_start
from acts.staging.stage import score_of, scores_of
from motion import InputError
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.story.beats import Beat, acts_of
from webdemo.inference.story.request import SceneRequest, beat_of
from webdemo.inference.story.sentences import as_scene, beats_of
from webdemo.inference.story.toml import read_story

from .staged_words import beginning, figures


def score(text: str) -> Score:
    plan = read(text)
    assert plan.acts and not plan.unread
    return score_of(plan.acts)


def test_shapes_of_several_acts_make_one_beat() -> None:
    both = score("Person A waves while person B sits down.")
    assert both.gestures["a"].gesture == "waves" and both.changes["b"][0].posture == "sits"
    assert not both.idle and not score("They sit facing each other.").going
    assert score("Person A salutes.").idle == {"b"}, "who does nothing beside a gesture stands by"
    assert not score("Person A hugs person B.").idle
    assert not score("He chases her until she stops.").idle, "who is followed until they stop goes first"


@pytest.mark.parametrize("text", ["A drinks.", "B sips her tea.", "He eats an apple."])
def test_who_drinks_or_eats_has_a_hand_at_the_mouth(text: str) -> None:
    (gesture,) = score(text).gestures.values()
    assert gesture.gesture == ("eats" if "eats" in text else "mouth")


def test_a_throw_and_its_catch_are_one_beat_of_throws() -> None:
    (beat,) = beats_of(read("A throws the ball and B catches it."))
    stage = score_of(beat.acts)
    assert stage.strike is not None and stage.strike.turns == "a" and not stage.gestures
    there_and_back = beats_of(read("A throws a ball to B, B catches it and throws it back."))
    assert [[act.act for act in beat.acts] for beat in there_and_back] == [
        ["throw-ball", "catch-thing"],
        ["throw-ball"],
    ]


def test_who_refuses_leaves_the_other_with_a_hand_held_out() -> None:
    refused = score_of((Act(id="1", act="shake-hands", agents=("b",), patient="a", polarity="not"),))
    assert refused.gestures["a"].gesture == "offers" and "b" in refused.idle


@pytest.mark.parametrize(("name", "hand"), [("shake-hands", "offers"), ("hug", "ahead"), ("high-five", "up")])
def test_who_would_like_to_touch_reaches_out_in_vain(name: str, hand: str) -> None:
    wished = score_of((Act(id="1", act=name, agents=("a",), patient="b", modality="wished"),))
    assert set(wished.gestures) == {"a"} and wished.gestures["a"].gesture == hand
    both = score_of((Act(id="1", act=name, agents=("a", "b"), modality="wished"),))
    assert not both.gestures


def test_a_gesture_beside_the_posture_of_the_other_is_given() -> None:
    assert "b" in score("A kneels and B raises one arm.").gesturing
    assert "b" in score("While A kneels, B stands there and raises one arm.").gesturing
    assert "b" in score("B raises one arm.").gesturing


def test_who_glides_backwards_goes_backwards_and_may_lead_with_a_hand_raised() -> None:
    back = score("Person A glides backwards.")
    assert [move.way for move in back.moves if move.person == "a"] == ["back"]
    led = score("A walks backwards and leads B with one raised hand.")
    assert led.gestures["a"].gesture == "up" and not led.by_both_hands


def test_nobody_waits_for_somebody_who_does_not_move() -> None:
    around = score("B does not move at all, and A walks once around B.")
    assert [(m.way, m.late) for m in around.moves if m.person == "a"] == [("around", False)]


def test_who_pulls_the_other_up_comes_to_them_first() -> None:
    pulled = score("Person B pulls person A to his feet.")
    assert pulled.pulls == "b" and [m.person for m in pulled.moves if m.way == "to"] == ["b"]
    assert pulled.changes["a"][-1].after > 0.3


def test_who_stands_over_the_other_begins_near_them() -> None:
    placed = beginning("A kneels and B stands over her.")
    assert placed is not None and placed.gap() < 1.0
    assert beginning("A kneels and B stands still.") is None


def test_hands_that_are_tied_are_behind_the_back() -> None:
    tied = score("The robber ties her hands.")
    assert tied.gestures["b"].gesture == "behind" and tied.touch is not None and tied.touch.behind


def test_a_touch_from_behind_or_of_the_back_is_given_there() -> None:
    for words, behind in (
        ("Person A taps person B on the shoulder from behind.", True),
        ("Person A pats person B on the back.", True),
        ("Person A taps person B on the shoulder.", False),
    ):
        contact = score(words).touch
        assert contact is not None and contact.behind is behind, words


def test_numbers_sides_and_speeds_reach_the_stage() -> None:
    wave = score_of((Act(id="1", act="wave", agents=("a",), side="left"),))
    assert wave.gestures["a"].sides == "left"
    assert score_of((Act(id="1", act="jump", agents=("b",), times=3),)).figures["b"] == Figure(figure="jumps", times=3)
    slow, fast = (score_of((Act(id="1", act="walk-up", agents=("a",), speed=s),)).moves[0].speed for s in (0.6, 1.5))
    assert fast == pytest.approx(2.5 * slow)
    squats = score_of((Act(id="1", act="squats", agents=("a",)),)).changes["a"]
    assert len(squats) == 3 and all(change.passing for change in squats)
    seated = score_of((Act(id="1", act="sit-down", agents=("a",), already=True),)).changes["a"][0]
    assert seated.already and seated.posture == "sits"
    pat = score_of((Act(id="1", act="pat", agents=("a",), patient="b", part="shoulder", times=2),)).touch
    assert pat is not None and (pat.part, pat.times) == ("shoulder", 2)


def test_a_plan_by_hand_is_made_and_not_read() -> None:
    first = Act(id="1", act="walk-up", agents=("b",), patient="a")
    then = Act(id="2", act="waltz", agents=("a", "b"), order=(Relation(kind="after", act="1"),))
    request = GenerateRequest(acts=Plan(acts=(first, then)), seconds=8.0)
    assert request.prompt == "Person B walks up to person A. They waltz with each other."
    scene = as_scene(request)
    assert scene is not None and [beat.acts for beat in scene.beats] == [(first,), (then,)]
    assert [move.way for move in scene.scores[0].moves] == ["to", "stay"]
    assert scene.scores[1].hold == "closed"
    assert GenerateRequest(acts=request.to_dict()["acts"], seconds=8.0) == request, "as JSON"
    beat = scene.beats[0]
    assert beat_of(beat.to_dict()) == beat


@pytest.mark.parametrize("acts", [[{"act": "hug"}], "hug", [3], [{"id": "1", "act": "hug", "agents": ["c"]}]])
def test_what_is_no_act_is_said(acts: object) -> None:
    with pytest.raises(InputError):
        acts_of(acts)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="This is not a plan of acts"):
        GenerateRequest(prompt="They hug.", acts={"acts": acts})  # type: ignore[arg-type]


def test_every_entry_can_be_staged() -> None:
    known = lexicon()
    for name, entry in known.entries.items():
        act = Act(id="1", act=name, agents=("a",), patient="b", part="shoulder")
        found = score_of((act,))
        if {shape.do for shape in entry.stage} & {"go", "posture", "jump", "touch", "gesture"}:
            assert found != Score(alone=found.alone, on_feet=found.on_feet, reaching=found.reaching), name


def test_struck_people_answer_in_the_beat() -> None:
    told_ = score_of(beats_of(read("He punches her and she falls down."))[0].acts)
    assert told_.strike is not None and told_.strike.bout == "fists" and told_.strike.answered
    assert Beat("", acts=(Act(id="1", act="waltz", agents=("a", "b")),)).length == 8.0


def test_who_is_pushed_scared_or_slapped_answers_where_the_words_leave_them_free() -> None:
    pushed = score("A pushes B.")
    assert [(move.person, move.way, move.late) for move in pushed.moves] == [("b", "back", True)]
    assert pushed.touch and pushed.touch.part == "chest" and pushed.reacting == {"b"}
    assert score("A slaps B with the left hand.").gestures["b"].sides == "right", "the cheek that is hit"
    assert not score("A scares B while B waves.").moves, "B is told to do something else"
    seated, scared = scores_of([read("A sits.").acts, read("B scares A.").acts])
    assert at_start([seated, scared], 1)["a"] == "sits" and "a" in scared.gestures


@pytest.mark.parametrize(("text", "way"), [("A points at the door.", "turn"), ("A looks at the door.", "thing")])
def test_who_points_at_a_thing_turns_to_it_and_stays(text: str, way: str) -> None:
    assert [move.way for move in score(text).moves if move.person == "a"] == [way]


def test_acts_of_a_story_are_read() -> None:
    text = """
        [[beat]]
        acts = [{ act = "wave", agents = ["b"] }, { act = "sit-down", agents = ["a"], speed = 0.6 }]
        seconds = 3
    """
    request = SceneRequest(**read_story(text))
    assert request.beats[0].sentence == "Person B waves while person A sits down."
    assert request.scores[0].gestures["b"].gesture == "waves"
    with pytest.raises(InputError, match=r"Line 2: .* agents"):
        read_story('[[beat]]\nacts = [{ act = "wave" }]')
    with pytest.raises(InputError, match="60 at most"):
        read_story("[[beat]]\nacts = [" + '{ act = "wave", agents = ["a"] },' * 61 + "]")


@pytest.mark.parametrize("text", ["A opens the window.", "A turns the hi-fi on.", "A looks out of the window."])
def test_who_does_something_with_a_window_goes_to_it(text: str) -> None:
    stage = score(text)
    assert next((move.person, move.way) for move in stage.moves) == ("a", "thing")
    assert "a" not in stage.idle
    assert stage.alone[0] == "One person turns around and walks away.", "a reach is one to the other"


def test_who_opens_a_present_or_has_walked_goes_nowhere_else() -> None:
    for text in ("A opens a gift.", "A looks at the wall.", "A turns on the lamp."):
        assert all(move.way != "thing" for move in score(text).moves), text
    way, use = (score_of(beat.acts) for beat in beats_of(read("A goes to the window and opens it.")))
    assert [m.way for m in way.moves if m.person == "a"] == ["away"]
    assert [m.way for m in use.moves if m.person == "a"] == ["thing"]


@pytest.mark.parametrize(
    "text", ["A ties B's shoes.", "A combs B's hair.", "A pats B's head.", "A lays a hand on B's shoulder."]
)
def test_who_lets_hands_be_laid_on_them_keeps_still(text: str) -> None:
    assert score(text).idle == {"b"}
    assert score(text.replace("A ", "A pushes B and ", 1)).idle == frozenset()


def test_who_tries_to_kiss_somebody_comes_near_and_leans_in() -> None:
    stage = score("A tries to kiss B and B ducks.")
    assert [(move.person, move.way) for move in stage.moves if move.person == "a"] == [("a", "to")]
    assert [limb.figure for limb in stage.limbs["a"]] == ["leans"]
    assert not score("They bow to each other.").moves


def test_two_who_sit_on_a_bench_sit_on_one() -> None:
    bench = beginning("They sit down on the sofa.")
    assert bench is not None and bench.gap() < 0.8 and np.ptp(bench.headings) == 0
    chairs = beginning("They sit down on chairs.")
    assert chairs is None or np.ptp(chairs.headings) > 3


def test_what_is_done_in_unison_is_no_phrase_of_a_dance() -> None:
    assert figures("They bow in unison.") == dict.fromkeys("ab", ("bows", 1))
    assert score("They move in unison.").figures


def test_two_who_dance_are_a_couple_and_one_alone_or_beside_the_other_is_not() -> None:
    for words in ("They dance.", "A dances with B.", "They dance salsa."):
        assert score(words).hold == "couple" and not score(words).figures
    alone = score("A dances.")
    assert not alone.hold and figures("A dances.") == {"a": ("dances", 0)} and alone.idle == {"b"}
    assert figures("They dance side by side.").keys() == {"a", "b"} and not score("They dance side by side.").hold


def test_who_falls_back_is_caught_by_the_other() -> None:
    touch = score("He falls back into her arms.").touch
    assert touch is not None and touch.person == "b"
