"""The Scene tab in a browser: a story is laid out, made, changed in place, undone, and a span is made again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect

from .playing import settled_box
from .serving import live

pytestmark = pytest.mark.slow
TIMEOUT = 30_000


@pytest.fixture(scope="module")
def scene(lab: str, kept_tabs: Any) -> Any:
    """The tab Scene, which the tests share."""
    page = live(kept_tabs.open(lab, width=1300, height=1500))
    page.set_default_timeout(TIMEOUT)
    page.get_by_role("tab", name="Scene").click()
    return page


@pytest.fixture
def page(scene: Any, kept_tabs: Any) -> Iterator[Any]:
    """The same, watched for errors in each test."""
    yield scene
    kept_tabs.check()


def story(page: Any) -> dict[str, Any]:
    return page.evaluate("document.querySelector('.pds').editor.story")


def rest(page: Any) -> None:
    """Waits until a run is over."""
    page.wait_for_selector("#scene-remake:not([disabled])")
    page.wait_for_selector("#scene-status .pd-done")


def test_a_story_from_sentence_to_futures(page: Any) -> None:
    expect(page.locator("#scene-remake")).to_be_hidden()  # there is no motion to make a part of
    page.locator("#scene-prompt textarea").fill("They meet. Then they hug. Finally they bow.")
    page.locator("#scene-generate").click()
    page.wait_for_selector("#scene-status .pd-done")
    page.wait_for_selector(".pds-cell")
    assert page.locator(".pds-lane-words .pds-cell").all_inner_texts() == ["They meet.", "They hug.", "They bow."]
    assert page.locator(".pds-scroll").evaluate("each => each.scrollWidth === each.clientWidth")

    # The player's clock stands over the story's line, and both are as long.
    page.wait_for_function("document.querySelector('.pds').editor.shown === window.__pasdedeux.player.clock.duration")
    clock, line = (page.locator(part).bounding_box() for part in (".pdd-range:visible", ".pds-line"))
    assert clock and line and abs(clock["x"] + 7 - line["x"]) < 3 and abs(clock["width"] - 14 - line["width"]) < 4

    def words() -> list[str]:
        return [beat["words"] for beat in story(page)["beats"]]

    # Words are written in place.
    page.locator('.pds-cell[data-beat="1"][data-lane="b"]').click()
    page.locator(".pds-words").fill('waves "hello"')
    page.keyboard.press("Enter")
    assert story(page)["beats"][1]["b"] == 'waves "hello"'
    page.wait_for_function("document.querySelector('.pds').editor.story.beats[1].auto > 0")
    # Moved, split, deleted, undone and redone.
    page.get_by_role("button", name="Move the beat to the right").click()
    assert words() == ["They meet.", "They bow.", "They hug."]
    page.get_by_role("button", name="Split").click()
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").click()
    assert words() == ["They meet.", "They hug.", "They bow."]
    page.get_by_role("button", name="Redo").click()
    assert words() == ["They meet.", "They bow.", "They hug."]
    page.get_by_role("button", name="Add beat").click()
    page.keyboard.press("Enter")
    assert "They look at each other." in words(), "a beat has words from the start"
    page.get_by_role("button", name="Undo", exact=True).click()
    # A beat is stretched from the keyboard.
    page.locator(".pds [data-field=seconds]").fill("6.5")
    page.keyboard.press("Tab")
    assert 6.5 in [beat["seconds"] for beat in story(page)["beats"]]
    # A story whose end meets its beginning, undone.
    page.locator(".pds [data-field=loop]").check()
    assert story(page)["loop"] is True
    page.get_by_role("button", name="Undo", exact=True).click()
    assert not page.locator(".pds [data-field=loop]").is_checked() and not story(page)["loop"]
    # A span is selected on the ruler and made again, and three futures follow.
    ruler = page.locator(".pds-ruler").bounding_box()
    page.mouse.move(ruler["x"] + 30, ruler["y"] + 10)
    page.mouse.down()
    page.mouse.move(ruler["x"] + 200, ruler["y"] + 10, steps=4)
    page.mouse.up()
    first, last = story(page)["span"]
    assert last - first >= 0.5
    whole = page.evaluate("window.__pasdedeux.player?.data?.id")
    page.locator("#scene-remake").click()
    page.wait_for_function(f"window.__pasdedeux?.player?.data?.id !== {whole!r}")
    rest(page)
    page.evaluate("window.__pasdedeux.player.act('pause'); window.__pasdedeux.player.seek(60)")
    page.wait_for_function("window.__pasdedeux?.frame === 60")  # they begin at what is shown
    page.locator("#scene-futures").click()
    page.wait_for_function("window.__pasdedeux?.player?.data?.samples.length === 3")
    rest(page)
    # Each has a tab of the player, and the one that is shown is taken.
    page.locator("#scene-player .pdd-tabs [role=tab]").nth(1).click()
    page.wait_for_function("window.__pasdedeux.player.sampleIndex === 1")
    page.locator("#scene-take").click()
    page.wait_for_function("window.__pasdedeux?.player?.data.samples.length === 1")
    assert "number 2" in page.locator("#scene-status").inner_text()
    expect(page.locator("#scene-take")).to_be_hidden()


def test_a_dragged_hand_becomes_a_pose_that_the_motion_passes_through(page: Any) -> None:
    page.locator("#scene-prompt textarea").fill("They meet. Then they hug.")
    page.locator("#scene-generate").click()
    page.wait_for_selector("#scene-generate[disabled]")
    rest(page)
    page.wait_for_function("window.__pasdedeux?.player?.data?.samples.length === 1")
    page.wait_for_function("document.querySelectorAll('.pds-lane-words .pds-cell').length === 2")
    page.evaluate("window.__pasdedeux.player.act('pause'); window.__pasdedeux.player.seek(60)")
    page.wait_for_function("window.__pasdedeux?.frame === 60")
    page.locator(".pdd:visible").focus()
    page.keyboard.press("e")
    handle = page.locator('.pdd-handle[data-person="0"][data-joint="21"]')
    box = settled_box(handle)
    page.mouse.move(box["x"] + 15, box["y"] + 15)
    page.mouse.down()
    page.mouse.move(box["x"] + 40, box["y"] - 60, steps=6)
    page.mouse.up()
    page.wait_for_timeout(500)  # until what was dragged is drawn
    wanted = np.array(page.evaluate("window.__pasdedeux.positions[0]"))
    page.keyboard.press("Enter")
    (pose,) = story(page)["poses"]
    assert (pose["person"], pose["seconds"]) == ("a", 2.0)
    assert np.abs(np.array(pose["positions"]) - wanted).max() < 1e-4
    assert story(page)["span"] == [1.0, 3.0]
    # Its pin is moved with the keys, undone.
    pin = page.locator(".pds-lane-a .pds-pin")
    pin.focus()
    page.keyboard.press("Shift+ArrowRight")
    undo, redo = (page.get_by_role("button", name=name, exact=True).last for name in ("Undo", "Redo"))

    def pinned(seconds: float) -> bool:
        """The pose, as it was kept, and its pin are at a moment."""
        (pose,) = story(page)["poses"]
        seen = page.evaluate(
            "parseFloat(document.querySelector('.pds-pin').style.left) / 100 *"
            " document.querySelector('.pds').editor.total"
        )
        assert np.abs(np.array(pose["positions"]) - wanted).max() < 1e-4
        return pose["seconds"] == seconds and abs(seen - seconds) < 0.01

    def comes_back(seconds: float) -> bool:
        """The deleted pose is there again, once the page has answered."""
        page.wait_for_selector(".pds-pin")
        return pinned(seconds)

    assert pinned(2.3333)
    undo.click()
    assert pinned(2.0) and redo.is_enabled()
    redo.click()
    assert pinned(2.3333) and redo.is_disabled()
    undo.click()
    pin.focus()
    page.keyboard.press("ArrowRight")
    assert redo.is_disabled(), "another change ends what could be redone"
    page.keyboard.press("ArrowRight")
    assert pinned(2.0667)
    for keys, seconds in (("z", 2.0333), ("z", 2.0), ("Shift+z", 2.0333), ("Shift+z", 2.0667)):
        page.keyboard.press(f"Control+{keys}")
        assert pinned(seconds), "the focus stays on the pin, from where it is undone and redone by keys"
    undo.click()
    undo.click()
    undo.click()
    assert story(page)["poses"] == [] and page.locator(".pds-pin").count() == 0
    for _ in range(3):
        redo.click()
    assert pinned(2.0667)
    page.evaluate("window.__pasdedeux.player.seek(0)")
    pin.click()
    page.wait_for_function("window.__pasdedeux?.frame === 62")
    # The span is made again, and the motion passes through the pose.
    page.locator("#scene-remake").click()
    page.wait_for_selector("#scene-remake[disabled]")
    rest(page)
    page.evaluate("window.__pasdedeux.player.act('pause'); window.__pasdedeux.player.seek(62)")
    page.wait_for_function("window.__pasdedeux?.frame === 62 && window.__pasdedeux?.loops === 0")
    made = np.array(page.evaluate("window.__pasdedeux.positions[0]"))
    assert np.linalg.norm(made - wanted, axis=-1).max() < 0.03
    pin.focus()
    page.keyboard.press("Delete")
    assert story(page)["poses"] == []
    undo.click()
    assert comes_back(2.0667)
    later = """(() => {
        const { editor } = document.querySelector(".pds"), { beats } = editor.story;
        editor.measure(beats.map((beat) => beat.auto + 1));
        return [editor.story, editor.given].map((story) => JSON.stringify(story.poses));
    })()"""
    shown, sent = page.evaluate(later)
    assert shown == sent, "what is sent is what is shown, also where beats were measured anew"


def test_words_and_beats_follow_each_other(page: Any) -> None:
    words, cells = page.locator("#scene-prompt textarea"), page.locator(".pds-lane-words .pds-cell")
    words.fill("They bow. Then they hug.")
    words.blur()
    page.wait_for_function("document.querySelectorAll('.pds-lane-words .pds-cell').length === 2")
    page.set_viewport_size({"width": 390, "height": 844})
    cells.nth(1).click()
    field, line = (page.locator(each).bounding_box() for each in (".pds-words", ".pds-scroll"))
    assert field["x"] + field["width"] <= line["x"] + line["width"], "on a phone, the last beat's words are in view"
    page.locator(".pds-words").fill("They wave.")
    page.keyboard.press("Enter")
    page.wait_for_function("document.querySelector('#scene-prompt textarea').value === 'They bow. They wave.'")
    words.click()
    page.keyboard.press("End")
    page.keyboard.type(" They nod.")
    page.wait_for_function("!document.querySelector('.pds').editor.story.ahead")
    words.blur()
    page.wait_for_function("document.querySelectorAll('.pds-lane-words .pds-cell').length === 3")
    assert cells.all_inner_texts() == ["They bow.", "They wave.", "They nod."]
