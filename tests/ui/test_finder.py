"""What the page's search lists beside the page's own controls."""

from types import SimpleNamespace
from typing import Any

from acts import read
from webdemo.ui.components.finder import known
from webdemo.ui.history import Entry, Found


def test_every_act_comes_with_a_sentence_that_has_it() -> None:
    nothing: Any = SimpleNamespace(search=lambda owner, wanted: Found((), 0))
    acts = known(nothing)["acts"]
    assert len(acts) > 300 and acts == sorted(acts)
    (sentence,) = [sentence for name, sentence in acts if name == "hugs"]
    assert [act.act for act in read(sentence).acts] == ["hug"]


def test_runs_that_can_be_opened_are_listed() -> None:
    runs = (
        Entry(id="one", kind="generate", title="A hug", state="done"),
        Entry(id="two", kind="react", title="Broken", state="failed"),
    )
    asked: list[Any] = []
    history: Any = SimpleNamespace(search=lambda owner, wanted: asked.append(wanted.limit) or Found(runs, len(runs)))
    assert known(history)["runs"] == [["one", "A hug", "generate"]]
    assert asked and asked[0] <= 500
