"""What a verdict leaves out of a sentence: words in no act, and qualifiers that nothing measures."""

from __future__ import annotations

import pytest

from acts import lexicon, read
from acts.accounting import account
from acts.checking import checked
from acts.qualifiers import plain, qualifiers
from tests.motion.metrics.figures import duet, put
from webdemo.inference.verdicts import note


@pytest.mark.parametrize(
    ("sentence", "unread"),
    [
        ("A waves at B.", ()),
        ("a and b hug", ()),
        ("They stand one metre apart.", ()),
        ("A walks half a circle around B.", ("half",)),
        ("They shake hands and walk away.", ()),
        ("A bows against the wall.", ("against the wall",)),
        ("He lowers his head in shame.", ("in shame",)),
        ("A hands B a heavy box, and B puts it on the floor.", ("heavy",)),
        ("A waves and zorbles.", ("zorbles",)),
        ("A bows like a wizard.", ("like a wizard",)),
        ("A claps (slowly, at the window) and B bows.", ("slowly, at the window",)),
        ("A taps B with two fingers three times.", ("two",)),
        ("They dance on Sunday.", ("on Sunday",)),
        ("Two people sit down, and one of them waves.", ()),
        ("There are two people who dance.", ()),
        ("A couple of kids hug.", ()),
        ("The police officer waves.", ()),
        ("The yoga teacher claps in unison with her.", ()),
        ("One of the kids waves at the other.", ()),
        ("A hurries and keeps walking.", ()),
        ("She is in a hurry and pulls him.", ("in a hurry",)),
        ("A pair of skaters dance.", ()),
        ("The other dancer bows.", ()),
        ("They circle each other with their guards up.", ("with their guards",)),
        ("They bow like two wizards.", ("like two wizards",)),
        ("A spins around twice.", ()),
        ("He punches her twice in the stomach with his left fist.", ()),
        ("He circles around her once clockwise.", ()),
        ("A walks around.", ("around",)),
        ("A walks about.", ("about",)),
        ("They walk about three metres.", ()),
        ("The drooping man prompts her.", ("The drooping man prompts her",)),
        ("A swings the bat around.", ("around",)),
        ("A trips over a stone.", ("over a stone",)),
        ("A walks to the chair and sits on it.", ()),
        ("They run to the window.", ()),
        ("A man waves while a woman is walking by.", ()),
        ("I want that they are hugging.", ()),
        ("The nurse helps the patient sit down.", ()),
        ("The loser stomps away sulking.", ()),
        ("A kicks three balls.", ("three",)),
        ("Two kids spin holding hands.", ()),
        ("A walks with B arm in arm.", ("arm in arm",)),
        ("The one on the left bows.", ("The one on the left",)),
        ("They race each other to the wall and back.", ("to the wall", "back")),
        ("Lucas covers Emma's eyes, she guesses who it is and bows.", ("she guesses who it is",)),
    ],
)
def test_words_that_are_in_no_act_are_reported(sentence: str, unread: tuple[str, ...]) -> None:
    assert account(read(sentence)).unread == unread


@pytest.mark.parametrize(
    ("sentence", "kinds"),
    [
        ("A raises the right arm.", ()),
        ("A jumps twice.", ()),
        ("A turns around twice.", ()),
        ("A circles B twice.", ()),
        ("A waves at B from two metres away.", ()),
        ("They dance two metres apart.", ()),
        ("A kicks B backwards.", ("which way",)),
        ("A walks downwards.", ("which way",)),
        ("He kisses her right cheek.", ("which side", "where on the body")),
        ("A waves back at B.", ()),
        ("A kneels three times.", ("how often",)),
        ("A kneels once.", ("how often",)),
        ("A takes three steps back.", ("how many steps",)),
        ("A jumps up.", ()),
        ("They stroll hand in hand.", ()),
        ("A taps B on the left shoulder.", ()),
        ("A shakes B's right hand.", ("which side",)),
        ("A kicks B in the shin.", ("where on the body",)),
        ("A hugs B for ten seconds.", ("how long",)),
        ("A stamps the foot angrily.", ("in which manner",)),
        ("A sings three times.", ("how often",)),
        ("A kneels on both knees.", ("on both sides",)),
        ("A tickles B with both hands.", ("with both hands",)),
        ("A points at B and then at himself.", ("“at himself”",)),
        ("They walk up to each other.", ()),
        ("They walk in opposite directions.", ()),
        ("They walk toward each other.", ()),
        ("A backs away from B.", ()),
        ("A turns away from B.", ()),
        ("A hits B back.", ()),
        ("She takes off her boots.", ()),
        ("They dance around the room.", ("“around the room”",)),
        ("B drinks with the left hand.", ()),
        ("A jumps to the left.", ()),
        # what goes without saying of an act
        ("A waves with her right hand.", ()),
        ("A slaps B on the cheek.", ()),
        ("A sprints over to B.", ()),
        ("A puts her head on B's shoulder.", ()),
        ("A gives B a piggyback ride.", ()),
        ("A covers B's eyes with his hands.", ()),
        ("A does some push-ups.", ()),
    ],
)
def test_qualifiers_that_nothing_measures_are_named(sentence: str, kinds: tuple[str, ...]) -> None:
    (found,) = checked(read(sentence), duet())
    assert found.unchecked == kinds


