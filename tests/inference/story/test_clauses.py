"""Sentences taken apart: who does something, what, and whether it goes on beside something else."""

import pytest

from webdemo.inference.story.clauses import Reader, clauses


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("They shake hands.", [("ab", "shake hands")]),
        ("Person B taps person A and leaves.", [("b", "taps person a"), ("b", "leaves")]),
        ("A man bows, and a woman claps.", [("a", "bows"), ("b", "claps")]),
        ("A man and a woman dance.", [("ab", "dance")]),
        ("The second person waves; the first person nods.", [("b", "waves"), ("a", "nods")]),
        ("One sits down and the other laughs.", [("a", "sits down"), ("b", "laughs")]),
        ("A catches B", [("a", "catches person b")]),
        ("A man greets B", [("a", "greets person b")]),
        ("Two old friends meet.", [("ab", "meet")]),
        ("Person A looks at person B, who yawns.", [("a", "looks at person b"), ("b", "yawns")]),
        (
            "He grins at her, but she sulks. He shrugs.",
            [("a", "grins at her"), ("b", "sulks"), ("a", "shrugs")],
        ),
        (
            "A nurse points at the patient. The patient gets up.",
            [("a", "points at the patient"), ("b", "gets up")],
        ),
        ("My son runs to me and I hug him.", [("a", "runs to them"), ("b", "hug him")]),
        ("cop chasing a thief", [("a", "chasing a thief")]),
        ("dad and daughter dance", [("ab", "dance")]),
        ("Tom waves and Lucy nods.", [("a", "waves"), ("b", "nods")]),
        ("p2 waves at p1", [("b", "waves at person a")]),
        ("b walks round a", [("b", "walks round person a")]),
        ("little boy runs to his mum", [("a", "runs to his mum")]),
        ("the other guy leaves", [("b", "leaves")]),
        ("After a moment she nods.", [("a", "nods")]),
        ("She's on the phone, he waits.", [("a", "is on the phone"), ("b", "waits")]),
        ("Person1 waves to person2.", [("a", "waves to person b")]),
        ("Person A waves, B nods.", [("a", "waves"), ("b", "nods")]),
        ("One bows and at the same time the other nods.", [("a", "bows"), ("b", "nods")]),
        ("He has turned around.", [("a", "turns around")]),
        ("Link arms, walk.", [("ab", "link arms"), ("ab", "walk")]),
        ("A young couple dance.", [("ab", "dance")]),
        ("jump, clap", [("ab", "jump"), ("ab", "clap")]),
        ("", []),
        ("... , ;", []),
    ],
)
def test_every_clause_has_its_person(sentence: str, found: list[tuple[str, str]]) -> None:
    assert [(clause.who, clause.words) for clause in clauses(sentence)] == found


def test_what_goes_on_at_once_differs_from_what_follows() -> None:
    assert [clause.at_once for clause in clauses("A man waits while a woman sings, and then he leaves.")] == [
        False, True, False,
    ]  # fmt: skip
    assert clauses("While she reads, he sleeps.")[1].at_once
    assert clauses("They walk along, singing.")[1].at_once
    assert not clauses("They walk along and sing.")[1].at_once
    assert clauses("He claps until she turns round.")[1].until


def test_a_reader_remembers_who_is_who() -> None:
    reader = Reader()
    reader.read("A guard stands at the gate and a visitor comes up to him.")
    assert [clause.who for clause in reader.read("The visitor bows.")] == ["b"]
    assert [clause.who for clause in reader.read("The guard nods.")] == ["a"]


def test_hostile_text_is_read_in_no_time() -> None:
    for text in ("and " * 200, "a " * 300, "walks " * 100 + "round", "(" * 600, "\u202e" + "x" * 599):
        clauses(text)
