"""Which acts of the lexicon are made."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from acts import lexicon
from training.evaluate.acts_made import Made, made


def test_each_act_with_a_rule_is_made_and_judged_by_it() -> None:
    entries = lexicon().entries
    asked: list[Any] = []

    def run(request: Any) -> Any:
        asked.append(request)
        act = "bow" if "bow" in request.prompt.lower() else "wave"
        return SimpleNamespace(manifest={"checked": [{"act": act, "done": act == "bow", "measure": "hand low"}]})

    found = {each.act: each for each in made(run, steps=3, only=("wave", "bow", "laugh"))}
    assert set(found) == {"wave", "bow"}, "laughing has no rule"
    assert found["bow"].done is True and found["wave"] == Made("wave", entries["wave"].reads[0], False, "hand low")
    assert all(4 <= request.seconds <= 8 and request.steps == 3 for request in asked)
