"""The reader's mechanisms on the frames of a few entries; the lexicon's own examples are tests as well."""

from __future__ import annotations

import pytest

from acts import read
from acts.reading.wording import begins_with_subject
from tests.acts.reading.reading import said


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A hugs B.", ["a hug b"]),
        ("A pats B on the back, and then B hugs A.", ["a pat b", "b hug a"]),
        ("They don't hug.", ["ab not hug"]),
        ("Nobody hugs.", ["ab not hug"]),
        ("He can't hug her.", ["a not hug b"]),
        ("She refuses to hug him.", ["a not hug b"]),
        ("He tries to hug her.", ["a hug b (tried)"]),
        ("He almost hugs her.", ["a hug b (tried)"]),
        ("She pretends to hug him.", ["a hug b (pretended)"]),
        ("She pats him without hugging him.", ["a pat b", "a not hug b"]),
        ("The boy is hugged by the girl.", ["b hug a"]),
        ("He gives her a hug.", ["a hug b"]),
        ("He starts hugging her.", ["a hug b"]),
        ("I hug you.", ["a hug b"]),
        ("The first person hugs the second person.", ["a hug b"]),
        ("He huggs her.", ["a hug b"]),
        ("He helps her walk.", ["a support b"]),
        ("grab her by the wrist", ["a hold-hands b"]),
        ("He yawns and stretches.", ["a yawn", "a stretch"]),
        ("Two friends bow and drink.", ["ab bow", "ab drink"]),
        ("Neither of them jumps.", ["ab not jump"]),
        ("He begs on his knees.", ["a beg b", "a kneel"]),
        ("He takes her hand and kisses it.", ["a hold-hands b", "a kiss-hand b"]),
        ("A stranger bumps into a boy who pushes him.", ["a bump-into b", "b push a"]),
        ("The man in the hat waves.", ["a wave b"]),
        ("Three people form a circle and join hands.", []),
        ("A waves with the right hand and B with the left hand.", ["a wave b", "b wave a"]),
        ("A and B take turns to jump.", ["a jump", "b jump"]),
        ("He hugs and kisses her.", ["a hug b", "a kiss b"]),
        # how a part of the body is held beside an act
        ("A squats while B waits with arms crossed.", ["a crouch", "b stand-still", "b fold-arms"]),
        ("They circle each other, hands up.", ["ab circle-together", "ab raise-arm"]),
        ("A pushes B with both palms on the chest.", ["a push b"]),
        # formations
        ("Both start face to face and end back to back.", ["ab face-other", "ab back-to-back"]),
        ("In canon, both bow.", ["a bow", "b bow"]),
        ("They never touch, always two metres apart.", ["ab not touch", "ab keep-distance"]),
        # acts that are nouns
        ("He answers with a bow.", ["a bow"]),
        ("She pulls him into a hug.", ["a hug b"]),
        ("He shivers in surprise.", ["a shiver"]),
        ("She offers him a drink and he waves it off.", ["a offer-thing b", "b wave-off a"]),
        # people and pronouns
        ("One person extends a hand and the other person shakes it.", ["a offer-thing b", "b shake-hands a"]),
        # verbs that share what stands once
        ("The dancer is dipped by her partner and then spun out.", ["b dip a", "b twirl a"]),
        ("The first person is frozen on one leg.", ["a freeze", "a stand-on-one-leg"]),
        ("She pats him, but does not hug.", ["a pat b", "a not hug b"]),
        (
            "One person walks up behind the other and covers his eyes with both hands.",
            ["a come-behind b", "a cover-eyes b"],
        ),
        ("They stand face to face, hands on each other's shoulders.", ["ab face-other", "ab hand-on"]),
        ("show me two robots dancing", ["ab dance"]),
        ("They meet, hug and part.", ["ab walk-up", "ab hug", "ab part"]),
    ],
)
def test_who_does_what_to_whom(text: str, acts: list[str]) -> None:
    assert said(text) == acts


