"""Moves as places: people arrive, part, pass and circle at a body's pace."""

import math

import numpy as np
import pytest

from acts import read
from acts.staging.beginnings import REACH, starting
from acts.staging.floor import ABREAST, ACROSS, BEHIND, CLOSE, FARTHEST, LINKED, SEAT, plan
from acts.staging.holds import HOLDS
from acts.staging.places import AT_TABLE, EVENLY, EVERY, MOST, Standing, Way2D
from acts.staging.score import Move
from acts.staging.stage import scores_of
from motion import FPS

from .staged_words import score

FACING = Standing(np.array([[0.0, 0.0], [0.0, 1.2]]), np.array([0.0, math.pi]))
BEHIND_B = Standing(np.array([[0.0, 0.0], [0.0, 3.0]]), np.zeros(2))


def ways(sentence: str, seconds: float = 4.0, standing: Standing | None = None) -> tuple[Standing, dict[int, Way2D]]:
    found = score(sentence).moves
    begin = starting(found, seconds) if standing is None else standing
    planned = plan(found, begin, round(seconds * FPS), first=standing is None)
    return begin, {way.person: way for way in planned}


def gaps(found: dict[int, Way2D]) -> np.ndarray:
    """Metres between the two at the frames that both have."""
    frames = sorted(set(found[0].frames) & set(found[1].frames))
    at = [found[i].places[[list(found[i].frames).index(f) for f in frames]] for i in (0, 1)]
    return np.linalg.norm(at[0] - at[1], axis=1)


@pytest.mark.parametrize(
    ("words", "near"),
    [
        ("They walk up to each other and shake hands.", 0.75),
        ("They run towards each other and hug.", 0.3),
        ("They walk up to each other.", CLOSE),
    ],
)
def test_those_who_meet_stay_as_near_as_what_they_do_then_needs(words: str, near: float) -> None:
    _, found = ways(words, 5.0)
    for way in found.values():
        arrived = np.linalg.norm(way.places - way.places[-1], axis=1) < 0.01
        assert way.frames[-1] == 149 and np.diff(np.asarray(way.frames)[arrived]).max() <= EVERY
        assert np.asarray(way.frames)[arrived][0] < 110, "they are given where they met until the end"
    assert abs(gaps(found)[-1] - near) < 0.05


@pytest.mark.parametrize("words", ["They walk up to each other.", "They part."])
def test_the_pace_of_a_walk_is_given(words: str) -> None:
    _, found = ways(words, 5.0)
    for way in found.values():
        moving = np.linalg.norm(np.diff(way.places, axis=0), axis=1) > 0.03
        assert np.diff(way.frames)[moving].max() <= EVENLY


def test_those_who_part_turn_and_get_away_but_not_out_of_sight() -> None:
    _, found = ways("They walk away from each other.", standing=FACING)
    assert 3.0 < gaps(found)[-1] <= FARTHEST + 0.5
    headings = found[0].headings
    second = list(found[0].frames).index(29)
    assert headings is not None and math.cos(headings[second]) < -0.99, "a walks with the back to b"


def test_who_walks_past_keeps_clear_and_gets_beyond() -> None:
    begin, found = ways("Person A walks past person B.")
    assert gaps(found).min() > 0.5
    assert found[0].places[-1, 1] > begin.places[1, 1] + 1.0


def test_who_sneaks_past_goes_slowly_and_gets_beyond() -> None:
    begin, found = ways("A sneaks past B.")
    steps = np.linalg.norm(np.diff(found[0].places, axis=0), axis=1) / np.diff(found[0].frames) * FPS
    assert steps.max() < 0.77 and found[0].places[-1, 1] > begin.places[1, 1] + 0.5


@pytest.mark.parametrize(
    ("words", "seconds", "degrees"), [("walks once all the way around", 8.0, 330), ("slowly walks around", 5.0, 190)]
)
def test_who_walks_around_goes_around(words: str, seconds: float, degrees: float) -> None:
    begin, found = ways(f"Person A {words} person B.", seconds)
    line = found[0].places - begin.places[1]
    turned = np.degrees(np.unwrap(np.arctan2(line[:, 0], line[:, 1])))
    assert abs(turned[-1] - turned[0]) >= degrees


