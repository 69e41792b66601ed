"""Public pages: whose runs may be on one, what is on it then, and when it ends."""

from __future__ import annotations

import time

import pytest
from sqlalchemy import update

from motion import InputError
from webdemo.server.store.database import Share
from webdemo.server.store.notebook import Notebook

from .runs import ME, OTHER, kept


def test_a_page_shows_its_run_and_nothing_that_it_was_made_from(notebook: Notebook) -> None:
    run = kept(notebook, "They hug.")
    notebook.describe(run, ME, title="A hug", note="private", tags="secret")
    page = notebook.publish(run, ME)
    assert page.title == "A hug" and page.until == pytest.approx(time.time() + 30 * 86_400, abs=60)
    opened, until = notebook.open_page(page.key)
    assert opened.entry.title == "A hug" and until == page.until
    assert opened.result.duets[0].num_frames == 30 and not opened.kept.people
    assert [each.key for each in notebook.pages(ME)] == [page.key] and not notebook.pages(OTHER)


def test_nobody_publishes_or_ends_what_is_anothers(notebook: Notebook) -> None:
    run = kept(notebook)
    for owner in (OTHER, ""):
        with pytest.raises(InputError, match="no such run in your history"):
            notebook.publish(run, owner)
        page = notebook.publish(run, ME)
        with pytest.raises(InputError, match="no such public page"):
            notebook.end_page(page.key, owner)
        assert notebook.open_page(page.key)[0].entry.id == run and not notebook.pages(owner)


def test_a_page_ends_when_it_is_revoked_or_its_time_is_over(notebook: Notebook) -> None:
    run = kept(notebook)
    revoked, late = notebook.publish(run, ME), notebook.publish(kept(notebook, "They bow."), ME)
    assert notebook.publish(run, ME).key == revoked.key, "a run has one page"
    notebook.end_page(revoked.key, ME)
    with notebook.database.session.begin() as session:
        session.execute(update(Share).where(Share.key == late.key).values(until=Share.until - 30 * 86_401))
    for key in (revoked.key, late.key, run, "x", "", "../" * 10, "é" * 20):
        with pytest.raises(InputError, match="or it has ended"):
            notebook.open_page(key)
    assert not notebook.pages(ME)
    notebook._since -= 86_400
    notebook.clean()
    with notebook.database.session() as session:
        assert session.get(Share, late.key) is None


def test_a_removed_run_leaves_its_page_and_comes_back_with_it(notebook: Notebook) -> None:
    run = kept(notebook, "They bow.")
    page = notebook.publish(run, ME)
    notebook.remove([run], ME)
    with pytest.raises(InputError, match="or it has ended"):
        notebook.open_page(page.key)
    assert not notebook.pages(ME)
    notebook.restore([run], ME)
    assert notebook.open_page(page.key)[0].entry.id == run
    notebook.delete(run, ME)
    with pytest.raises(InputError, match="or it has ended"):
        notebook.open_page(page.key)
