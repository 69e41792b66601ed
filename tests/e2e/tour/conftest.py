"""A visit to what ``python app.py`` serves, with the shipped networks: every control of every tab is used twice.

Nothing may be refused, no error may be shown, no script may fail, and the server's log may tell of no error.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from tests.motion.formats.characters import a_pose, glb_character

from ..conftest import FLAGS, Tabs
from ..test_camera import FILM, as_mjpeg
from .hands import STILL
from .touring import SLOW, Tour


@pytest.fixture(scope="module")
def tour(_app: SimpleNamespace) -> Tour:
    return Tour(_app.log)


@pytest.fixture(scope="module")
def visit(chromium, lab: str, tour: Tour, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimpleNamespace]:
    """The page in a browser with a webcam, which shows a film of a person waving."""
    film = as_mjpeg(FILM, tmp_path_factory.mktemp("film") / "wave.mjpeg")
    flags = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream"]
    flags.append(f"--use-file-for-fake-video-capture={film}")
    browser = chromium.browser_type.launch(executable_path=shutil.which("chromium"), args=[*FLAGS, *flags])
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    tabs = Tabs(browser, context)
    page = tabs.open(lab, before=tour.watch, width=1200, height=900)
    page.set_default_timeout(SLOW)
    expect(page.locator("#model-state")).to_contain_text("Model ready", timeout=SLOW)
    yield SimpleNamespace(page=page, tabs=tabs)
    browser.close()


@pytest.fixture
def page(request: pytest.FixtureRequest, visit: SimpleNamespace, tour: Tour) -> Iterator[Page]:
    """The page, on which nothing may go wrong but the refusals that a module's ``EXPECTED`` names."""
    yield visit.page
    visit.page.evaluate(STILL)
    wrong = tour.wrong[:]
    tour.wrong.clear()
    assert not wrong, f"the page told of errors: {wrong}"
    visit.tabs.check(getattr(request.module, "EXPECTED", ()))
    assert tour.errors_in_log() == []


@pytest.fixture(scope="module")
def character(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rigged character of somebody else's."""
    file = tmp_path_factory.mktemp("character") / "x.glb"
    file.write_bytes(glb_character("unreal", places=a_pose()))
    return file