def test_those_who_walk_side_by_side_keep_abreast() -> None:
    for standing in (None, FACING):
        _, found = ways("They walk side by side.", standing=standing)
        assert gaps(found)[-1] == pytest.approx(ABREAST, abs=0.02)
        ahead = [way.places[-1] - way.places[-3] for way in found.values()]
        assert ahead[0] @ ahead[1] / np.prod(np.linalg.norm(ahead, axis=1)) > 0.99
        headings = [way.headings for way in found.values()]
        assert headings[0] is not None and headings[1] is not None
        assert math.cos(headings[0][-1] - headings[1][-1]) > 0.98


def test_who_steps_back_goes_on_facing_the_other() -> None:
    _, found = ways("Person A steps back.", standing=FACING)
    assert found[0].places[-1, 1] < -0.5
    assert found[0].headings is not None and np.abs(found[0].headings).max() < 1e-6


def test_a_walk_takes_a_step_to_stop() -> None:
    walking = Standing(FACING.places, FACING.headings, np.array([[1.2, 0.0], [0.0, 0.0]]))
    _, found = ways("Both stop.", standing=walking)
    assert 0.2 < found[0].places[-1, 0] < 0.6 and np.ptp(found[0].places, axis=0).max() == 0
    assert found[1].places[-1].tolist() == [0.0, 1.2]


@pytest.mark.parametrize("seconds", [0.5, 2.0, 20.0])
@pytest.mark.parametrize(
    "sentence",
    [
        "They walk up to each other.",
        "Person A walks past person B.",
        "She walks once around him.",
        "They walk side by side.",
        "Person A chases person B.",
        "They turn around.",
        "Person A sneaks up behind person B.",
        "Person A spins all the way round.",
    ],
)
@pytest.mark.parametrize("near", [0.0, 3.0, None])
def test_every_way_is_one_that_people_can_go(sentence: str, seconds: float, near: float | None) -> None:
    standing = None if near is None else Standing(np.array([[0.0, 0.0], [near, 0.0]]), np.zeros(2))
    for way in ways(sentence, seconds, standing)[1].values():
        frames = np.asarray(way.frames)
        assert np.isfinite(way.places).all() and (np.diff(frames) > 0).all()
        assert frames[0] >= 0 and frames[-1] < round(seconds * FPS)
        speed = np.linalg.norm(np.diff(way.places, axis=0), axis=1) / np.diff(frames) * FPS
        assert (speed <= 1.6 * MOST).all(), speed.max()


def test_who_follows_sets_off_behind_who_is_followed_and_stays_behind() -> None:
    for sentence in ("Person A runs away and person B gives chase.", "Person B follows person A."):
        _, found = ways(sentence, seconds=5.0, standing=FACING)
        leader, follower = found[0], found[1]
        assert np.linalg.norm(leader.places[-1] - leader.places[0]) > 3.0
        assert np.linalg.norm(follower.places[-1] - follower.places[0]) > 2.0
        assert gaps(found).max() < 3.2 and gaps(found).min() > 0.8
        assert follower.headings is not None and abs(math.cos(follower.headings[-1])) > 0.99


def test_moves_of_one_beat_come_one_after_another() -> None:
    """Whoever waits, turns or arrives first has time left for the rest."""
    _, found = ways("Person A walks up to person B, halts, wheels about and marches away.", seconds=8.0)
    far = gaps(found)
    nearest = int(far.argmin())
    assert far[nearest] < 1.2 and far[0] > 2.5 and far[-1] > 2.0 and 0 < nearest < len(far) - 1
    _, found = ways("Person B looks at person A and runs away.", seconds=5.0, standing=FACING)
    assert gaps(found)[-1] > 3.0


