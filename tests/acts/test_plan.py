from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from acts import Act, Plan, Relation


def act(number: int, *order: tuple[str, int], agents: tuple[str, ...] = ("a",)) -> Act:
    relations = tuple(Relation(kind=kind, act=str(other)) for kind, other in order)
    return Act(id=str(number), act="bow", agents=agents, order=relations)


def ids(plan: Plan) -> list[list[str]]:
    return [[each.id for each in group] for group in plan.beats()]


def test_beats_follow_the_order_of_acts() -> None:
    assert ids(Plan(acts=(act(1), act(2, ("after", 1)), act(3, ("while", 2))))) == [["1"], ["2", "3"]]
    assert ids(Plan(acts=(act(1, ("after", 2)), act(2)))) == [["2"], ["1"]]
    assert ids(Plan(acts=(act(1, ("before", 2)), act(2)))) == [["1"], ["2"]]
    assert ids(Plan(acts=(act(1), act(2), act(3, ("until", 1))))) == [["2", "3"], ["1"]]


_KINDS = st.sampled_from(["after", "with", "while", "until", "before"])


@given(st.lists(st.lists(st.tuples(_KINDS, st.integers(1, 12)), max_size=4), max_size=12))
def test_any_order_gives_each_act_one_beat(orders: list[list[tuple[str, int]]]) -> None:
    """Contradictions as well: after one another, while and after, in circles."""
    count = len(orders)
    acts = tuple(
        act(i, *((kind, other) for kind, other in order if other <= count and other != i))
        for i, order in enumerate(orders, 1)
    )
    listed = [each for group in ids(Plan(acts=acts)) for each in group]
    assert sorted(listed) == sorted(each.id for each in acts)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"agents": ("a", "a")}, "name each agent once"),
        ({"agents": ("a",), "patient": "a"}, "must not be an agent"),
        ({"agents": ()}, "at least 1"),
        ({"agents": ("c",)}, "Input should be"),
        ({"agents": ("a",), "seconds": float("nan")}, "seconds"),
        ({"agents": ("a",), "path": "x"}, "Extra inputs"),
    ],
)
def test_an_impossible_act_is_refused(fields: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Act(id="1", act="hug", **fields)  # type: ignore[arg-type]


def test_relations_name_other_acts_of_the_plan() -> None:
    with pytest.raises(ValidationError, match="no other act"):
        Plan(acts=(act(1, ("after", 7)),))
    with pytest.raises(ValidationError, match="no other act"):
        Plan(acts=(act(1, ("after", 1)),))
    with pytest.raises(ValidationError, match="the same id"):
        Plan(acts=(act(1), act(1)))


def test_a_plan_survives_json() -> None:
    plan = Plan(sentence="x", acts=(act(1), act(2, ("after", 1))), reader="hand")
    assert Plan.model_validate_json(plan.model_dump_json()) == plan
