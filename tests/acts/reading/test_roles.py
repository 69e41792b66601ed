"""Who and what the words of a clause mean: pronouns, parts of the body, pretence, and what only stresses a word."""

from __future__ import annotations

import pytest

from acts import Act, lexicon, read
from tests.acts.reading.reading import said


def last(text: str) -> Act:
    return read(text).acts[-1]


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("Walk towards each other as if to embrace.", {"modality": "pretended"}),
        ("He acts like he's gonna throw the ball.", {"modality": "pretended"}),
        ("They carry a sofa and put it down.", {"thing": "sofa"}),
        ("A touches B's shoulder and then touches his own shoulder.", {"part_of": "a"}),
        ("Boxer one jabs twice, boxer two ducks.", {"act": "duck", "agents": ("b",)}),
        ("a sneaks up on b and b turns to a", {"agents": ("b",), "patient": "a"}),
        ("A twirls under B's raised left arm.", {"act": "be-twirled", "patient": "b"}),
        ("She hits the man two times.", {"patient": "b", "times": 2}),
        ("They push each other, but neither gives way.", {"agents": ("a", "b"), "polarity": "not"}),
        ("She stops him from falling.", {"act": "fall-down", "agents": ("b",), "polarity": "not"}),
        ("He waves to the patient, who is lying down.", {"already": True}),
        ("a person is walking with a purse on their left arm.", {"side": None}),
        ("a person hops on the left foot.", {"side": "left"}),
        ("a person walks a few steps forward.", {"times": 3, "distance": pytest.approx(2.1)}),
        ("a person jogs 2 steps to the right.", {"times": None, "distance": pytest.approx(1.4)}),
        (
            "One person taps the other on the back four times with the left hand.",
            {"part": "back", "part_of": "b", "times": 4, "side": "left"},
        ),
        ("A walks around the chair and taps B on the shoulder.", {"act": "pat", "agents": ("a",), "patient": "b"}),
        ("A drops the book and kicks B.", {"act": "kick", "agents": ("a",), "patient": "b"}),
        ("The physio holds the ankle of the patient and bends the knee.", {"act": "touch", "patient": "b"}),
        ("She holds the ankle of the patient and raises a hand.", {"act": "raise-arm"}),
        ("B does push-ups beside him.", {"act": "push-ups", "times": None}),
        ("He does ten sit-ups.", {"act": "sit-ups", "times": 10}),
        ("She coaxes him to sit down.", {"act": "sit-down", "agents": ("b",)}),
        # a number of things is not how often
        ("He juggles three balls.", {"thing": "ball", "times": None}),
        ("They carry two chairs.", {"thing": "chair", "times": None}),
        ("He nods three times slowly.", {"times": 3}),
        ("They turn three times clockwise.", {"times": 3}),
        ("They circle each other twice clockwise.", {"times": 2}),
    ],
)
def test_the_last_act_is_what_the_words_say(text: str, fields: dict[str, object]) -> None:
    act = last(text)
    assert {name: getattr(act, name) for name in fields} == fields


@pytest.mark.parametrize(("names", "sexes"), [("Anna waves at Ben.", "fm"), ("Kate and Jonas bow.", "fm")])
def test_a_usual_name_tells_the_sex(names: str, sexes: str) -> None:
    assert "".join(person.sex for person in read(names).people) == sexes


def test_who_does_not_flinch_stands_still() -> None:
    for name in ("move-about", "flinch"):
        assert [shape.do for shape in lexicon().entries[name].refused] == ["stay"]
    assert (last("He does not react.").act, last("He does not budge.").act) == ("flinch", "move-about")


def test_what_is_done_instead_is_all_that_is_done() -> None:
    shaken, bowed = read("Rather than shake hands, they bow.").acts
    assert (shaken.polarity, bowed.polarity) == ("not", "done")


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A hugs B and he waves", ["a hug b", "a wave b"]),
        ("A hugs B and they wave", ["a hug b", "ab wave"]),
        ("A woman hugs a man and he waves", ["a hug b", "b wave a"]),
        ("A pushes B and he falls", ["a push b", "b fall-down"]),
        ("A and B hug and he waves", ["ab hug", "a wave b"]),
        # paths, and one's own limbs
        ("A walks a circle around B.", ["a walk-around b"]),
        ("Both raise the right arm in unison.", ["ab raise-arm"]),
        ("They jump in sync.", ["ab jump"]),
        # whose participle stands behind a comma, and what is gone after in order to do something
        ("One talks while the other waits, tapping a foot.", ["a talk", "b stand-still", "b tap-foot"]),
        ("He listens to a client who sits there, wringing her hands.", ["a listen b", "b sit-down", "b rub-hands"]),
        ("B holds the lunge.", ["b lunge"]),
        ("She salutes and holds it for two seconds.", ["a salute b", "a salute b"]),
        ("She hurries after her to apologize.", ["a follow b", "a beg b"]),
        ("She asks him for a dance.", ["a tell b", "a dance b (wished)"]),
        ("She stands up for her brother.", ["a shield b"]),
        ("She signals for him to leave.", ["a tell b", "b walk-away a (wished)"]),
        ("A man walks with a swagger.", ["a walk-ahead"]),
        ("They lift their left leg in canon.", ["a raise-leg", "b raise-leg"]),
        ("They touch palms.", ["ab push-palms"]),
        ("They pat each other on the back.", ["a pat b", "b pat a"]),
        ("She sits down next to him.", ["a join-side b", "a sit-down b"]),
        # a headline is done by both
        ("push-ups", ["ab push-ups"]),
        ("A woman and a woman dance.", ["ab dance"]),
        # nothing slows, and somebody shakes hands
        ("He does slow arm circles.", ["a circle-arms"]),
        # a verb without its person is done to the other
        ("One pushes and the other falls.", ["a push b", "b fall-down"]),
        ("B feints a stab with the dagger.", ["b stab a (pretended)"]),
        ("He dares to hope.", []),
        ("Romeo kneels before Juliet and kisses her hand.", ["a kneel b", "a kiss-hand b"]),
        ("she drops her keys he picks them up", ["a let-go", "b pick-up-thing a"]),
        # another acts in the clause behind a participle, or behind one that needs no pronoun to go on
        ("Two kids playing tag, one falls down and the other laughs.", ["ab tag", "a fall-down", "b laugh"]),
        ("One person holding a ball, the other claps.", ["a hold-thing", "b clap a"]),
        ("One claps while the other one counts on her fingers.", ["a clap b", "b gesture-about a"]),
        ("A thief runs away, she chases him.", ["a run-away b", "b chase a"]),
        ("One jumps, the other squats.", ["a jump", "b crouch"]),
        ("There are two people dancing, one falls.", ["ab dance", "a fall-down"]),
        # who helps is not the one who is helped
        ("A falls and B helps him get up.", ["a fall-down", "b help-up a"]),
        ("A bows and B makes him laugh.", ["a bow", "a laugh"]),
        # a word that belongs to the verb before it, what is done to do something else, and how somebody is found
        ("The loser stomps away sulking.", ["a storm-off b", "a sulk"]),
        ("A jumps to catch the ball.", ["a jump", "a catch-thing"]),
        ("A waves to a seated man.", ["a wave b", "b sit-down"]),
    ],
)
def test_who_does_what_to_whom(text: str, acts: list[str]) -> None:
    assert said(text) == acts