@pytest.mark.parametrize(
    ("words", "sense"), [("spins to the left", 1), ("spins to the right", -1), ("spins clockwise twice", -1)]
)
def test_a_turn_goes_the_way_that_the_words_say(words: str, sense: int) -> None:
    found = ways(f"Person A {words}.", seconds=5.0, standing=FACING)[1][0]
    assert found.headings is not None
    turned = np.unwrap(found.headings)[-1] - found.headings[0]
    assert sense * turned > 1.5 * math.pi  # the first of the given frames is on the way


@pytest.mark.parametrize(("words", "sense"), [("counterclockwise", 1), ("clockwise", -1)])
def test_a_walk_around_goes_the_way_that_the_words_say(words: str, sense: int) -> None:
    found = ways(f"Person A walks {words} around person B.", seconds=6.0, standing=FACING)[1][0]
    out = found.places - FACING.places[1]
    turned = np.unwrap(np.arctan2(out[:, 0], out[:, 1]))
    assert sense * (turned[-1] - turned[0]) > math.pi


def test_who_walks_to_and_fro_comes_back_across_the_line() -> None:
    _, found = ways("Person A paces up and down.", seconds=8.0, standing=BEHIND_B)
    aside = found[0].places[:, 0]
    assert aside.max() > 0.8 and aside.min() < -0.8 and np.abs(found[0].places[:, 1]).max() < 0.05
    assert (np.diff(np.sign(aside)) != 0).sum() >= 2


@pytest.mark.parametrize(
    ("words", "standing", "ahead"),
    [("two steps", BEHIND_B, 1.4), ("five steps", FACING, 1.2 - CLOSE), ("three steps", None, 2.1)],
)
def test_steps_forward_end_before_the_other(words: str, standing: Standing | None, ahead: float) -> None:
    _, found = ways(f"Person A takes {words} forward.", standing=standing)
    assert found[0].places[-1] == pytest.approx([0.0, ahead], abs=0.02)


def test_a_move_told_after_something_else_begins_late_but_following_does_not() -> None:
    _, found = ways("Person A nods and walks away.", standing=FACING)
    assert found[0].frames[0] > 0.3 * 4 * FPS
    _, found = ways("Person A waves and person B follows person A.", standing=FACING)
    assert max(way.frames[0] for way in found.values()) < FPS


@pytest.mark.parametrize("words", ["A couple dances a waltz.", "They take each other's hands and spin around."])
def test_those_in_a_hold_turn_about_the_middle_and_face_each_other(words: str) -> None:
    kind = score(words).hold
    assert kind
    begin, found = ways(words, 6.0)
    middle = begin.places.mean(axis=0)
    assert np.abs(gaps(found) - HOLDS[kind].apart).max() < 0.05
    for way in found.values():
        inwards = middle - way.places
        turned = np.unwrap(np.arctan2(inwards[:, 0], inwards[:, 1]))
        assert way.headings is not None
        assert np.abs(np.cos(turned - way.headings) - 1).max() < 0.02
        assert abs(turned[-1] - turned[0]) > math.pi


def test_who_walks_backwards_before_the_other_faces_them() -> None:
    begin, found = ways("Person A walks backwards and person B follows her.", 5.0)
    assert begin.gap() == BEHIND and math.cos(begin.headings[1]) < -0.99
    assert found[0].places[-1, 1] < -1.5 and np.abs(np.asarray(found[0].headings)).max() < 0.01
    assert found[1].places[-1, 1] < 0.2


@pytest.mark.parametrize(
    ("sentence", "apart", "headings"),
    [
        ("They walk side by side.", [-ABREAST, 0.0], [0.0, 0.0]),
        ("They walk hand in hand.", [-LINKED, 0.0], [0.0, 0.0]),
        ("Person A follows person B.", [0.0, BEHIND], [0.0, 0.0]),
        ("Person B follows person A.", [0.0, -BEHIND], [0.0, 0.0]),
        ("They stand back to back.", [0.0, -0.248], [0.0, math.pi]),
        ("They walk away from each other.", [0.0, 1.1], [0.0, math.pi]),
        ("Person A walks past person B.", [0.0, 2.2], [0.0, math.pi]),
    ],
)
def test_a_first_beat_begins_where_its_move_can(sentence: str, apart: list[float], headings: list[float]) -> None:
    begin = starting(score(sentence).moves, 4.0)
    assert begin.places[1] - begin.places[0] == pytest.approx(apart, abs=1e-3)
    assert begin.headings == pytest.approx(headings)


