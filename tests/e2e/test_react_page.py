"""The React tab in a real browser, with an engine that needs no networks."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from motion.formats import write
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_takes
from tests.ui.stub_engine import walking
from webdemo.inference.methods import automatic, method

from .playing import choose, give_file, unfold
from .serving import live

pytestmark = pytest.mark.e2e

PAUSE = 0.01


@pytest.fixture
def page(shared_page: Page) -> Page:
    return live(shared_page, "React")


def people(page: Page, count: int) -> None:
    page.wait_for_function(f"window.__pasdedeux?.positions?.length === {count}")


def test_an_uploaded_person_is_seen_trimmed_and_gets_a_partner(page: Page, tmp_path: Path) -> None:
    """It comes first, on a page where nothing was chosen yet."""
    expect(page.locator("#react-status")).to_contain_text("Push: 5.0 s")  # the example that it opens with
    give_file(page, "#react-file", write(walking(12.0), tmp_path / "walkers.npz")[0])
    expect(page.locator("#react-status")).to_contain_text("0.0 to 10.0 s of 12.0 s")
    page.fill("#react-end input[type=number]", "3")
    page.press("#react-end input[type=number]", "Tab")
    expect(page.locator("#react-status")).to_contain_text("0.0 to 3.0 s")

    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-done")).to_be_visible()
    people(page, 2)
    expect(page.locator("#react-readouts")).to_contain_text("walkers.npz")
    unfold(page, "#react-downloads")
    button = page.locator("#react-download-npz")
    expect(button).to_be_enabled()

    page.click("button#react-take")
    people(page, 1)
    expect(page.locator("#react-status")).to_contain_text(": 3.0 s")
    page.locator("#react-person").get_by_text("Person B").click()
    expect(page.locator("#react-player .pdd-title")).to_contain_text("person B")


def test_another_animation_of_a_character_is_chosen(page: Page, tmp_path: Path) -> None:
    positions, rotations = marching(60)
    file = tmp_path / "takes.glb"
    file.write_bytes(glb_takes(rotations, positions[:, 0], ["walk", "glide"]))
    give_file(page, "#react-file", file)
    expect(page.locator("#react-status")).to_contain_text("1 (“walk”) was taken")
    choose(page, "#react-animation", "2 · glide")
    expect(page.locator("#react-status")).to_contain_text("2 (“glide”) was taken")
    expect(page.locator("#react-animation input")).to_have_value("2 · glide")


def test_a_file_that_cannot_be_read_leaves_nothing_and_a_result_is_taken(page: Page, tmp_path: Path) -> None:
    broken = tmp_path / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT hips\n{")
    page.get_by_role("button", name="Wave", exact=True).last.click()
    people(page, 1)
    expect(page.locator("#react-import")).to_be_hidden()  # of an example nothing had to be found
    give_file(page, "#react-file", broken)
    expect(page.locator("#react-status .pd-error")).to_contain_text("broken.bvh")
    expect(page.locator("#react-player .pdd-empty")).to_be_visible()
    expect(page.locator("#react-import")).to_be_hidden()
    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-error")).to_contain_text("Nobody is given yet")

    page.get_by_role("tab", name="Generate").click()
    page.fill("#prompt textarea", "two people walk.")
    page.click("button#generate")
    expect(page.locator("#status .pd-done")).to_be_visible()
    page.get_by_role("tab", name="React").click()
    expect(page.locator("#react-status")).to_contain_text("two people walk: 5.0 s")


def test_automatic_chooses_by_the_words_and_a_method_greys_those_it_does_not_hear(
    page: Page, server: SimpleNamespace, tmp_path: Path
) -> None:
    player = page.locator("#react-player")
    unfold(page, "#react-advanced")
    expect(page.locator("#react-method input")).to_have_value("Automatic")
    give_file(page, "#react-file", write(walking(3.0).a, tmp_path / "walker.npz")[0])
    expect(page.locator("#react-status")).to_contain_text("walker.npz: 3.0")
    assert player.locator(".pdd-label").all_text_contents() == ["A · given"]
    for words, title, model in (
        ("", "Reaction to walker.npz", automatic("", "a").name),
        ("They shake hands.", "They shake hands.", "intergen"),
    ):
        page.fill("#react-prompt textarea", words)
        page.click("button#react-generate:enabled")
        expect(player.locator(".pdd-title")).to_have_text(title)
        assert server.engine.requests[-1].model == model
    assert player.locator(".pdd-label").all_text_contents() == ["A · given", "B · generated"]
    expect(page.locator("button#react-generate")).to_be_enabled()
    choose(page, "#react-method", "Virtual agent")
    expect(page.locator("#react-prompt textarea")).to_be_disabled()
    expect(page.locator("#react-about")).to_contain_text(method("agent").summary)


def test_methods_are_compared_side_by_side(page: Page, server: SimpleNamespace, tmp_path: Path) -> None:
    give_file(page, "#react-file", write(walking(2.0).a, tmp_path / "walker.npz")[0])
    expect(page.locator("#react-status")).to_contain_text("walker.npz: 2.0")
    page.click("button#react-generate")
    people(page, 2)
    unfold(page, "#react-grid")
    choose(page, "#react-grid-across", "Methods")
    page.fill("#react-grid-across-values textarea", "InterGen, person to person; ReGenNet, online")
    page.click("#react-grid-make")
    expect(page.locator("#react-status .pd-done")).to_contain_text("2 results done")
    people(page, 4)
    names = page.locator("#react-player .pdd-cell-text")
    expect(names).to_have_text(["InterGen, person to person", "ReGenNet, online"])
    page.click("button#react-take")
    people(page, 1)
    expect(names).to_have_count(0)
