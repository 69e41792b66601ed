"""A live stream that is kept: an ordinary result, whatever the browser sends."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import InputError
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built
from webdemo.inference.requests.live import LONGEST, LiveTake
from webdemo.server.queue.recorder import title_of
from webdemo.ui.components.live import FARTHEST, take_of
from webdemo.ui.history import Entry, Opened
from webdemo.ui.tabs.actor import actor_source
from webdemo.ui.tabs.react import ReactTab

from .reacting import run


def sent(people: np.ndarray, **changed: Any) -> str:
    """A stream as the page packs it."""
    data = base64.b64encode(people.astype("<f4").tobytes()).decode()
    return json.dumps({"partner": "agent", "positions": data} | changed)


PEOPLE = walking(2.0).positions


def test_a_stream_becomes_a_result_with_readouts_and_files(tmp_path: Path) -> None:
    tab = built(ReactTab, tmp_path / "files")
    updates = run(tab, None, live=sent(PEOPLE))
    last = next(update for update in updates if "record" in update)
    result = last["record"].result
    np.testing.assert_array_equal(result.duets[0].positions, PEOPLE.astype(np.float32))
    assert result.duets[0].roles == ("actor", "reactor")
    assert result.readouts[0]["after"]["foot_skate"] is not None
    assert "Kept: 2.0 s live." in last["line"] and last["record"].prompt == "Live with Virtual agent"
    assert "Foot skate" in last["readouts"]
    tab.results.export(last["record"])
    assert list((tmp_path / "files").rglob("*.npz"))


def test_a_kept_stream_is_found_and_opened(tmp_path: Path) -> None:
    take = take_of(sent(PEOPLE))
    asked = take.to_dict()
    assert title_of(asked) == "Live with Virtual agent" == take.title
    assert title_of(asked | {"model": "gone"}) == "Live with gone"
    entry = Entry(id="x" * 20, kind=asked["kind"], title=take.title, state="done", request=asked)
    tab = built(ReactTab, tmp_path / "files")
    result = list(tab.page.engine.run(take))[-1]
    opened = Opened(entry=entry, result=result)
    np.testing.assert_array_equal(actor_source(opened).people[0].positions, take.actor.positions)
    found = tab.opened(opened)
    assert found[tab.record].result is result


def test_an_opened_minute_is_trimmed_to_what_a_network_takes(tmp_path: Path) -> None:
    minute = np.repeat(PEOPLE[:, :1], 1800, axis=1)
    take = take_of(sent(minute))
    tab = built(ReactTab, tmp_path / "files")
    result = list(tab.page.engine.run(take))[-1]
    entry = Entry(id="x" * 20, kind="react", title=take.title, state="done", request=take.to_dict())
    found = tab.opened(Opened(entry=entry, result=result))
    assert (found[tab.actor.end]["maximum"], found[tab.actor.end]["value"]) == (60.0, 10.0)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "damaged"),
        ("[", "damaged"),
        ("[" * 100_000, "damaged"),
        ("[]", "damaged"),
        ('{"partner": "agent"}', "damaged"),
        (sent(PEOPLE, positions="%%%"), "damaged"),
        (sent(PEOPLE, positions=base64.b64encode(b"1234567").decode()), "damaged"),
        (sent(PEOPLE * np.nan), "damaged"),
        (sent(PEOPLE + FARTHEST), "damaged"),
        (sent(np.zeros((2, round(30 * (LONGEST + 2)), 22, 3))), "damaged"),
        (sent(PEOPLE[:, :29]), "shorter than a second"),
        (sent(PEOPLE, partner="intergen"), "no live partner 'intergen'"),
    ],
)
def test_what_no_page_sends_is_refused_in_a_sentence(text: str | None, says: str) -> None:
    with pytest.raises(InputError, match=says):
        take_of(text)


def test_two_people_of_different_length_are_no_stream() -> None:
    actor, reactor = take_of(sent(PEOPLE)).actor, take_of(sent(PEOPLE[:, :40])).reactor
    with pytest.raises(InputError, match="the same number of frames"):
        LiveTake(model="agent", actor=actor, reactor=reactor)
