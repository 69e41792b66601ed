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


def test_then_at_the_same_time_is_after_what_came_before() -> None:
    clap, bow = read("They clap, then bow at the same time.").acts
    assert [(r.kind, r.act) for r in bow.order] == [("after", clap.id)]


@pytest.mark.parametrize(
    "words", ["He taps her and hides when she turns around.", "He taps her. When she turns, he hides."]
)
def test_what_an_act_waits_for_comes_after_what_is_told_before(words: str) -> None:
    order = {act.act: {relation.act for relation in act.order} for act in read(words).acts}
    ids = {act.act: act.id for act in read(words).acts}
    assert not order["pat"] and order["turn-around"] == {ids["pat"]} and ids["turn-around"] in order["hide-and-seek"]


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


@pytest.mark.parametrize("words", ["high-five, walk", "They hug and then part."])
def test_the_first_of_two_verbs_comes_first(words: str) -> None:
    first, then = read(words).acts
    assert not first.order and [(r.kind, r.act) for r in then.order] == [("after", first.id)]


def test_who_then_sits_down_was_not_seated_before() -> None:
    man, woman = read("The man sits and the woman then sits next to him.").acts[:2]
    assert man.already and not woman.already


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