@pytest.mark.parametrize(
    ("text", "beats"),
    [
        ("She pats him, then he hugs her.", [["1"], ["2"]]),
        ("She pats him while he hugs her.", [["1", "2"]]),
        ("Before he hugs her, she pats him.", [["2"], ["1"]]),
        ("After she pats him, he hugs her.", [["1"], ["2"]]),
        ("When she pats him, he hugs her.", [["1"], ["2"]]),
        ("She pats him. He hugs her.", [["1"], ["2"]]),
        ("She pats him before he hugs her.", [["1"], ["2"]]),
        ("She bows, then he waits.", [["1"], ["2"]]),
        ("She bows; he waves.", [["1"], ["2"]]),
        ("She throws a ball and he ducks.", [["1"], ["2"]]),
        ("She knocks at the door and he opens it.", [["1"], ["2"]]),
        ("A kicks the ball to B, who stops it.", [["1"], ["2"]]),
        ("A goes to the window and opens it.", [["1"], ["2"]]),
        ("A walks away and waves.", [["1", "2"]]),
        ("She bows. He waits.", [["1", "2"]]),
        ("She bows while he waits, and then she pats him.", [["1", "2"], ["3"]]),
        ("She bows while he waits. Then he waits while she leaves.", [["1", "2"], ["3", "4"]]),
    ],
)
def test_order(text: str, beats: list[list[str]]) -> None:
    assert [[act.id for act in group] for group in read(text).beats()] == beats


def test_what_is_about_others_or_means_nothing_stays_unread() -> None:
    for text in ("The lamp hugs the man.", "He considers his taxes.", "She smurfs him.", "Rain falls on hugs."):
        plan = read(text)
        assert not plan.acts and plan.unread, text
    assert "third" in " ".join(read("A man and a woman hug. A waiter pats them.").notes) or read(
        "A man hugs a woman. A waiter pats the man."
    ).notes == ("Only two people can be shown: the others that are named do nothing.",)


def test_spans_are_those_of_the_text_as_written() -> None:
    text = "mum  HUGS kid — and kid pats mum on the back!"
    plan = read(text)
    assert len(plan.acts) == 2
    for act in plan.acts:
        assert act.words is not None and plan.text(act.words).strip()
    assert "pats mum on the back" in plan.text(plan.acts[1].words)  # type: ignore[arg-type]


@pytest.mark.parametrize("text", ["", "   ", "…!?", "木の下で二人が踊る", "Zwei Leute umarmen sich herzlich draussen"])
def test_what_is_no_english_is_said(text: str) -> None:
    plan = read(text)
    assert not plan.acts and (plan.notes or plan.unread)


@pytest.mark.parametrize(
    "text",
    [
        "She inherits a fortune.",
        "They postponed the wedding.",
        "He resembles his brother.",
        "The company hired her.",
        "Quantum fluctuations hug the vacuum.",
        "They agree on the contract.",
        "He owns a house.",
        "She deserves a prize.",
        "The water evaporates.",
        "They love each other deeply.",
    ],
)
def test_what_no_body_shows_is_reported_and_not_invented(text: str) -> None:
    plan = read(text)
    assert not plan.acts and plan.unread


def test_words_that_are_none_are_reported_beside_what_is_read() -> None:
    plan = read("wugga wugga then they shake hands")
    assert [act.act for act in plan.acts] == ["shake-hands"]
    assert [plan.text(unread.words) for unread in plan.unread] == ["wugga wugga"]


def test_a_word_that_was_read_once_is_still_misspelt_the_next_time() -> None:
    read("The zorble huggss.")
    assert [plan.text(u.words) for plan in [read("A zorble hugs B.")] for u in plan.unread] == ["zorble"]


@pytest.mark.parametrize(
    ("text", "already"),
    [
        ("Tom is sitting. Anna walks up to him.", [True, False]),
        ("A stands up, B keeps sitting.", [False, True]),
        ("A man sits on a chair.", [True]),
        ("A man sits down on a chair.", [False]),
        ("They are sitting down.", [False]),
        ("While she kneels, he waves.", [True, False]),
        ("The man sits and the woman then sits next to him.", [True, False, False]),
        ("A pats B on the knee while both are sitting.", [False, True]),
        ("A waves and then sits while B claps.", [False, False, True]),
        ("He waves while she sits down.", [False, False]),
        ("He walks in and sits on the floor.", [False, False]),
        ("The sleeping child is carried by the nurse.", [True, False]),
    ],
)
def test_what_goes_on_when_the_text_begins(text: str, already: list[bool]) -> None:
    assert [act.already for act in read(text).acts] == already