def test_who_walks_away_backwards_goes_backwards() -> None:
    (act,) = read("A walks backwards away from B.").acts
    assert ("which way", "happens(backs(a, 0.2))") in list(qualifiers(act, lexicon().entries[act.act], "a", "", ""))


def test_a_way_that_nothing_measures_is_no_hand() -> None:
    assert plain(read("A jumps to the right.").acts[0], frozenset(["which way"])).side is None


def test_what_is_done_is_said_without_what_was_not_measured() -> None:
    up = duet(put("left_wrist", (0.2, 0.9, 0.0)))
    (found,) = checked(read("A raises the left arm angrily."), up)
    assert found.done and found.words == "A raises the left arm" and found.unchecked == ("in which manner",)
    (found,) = checked(read("A raises the left arm angrily."), duet())
    assert not found.done and found.words == "A raises the left arm angrily"


@pytest.mark.parametrize(
    ("sentence", "wrote"),
    [
        ("A waves at B.", ""),
        ("A gives B a hug.", ""),
        ("A throws a punch at B.", ""),
        ("They high-five.", ""),
        ("A strokes B's cheek.", "strokes B's cheek"),
        ("A marches.", "marches"),
        ("She rides on his back.", ""),
        ("A threatens B.", "threatens B"),
        ("They curl up.", "curl up"),
        ("A supports B.", "supports B"),
        ("A sets B down.", ""),
        ("A chats with B.", ""),
        ("A collapses.", ""),
        ("A runs into B.", "runs into B"),
        ("A lifts B up.", ""),
        ("A shakes his fist at B.", "shakes his fist at B"),
        ("A rests her head on B's lap.", "rests her head on B's lap"),
        ("They spin next to each other.", "spin next to each other"),
        ("They waltz, face to face.", ""),
        ("A points at the floor.", ""),
        ("A touches his nose.", "touches his nose"),
        ("A covers her mouth.", ""),
    ],
)
def test_an_act_that_says_none_of_its_words_is_shown_as_what_they_were_read_as(sentence: str, wrote: str) -> None:
    assert checked(read(sentence), duet())[0].wrote == wrote
    row = checked(read(sentence), duet())[0].to_dict() | {"done": True}
    assert (f"“{wrote}”, read as: " in note([[row]])) == bool(wrote)
    assert not wrote or "(how fast)" in note([[row | {"unchecked": ["how fast"]}]])
    assert ("Done: " in note([[row]])) != bool(wrote)


@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("They lean on each other, back to back.", "on each other"),
        ("A crawls under a table.", "under a table"),
        ("A crouches beneath an object.", "beneath an object"),
        ("A edges up to B.", "edges"),
        ("A looks up at the ceiling.", "at the ceiling"),
        ("He holds the door for the lady.", "for the lady"),
    ],
)
def test_places_targets_and_verbs_that_no_verdict_says_are_named(sentence: str, words: str) -> None:
    left = account(read(sentence))
    told = (*left.unread, *left.others.values(), *(w for said in left.unsaid.values() for w in said))
    assert any(words in each for each in told)


@pytest.mark.parametrize(
    ("sentence", "words"), [("A plays the violin.", "violin"), ("A looks up at the ceiling.", "at the ceiling")]
)
def test_a_note_tells_them_also_where_the_act_is_not_measured_or_not_seen(sentence: str, words: str) -> None:
    plan = read(sentence)
    (row,) = checked(plan, duet())
    assert not row.done and words in note([[row.to_dict()]], unread=account(plan).unread)


def test_a_long_note_names_fewer_of_each_kind() -> None:
    row = {"act": "wave", "done": True, "measure": ""}
    rows = [row | {"words": f"A waves at B in way {i} {'x' * 40}"} for i in range(9)]
    assert len(note([rows])) <= 350 and "more" in note([rows])


@pytest.mark.parametrize(
    ("sentence", "rule"),
    [
        ("A limps around B.", "limps(a)"),
        ("A skips away.", "hops(a"),
        ("A crawls away from B.", "low(a)"),
        ("A staggers away.", ""),
    ],
)
def test_a_gait_is_measured_where_a_rule_knows_it(sentence: str, rule: str) -> None:
    (act,) = read(sentence).acts
    found = dict(qualifiers(act, lexicon().entries[act.act], "a", "", sentence))["in which manner"]
    assert rule in found and bool(rule) is bool(found)