def test_those_who_touch_begin_within_reach_unless_one_comes_to_the_other() -> None:
    assert REACH == starting((), 4.0, near=True).gap() < starting((), 4.0).gap()
    assert starting(score("They walk up to each other.").moves, 4.0, near=True).gap() > 1.7


def test_a_turn_that_begins_late_in_a_short_beat_gives_no_place_before_it() -> None:
    _, found = ways("She jumps into his arms and he spins her around.", 1.0, FACING)
    assert found and all(np.isfinite(way.places).all() for way in found.values())


def test_who_comes_up_behind_the_other_walks_round_them_and_faces_their_back() -> None:
    found = plan([Move("a", "behind", near=0.5)], FACING, 150)[0]
    np.testing.assert_allclose(found.places[-1], [0.0, 1.7], atol=0.05)
    assert math.cos(found.headings[-1] - math.pi) > 0.99
    assert np.linalg.norm(found.places - FACING.places[1], axis=1).min() > 0.45


def test_who_comes_up_beside_the_other_walks_straight_there_and_looks_the_same_way() -> None:
    found = plan([Move("a", "beside", near=0.5)], FACING, 150)[0]
    b = FACING.places[1]
    assert abs(found.places[-1, 1] - b[1]) < 0.05 and abs(abs(found.places[-1, 0]) - 0.5) < 0.05
    assert math.cos(found.headings[-1] - FACING.headings[1]) > 0.99
    assert np.linalg.norm(np.diff(found.places, axis=0), axis=1).sum() < 1.1 * np.linalg.norm(found.places[-1])


def test_who_comes_up_to_a_person_at_a_table_walks_round_it_to_their_side() -> None:
    then = scores_of(read("A sits at the table. B walks up to A.").beats())[-1].moves
    comes = next(move for move in then if move.person == "b")
    table = np.array([0.0, AT_TABLE])
    stand = Standing(np.array([[0.0, 0.0], [0.0, 3.0]]), np.array([0.0, math.pi]))
    way = plan((comes,), stand, 150, seats=[table])[0]
    assert comes.way == "beside" and np.linalg.norm(way.places - table, axis=1).min() > 0.55


def test_who_then_touches_the_other_from_behind_comes_up_from_there() -> None:
    first, _ = scores_of(read("He creeps up and covers her eyes.").beats())
    assert [(move.person, move.way) for move in first.moves] == [("a", "behind"), ("b", "stay")]


def test_who_runs_away_gets_up_to_the_speed_of_a_run() -> None:
    way = plan((Move("a", "away", 2.2),), FACING, 120)[0]
    places = np.stack([np.interp(np.arange(120), way.frames, way.places[:, axis]) for axis in (0, 1)], axis=1)
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() * FPS > 1.9


def test_who_comes_up_and_walks_past_does_not_stop_on_the_way() -> None:
    past = plan((Move("a", "to"), Move("a", "past"), Move("b", "stay")), BEHIND_B, 150)[0]
    speed = np.diff(past.places[:, 1]) / np.diff(past.frames) * FPS
    assert speed[5:-5].min() > 0.5


def test_who_overtakes_comes_from_behind_and_ends_ahead_of_a_person_who_walks_on() -> None:
    begin, found = ways("The young man overtakes the old one.", seconds=5.0)
    assert begin.places[0, 1] < begin.places[1, 1] - 1.0 and np.allclose(begin.headings, 0.0)
    gone = found[1].places[-1, 1] - begin.places[1, 1]
    assert gone > 1.0 and found[0].places[-1, 1] > found[1].places[-1, 1] + 0.8
    walks = [move.way for move in score("A walks on slowly, and B overtakes him.").moves if move.person == "a"]
    assert walks == ["ahead"], "who is overtaken walks past nobody"


