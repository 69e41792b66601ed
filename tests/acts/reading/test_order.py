"""The order of acts that a text only puts side by side, and particles that make another verb."""

import pytest

from acts import Act, lexicon, read
from acts.reading.relations import coordinated


def test_an_act_that_repeats_the_one_before_comes_after_it() -> None:
    first = Act(id="1", act="wave", agents=("a",))
    then = Act(id="2", act="wave", agents=("b",))
    assert coordinated(first, then, lexicon(), repeats=False) == "with"
    assert coordinated(first, then, lexicon(), repeats=True) == "after"


def test_two_who_hold_hands_walk_spin_or_swing_their_arms_meanwhile() -> None:
    together = {*(("hold-hands", then) for then in ("strut", "ring", "swing-arms")), ("swing-arms", "walk-together")}
    for first, then in (*together, ("bow", "strut"), ("swing-arms", "bow")):
        acts = [Act(id=str(i), act=act, agents=("a", "b")) for i, act in enumerate((first, then))]
        assert (coordinated(*acts, lexicon(), repeats=False) == "with") == ((first, then) in together), (first, then)


@pytest.mark.parametrize("words", ["A bows out.", "A plays up.", "He calls off.", "She sits out."])
def test_a_particle_that_no_frame_has_is_another_verb(words: str) -> None:
    assert read(words).acts == ()


@pytest.mark.parametrize("words", ["A bows.", "She sits down.", "A picks up a book."])
def test_a_particle_that_a_frame_has_is_a_part_of_it(words: str) -> None:
    assert len(read(words).acts) == 1


@pytest.mark.parametrize(
    "words", ["He taps her and hides when she turns around.", "He taps her. When she turns, he hides."]
)
def test_what_an_act_waits_for_comes_after_what_is_told_before(words: str) -> None:
    order = {act.act: {relation.act for relation in act.order} for act in read(words).acts}
    ids = {act.act: act.id for act in read(words).acts}
    assert not order["pat"] and order["turn-around"] == {ids["pat"]} and ids["turn-around"] in order["crouch"]


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("They argue, she turns away.", "after"),
        ("A kicks the ball, B dives.", "after"),
        ("A kicks the ball and B jumps.", "with"),
        ("A kicks the ball while B dives.", "while"),
        ("A punches, B ducks.", "with"),
    ],
)
def test_clauses_with_only_a_comma_between_them_follow_each_other(words: str, kind: str) -> None:
    assert [relation.kind for relation in read(words).acts[1].order] == [kind]


@pytest.mark.parametrize(
    ("words", "walk", "kind"),
    [
        ("A carries B in his arms and walks to the door.", "walk-ahead", "with"),
        ("A carries B on his back, then walks forward.", "walk-ahead", "with"),
        ("A carries B across the room and walks away.", "walk-away", "after"),
        ("A carries B to the sofa and leaves.", "walk-away", "after"),
    ],
)
def test_who_carries_somebody_and_walks_still_carries_them(words: str, walk: str, kind: str) -> None:
    then = read(words).acts[1]
    assert (then.act, [r.kind for r in then.order]) == (walk, [kind])


@pytest.mark.parametrize(
    ("words", "beats"),
    [
        ("She taps him on the shoulder, he turns around, and she hugs him.", "pat | turn-around | hug"),
        ("They walk past each other, then both stop and turn around.", "walk-past | stand-still | turn-around"),
        ("Two fighters bow, fight for a moment and bow again.", "bow | fight | bow"),
        ("A sits on the chair until B taps A, then A gets up.", "sit-down | pat | stand-up"),
        ("He bows and waves at the same time.", "bow wave"),
        ("A walks away and nods.", "walk-away nod"),
        ("They clap, then bow at the same time.", "clap | bow"),
        ("high-five, walk", "high-five | walk-together"),
        ("They hug and then part.", "hug | part"),
        ("A walks forward, then pivots on his foot and does a half turn.", "walk-ahead | turn-around | turn-around"),
        ("They pat each other on the shoulder and walk away.", "pat | pat | walk-away"),
        ("A holds on to B's wrist, and B tugs backwards.", "hold-hands pull"),
        ("A pretends to throw a ball and B ducks.", "throw-ball | duck"),
        ("A walks around B, who waves.", "walk-around wave"),
        (
            "One person waves, turns and bows, while the other waits. Finally they hug.",
            "wave stand-still | turn-around | bow | hug",
        ),
        # an answer, and what both do then
        ("A spins while B claps, then they bow together.", "spin clap | bow"),
        ("Someone bows and the other bows back.", "bow | bow"),
        ("A leans forward and B leans back.", "lean lean"),
        ("Standing back to back, they walk five paces and turn.", "back-to-back | part | turn-around"),
        ("A lifts a table with B and carries it out.", "lift-together | carry-thing"),
        ("They lift a table, then A carries it out.", "lift-together | carry-alone"),
    ],
)
def test_what_follows_and_what_is_done_meanwhile(words: str, beats: str) -> None:
    assert " | ".join(" ".join(act.act for act in group) for group in read(words).beats()) == beats