def test_an_act_that_the_parser_takes_for_a_noun_behind_to_is_read() -> None:
    """Spoken captions such as these have been taken as "to <noun>", which named no order and broke the reading."""
    plan = read("First one player offers to hug the other player, then the second player says no with their head.")
    assert [(act.act, act.agents) for act in plan.acts] == [("hug", ("a",)), ("shake-head", ("b",))]


@pytest.mark.parametrize(
    ("text", "acts"), [("Two friends run up to each other, hug and then high-five.", ["run-up", "hug", "high-five"])]
)
def test_a_verb_that_is_listed_before_another_is_no_noun(text: str, acts: list[str]) -> None:
    assert [act.act for act in read(text).acts] == acts


@pytest.mark.parametrize(
    ("text", "people"),
    [
        ("She walks up to him and hugs him.", ["f", "m"]),
        ("Two men shake hands.", ["m", "m"]),
        ("An elderly lady pats an old man on the back.", ["f old", "m old"]),
        ("Two old people dance.", ["old", "old"]),
        ("A woman hugs her old friend.", ["f", ""]),
        ("One person waves at the other.", ["", ""]),
    ],
)
def test_what_words_say_about_people(text: str, people: list[str]) -> None:
    assert [f"{person.sex} {person.age}".strip() for person in read(text).people] == people


@pytest.mark.parametrize(
    ("text", "has"),
    [
        ("she waves", True),
        ("The man waves", True),
        ("her hand goes up", True),
        ("both clap", True),
        ("waves", False),
        ("Slowly sits down", False),
        ("", False),
    ],
)
def test_a_clause_begins_with_its_subject(text: str, has: bool) -> None:
    assert begins_with_subject(text) is has


def test_what_the_stage_cannot_do_is_said() -> None:
    notes = read("Both walk downstage in canon.").notes
    assert len(notes) == 2 and "audience" in notes[0] and "canon" in notes[1]
    assert not read("Both walk.").notes and not read("A bows and the audience claps.").notes
    assert not read("The squirrel chases the sheep.").acts


def test_a_formation_goes_on_as_its_verb_does() -> None:
    """Who sits back to back when the text begins has not stood before."""
    assert [act.already for act in read("Two people sit back to back on the floor.").acts] == [True]
    assert [act.already for act in read("They sit down back to back.").acts] == [False]


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A goes to the window and opens it.", ["walk-away window", "open-thing window"]),
        ("A walks over to the hi-fi and turns it down.", ["walk-away stereo", "switch stereo"]),
        ("A draws the curtains.", ["close-thing curtain"]),
        (
            "A picks up a box, walks to the door and puts it down.",
            ["pick-up-thing box", "walk-away door", "put-down-thing box"],
        ),
        ("A looks out of the window.", ["look-at-thing window"]),
        ("A puts out the cigarette.", ["stub-out cigarette"]),
        ("A goes to the kitchen.", ["walk-away None"]),
        ("A drinks from the cup that she is holding.", ["drink cup", "hold-thing cup"]),
        (
            "A person picks something up with both hands, lifts it to waist height and puts it down.",
            ["pick-up-thing something", "lift-thing something", "put-down-thing something"],
        ),
    ],
)
def test_the_thing_of_an_act_is_what_it_is_done_with_or_before(text: str, acts: list[str]) -> None:
    assert [f"{act.act} {act.thing}" for act in read(text).acts] == acts


def test_an_act_on_which_two_parses_disagree_is_said() -> None:
    plan = read("A man tries to stand on one foot but stumbles.")
    assert [doubt.why for doubt in plan.doubts] == ["“stumbles” may also mean: stumble."]
    assert not read("A man waves.").doubts