def test_who_moonwalks_past_the_other_has_their_back_to_where_they_go() -> None:
    begin, found = ways("He moonwalks past her.", seconds=5.0)
    assert abs(begin.headings[0]) == math.pi and found[0].places[-1, 1] > begin.places[1, 1] + 1.0
    assert found[0].headings is not None and np.nanmax(np.cos(found[0].headings)) < -0.99


def test_steps_back_are_as_long_as_told_and_make_room_for_steps_forward() -> None:
    back = plan((Move("a", "back", metres=2.0),), FACING, 120)[0]
    assert back.places[-1, 1] < -1.8
    ahead, *_ = plan((Move("a", "ahead", metres=0.7), Move("b", "back")), FACING, 90)
    assert ahead.places[-1, 1] > 0.6
    alone, *_ = plan((Move("a", "ahead", metres=0.7),), FACING, 90)
    assert alone.places[-1, 1] < 0.4, "who stays is not walked into"


def test_who_goes_to_a_thing_turns_from_the_other_and_stays_there() -> None:
    thing = [Move("a", "thing")]
    (way,) = plan(thing, FACING, round(4 * FPS))
    assert way.person == 0 and way.headings is not None
    assert np.linalg.norm(way.places[-1] - FACING.places[1]) == pytest.approx(1.2 + ACROSS, abs=0.05)
    assert abs(abs(way.headings[-1]) - math.pi) < 0.01, "the thing is before them, and the other behind"
    averted = Standing(FACING.places, np.array([math.pi, math.pi]))
    (way,) = plan(thing, averted, round(4 * FPS))
    assert np.ptp(way.places, axis=0).max() == 0 and np.ptp(way.headings) == 0, "they have come to it before"


@pytest.mark.parametrize("words", ["Person A turns around.", "Person A walks away.", "They part."])
def test_a_turn_is_given_all_along_so_that_nobody_spins_round_within_it(words: str) -> None:
    _, found = ways(words, standing=FACING)
    way = found[0]
    assert way.headings is not None
    turned = np.abs(np.diff(way.headings))
    assert np.nanmax(np.abs(way.headings - FACING.headings[0])) > 2.5
    quick = turned > 0.1
    assert np.nanmax(turned) < 1.3
    assert np.nanmax(turned[quick] / (np.diff(way.frames)[quick] / 30)) < 6.5, (
        "a half turn takes half a second at least"
    )


def test_a_person_who_watches_the_other_go_round_them_turns_with_them() -> None:
    _, found = ways("A walks around B while B turns to watch.", seconds=6.0)
    watched, watcher = found[0], found[1]
    assert watcher.headings is not None and np.ptp(watcher.headings) > math.pi
    shared = [f for f in watched.frames if f in watcher.frames]
    line = np.stack([watched.places[watched.frames.index(f)] - watcher.places[watcher.frames.index(f)] for f in shared])
    facing = np.array([watcher.headings[watcher.frames.index(f)] for f in shared])
    off = np.arctan2(line[:, 0], line[:, 1]) - facing
    assert np.cos(off).min() > math.cos(0.5)


@pytest.mark.parametrize("words", ["A walks to the chair and sits down.", "A walks up to B and sits down."])
def test_who_sits_down_at_the_end_of_a_way_has_the_seat_behind_them_and_faces_the_other(words: str) -> None:
    found = scores_of(read(words).beats())[0].moves
    begin = starting(found, 5.0)
    way, other = plan(found, begin, 150, first=True)
    assert way.headings is not None
    line = other.places[-1] - way.places[-1]
    assert math.cos(way.headings[-1] - math.atan2(*line)) > 0.95
    seat = way.places[-1] - SEAT * line / np.linalg.norm(line)
    assert np.linalg.norm(way.places - seat, axis=1).min() > 0.35
