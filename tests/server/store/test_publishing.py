"""Public pages: whose runs may be on one, what is on it then, and when it ends."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import update

from motion import InputError
from tests.server.clients import DATABASES, database_url, drop_tables
from webdemo.server.store import publishing as module
from webdemo.server.store.database import Database, Published
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.publishing import Publishing

from .test_notebook import ME, OTHER, kept


@pytest.fixture(params=DATABASES)
def publishing(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Publishing]:
    database = Database(database_url(request.param, tmp_path))
    yield Publishing(Notebook(database, tmp_path / "motions", node="n"), days=30)
    drop_tables(database.engine)
    database.close()


def notebook(publishing: Publishing) -> Notebook:
    assert isinstance(publishing.history, Notebook)
    return publishing.history


def test_a_page_shows_the_chosen_runs_in_their_order_and_nothing_that_they_were_made_from(
    publishing: Publishing,
) -> None:
    one, two = (kept(notebook(publishing), words) for words in ("They bow.", "They hug."))
    notebook(publishing).describe(two, ME, title="A hug", note="private", tags="secret")
    page = publishing.publish(ME, [two, one, two], title="  Two \n acts ")
    assert (page.title, page.runs) == ("Two acts", 2) and page.until == pytest.approx(
        time.time() + 30 * 86_400, abs=60
    )
    shown = publishing.shown(page.key)
    assert {place: entry.title for place, entry in shown.entries.items()} == {1: "A hug", 2: "They bow."}
    opened = publishing.open(page.key, 2)
    assert opened.result.duets[0].num_frames == 30 and not opened.kept.people and opened.kept.original is None
    assert publishing.publish(ME, [two]).title == "A hug", "one run gives its page its name"
    assert [each.key for each in publishing.pages(ME)][-1] == page.key and not publishing.pages(OTHER)


def test_nobody_publishes_or_ends_what_is_anothers(publishing: Publishing) -> None:
    run = kept(notebook(publishing))
    for owner in (OTHER, ""):
        with pytest.raises(InputError, match="no such run in your history"):
            publishing.publish(owner, [run])
        with pytest.raises(InputError, match="no such run in your history"):
            publishing.results(owner, [run])
        page = publishing.publish(ME, [run])
        with pytest.raises(InputError, match="no such public page"):
            publishing.revoke(page.key, owner)
        assert publishing.shown(page.key).entries and not publishing.pages(owner)


def test_a_page_ends_when_it_is_revoked_or_its_time_is_over(publishing: Publishing) -> None:
    run = kept(notebook(publishing))
    revoked, late = publishing.publish(ME, [run]), publishing.publish(ME, [run], days=0.5)
    publishing.revoke(revoked.key, ME)
    with publishing.database.session.begin() as session:
        session.execute(
            update(Published).where(Published.key == late.key).values(until=Published.until - 43_201)
        )
    for key in (revoked.key, late.key, run, "x", "", "../" * 10, "é" * 20):
        with pytest.raises(InputError, match="or it has ended"):
            publishing.shown(key)
        with pytest.raises(InputError, match="or it has ended"):
            publishing.open(key, 1)
    assert not publishing.pages(ME) and not publishing.everybodys()
    publishing.clean()
    with publishing.database.session() as session:
        assert session.get(Published, late.key) is None


def test_a_removed_run_leaves_its_pages_and_comes_back_with_them(publishing: Publishing) -> None:
    one, two = (kept(notebook(publishing), words) for words in ("They bow.", "They hug."))
    page = publishing.publish(ME, [one, two])
    notebook(publishing).remove([one], ME)
    assert list(publishing.shown(page.key).entries) == [2] and publishing.pages(ME)[0].runs == 1
    with pytest.raises(InputError, match="or it has ended"):
        publishing.open(page.key, 1)
    notebook(publishing).restore([one], ME)
    assert list(publishing.shown(page.key).entries) == [1, 2]
    notebook(publishing).delete(one, ME)
    notebook(publishing).delete(two, ME)
    with pytest.raises(InputError, match="or it has ended"):
        publishing.shown(page.key)


def test_what_cannot_be_a_page_is_refused_with_a_sentence(
    publishing: Publishing, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = kept(notebook(publishing))
    for given, says in (
        ({"runs": []}, "1 to 60 runs"),
        ({"runs": [f"{n:016}" for n in range(61)]}, "not 61"),
        ({"runs": [run], "days": 31}, "up to 30 days here, not 31"),
        ({"runs": [run], "days": 0}, "up to 30 days"),
        ({"runs": [run], "days": float("nan")}, "up to 30 days"),
        ({"runs": [run], "title": "x" * 201}, "shorten it to 200"),
    ):
        with pytest.raises(InputError, match=says):
            publishing.publish(ME, **given)  # type: ignore[arg-type]
    monkeypatch.setattr(module, "MOST_PAGES", 1)
    publishing.publish(ME, [run])
    with pytest.raises(InputError, match="end one of them first"):
        publishing.publish(ME, [run])


def test_a_lab_without_public_pages_makes_none_and_shows_none(publishing: Publishing) -> None:
    run = kept(notebook(publishing))
    page = publishing.publish(ME, [run])
    publishing.days = 0
    with pytest.raises(InputError, match="makes no public pages"):
        publishing.publish(ME, [run])
    with pytest.raises(InputError, match="or it has ended"):
        publishing.shown(page.key)


def test_all_finished_runs_go_into_a_folder_of_pages(
    publishing: Publishing, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="no finished run"):
        publishing.results(ME)
    kept(notebook(publishing), "They bow.")
    kept(notebook(publishing), "They hug.")
    kept(notebook(publishing), "Not mine.", owner=OTHER)
    assert {each.entry.title for each in publishing.results(ME)} == {"They bow.", "They hug."}
    monkeypatch.setattr(module, "MOST_EXPORTED", 1)
    with pytest.raises(InputError, match="2 runs are too many"):
        publishing.results(ME)
