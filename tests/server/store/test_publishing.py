"""Public pages: whose runs may be on one, what is on it then, and when it ends."""

from __future__ import annotations

import time

import pytest
from sqlalchemy import update

from motion import InputError
from webdemo.server.store.database import Published
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.publishing import Publishing

from .test_notebook import ME, OTHER, kept


@pytest.fixture
def publishing(notebook: Notebook) -> Publishing:
    return Publishing(notebook, days=30)


def test_a_page_shows_its_run_and_nothing_that_it_was_made_from(publishing: Publishing) -> None:
    run = kept(publishing.history, "They hug.")
    publishing.history.describe(run, ME, title="A hug", note="private", tags="secret")
    page = publishing.publish(ME, run)
    assert page.title == "A hug" and page.until == pytest.approx(time.time() + 30 * 86_400, abs=60)
    opened, until = publishing.open(page.key)
    assert opened.entry.title == "A hug" and until == page.until
    assert opened.result.duets[0].num_frames == 30 and not opened.kept.people
    assert [each.key for each in publishing.pages(ME)] == [page.key] and not publishing.pages(OTHER)


def test_nobody_publishes_or_ends_what_is_anothers(publishing: Publishing) -> None:
    run = kept(publishing.history)
    for owner in (OTHER, ""):
        with pytest.raises(InputError, match="no such run in your history"):
            publishing.publish(owner, run)
        page = publishing.publish(ME, run)
        with pytest.raises(InputError, match="no such public page"):
            publishing.revoke(page.key, owner)
        assert publishing.open(page.key)[0].entry.id == run and not publishing.pages(owner)


def test_a_page_ends_when_it_is_revoked_or_its_time_is_over(publishing: Publishing) -> None:
    run = kept(publishing.history)
    revoked, late = publishing.publish(ME, run), publishing.publish(ME, kept(publishing.history, "They bow."))
    assert publishing.publish(ME, run).key == revoked.key, "a run has one page"
    publishing.revoke(revoked.key, ME)
    with publishing.database.session.begin() as session:
        session.execute(update(Published).where(Published.key == late.key).values(until=Published.until - 30 * 86_401))
    for key in (revoked.key, late.key, run, "x", "", "../" * 10, "é" * 20):
        with pytest.raises(InputError, match="or it has ended"):
            publishing.open(key)
    assert not publishing.pages(ME)
    publishing.history._since -= 86_400
    publishing.clean()
    with publishing.database.session() as session:
        assert session.get(Published, late.key) is None


def test_a_removed_run_leaves_its_page_and_comes_back_with_it(publishing: Publishing) -> None:
    run = kept(publishing.history, "They bow.")
    page = publishing.publish(ME, run)
    publishing.history.remove([run], ME)
    with pytest.raises(InputError, match="or it has ended"):
        publishing.open(page.key)
    assert not publishing.pages(ME)
    publishing.history.restore([run], ME)
    assert publishing.open(page.key)[0].entry.id == run
    publishing.history.delete(run, ME)
    with pytest.raises(InputError, match="or it has ended"):
        publishing.open(page.key)
