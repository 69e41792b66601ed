"""What is understood of a prompt is shown under it as it is typed."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from .serving import live

pytestmark = pytest.mark.e2e

HOSTILE = "A bows while B waves <img src=x onerror=alert(1)>."


@pytest.fixture
def page(lab: str, open_page: Callable[..., Page]) -> Page:
    """The page that ``python app.py`` serves, on a phone, once it answers."""
    return live(open_page(lab, width=390, height=844))


def test_words_are_underlined_and_chips_stand_on_two_lanes(page: Page) -> None:
    prompt, reading = page.locator("#prompt textarea"), page.locator("#reading .pdr")
    expect(reading).to_be_hidden()
    prompt.press_sequentially("A bows to B. Then they hug.", delay=20)
    expect(reading.locator(".pdr-beat")).to_have_count(2)
    lanes = {
        chip.get_attribute("data-id"): chip.evaluate("chip => getComputedStyle(chip).gridColumnStart")
        for chip in reading.locator(".pdr-chip").all()
    }
    assert lanes == {"1": "1", "2": "1"}
    expect(reading.locator(".pdr-chip").nth(1)).to_have_class("pdr-chip pdr-ab")
    expect(reading.locator("button.pdr-chip").nth(1)).to_have_accessible_name(
        "A and B: hug each other. Press to change."
    )
    expect(reading.get_by_role("status")).to_have_text("Acts understood: 2.")
    expect(reading.locator(".pdr-words.pdr-a.pdr-b")).to_contain_text("they hug")
    lines = "each => [getComputedStyle(each).textDecorationStyle, getComputedStyle(each).borderBottomStyle]"
    assert reading.locator(".pdr-words").last.evaluate(lines) == ["solid", "dashed"], (
        "people are told apart by their lines, not by colour alone"
    )
    length, seconds = reading.locator(".pdr-length"), page.locator("#seconds input[type=number]")
    expect(seconds).to_have_value("7")
    expect(length).to_be_hidden()
    seconds.fill("5")
    seconds.blur()
    expect(length).to_contain_text("The acts take about 7 s, and the motion lasts 5 s.")
    length.get_by_role("button", name="Make it 7 s").click()
    expect(length).to_be_hidden()
    expect(seconds).to_have_value("7")
    prompt.fill(HOSTILE)
    expect(reading.locator(".pdr-chip.pdr-b")).to_contain_text("waves")
    expect(reading.locator(".pdr-said")).to_have_text(HOSTILE)
    assert reading.locator("img").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    prompt.fill("")
    expect(reading).to_be_hidden()


def test_a_motion_is_as_long_as_its_acts_where_enter_follows_the_last_letter(page: Page) -> None:
    prompt, seconds = page.locator("#prompt textarea"), page.locator("#seconds input[type=number]")
    page.wait_for_function("document.querySelector('#reading .pdr')?.view")
    runs = []
    page.on("request", lambda sent: "queue/join" in sent.url and '"intergen"' in sent.post_data and runs.append(sent))
    for sentence, length in (("A bows to B. Then they hug.", 7), ("They hug.", 5)):
        prompt.fill(sentence)
        prompt.press("Enter")
        prompt.press("Enter")  # dropped, as one is while a run goes on
        expect(page.locator("#status")).to_contain_text("Made")
        expect(seconds).to_have_value(str(length))
        expect(page.locator("#readouts")).to_contain_text(f"{length}.0 s")
        expect(page.locator("#generate")).to_be_enabled()
    assert len(runs) == 2


def test_a_plan_is_edited_and_made(lab: str, open_page: Callable[..., Page]) -> None:
    page = live(open_page(lab, width=1200, height=1000))
    reading, chips = page.locator("#reading .pdr"), page.locator("#reading .pdr-chip")
    page.fill("#prompt textarea", "A waves to B. Then B bows. Then they hug.")
    expect(chips).to_have_count(3)
    expect(reading.locator(".pdr-badge")).to_be_hidden()
    # Deleted with the keyboard, and the next chip is at hand.
    chips.nth(1).focus()
    page.keyboard.press("Delete")
    expect(chips).to_have_count(2)
    expect(reading.locator(".pdr-badge")).to_be_visible()
    expect(chips.nth(1)).to_be_focused()
    # The other person's.
    chips.nth(0).press("Enter")
    reading.get_by_role("button", name="Other person").click()
    expect(chips.nth(0)).to_contain_text("B → A waves")
    reading.get_by_role("button", name="Close").click()
    expect(chips.nth(0)).to_be_focused()
    page.click("button#generate")
    expect(page.locator("#status .pd-done").first).to_be_visible()
    made = page.evaluate("document.querySelector('#reading .pdr').view.draft.plan.acts.map((act) => act.act)")
    assert made == ["wave", "hug"]
    expect(chips.nth(0).locator(".pdr-check")).to_be_visible()
    assert page.locator("#reading .pdr-check").first.inner_text()[0] in "✓✗"
    # What happens is told under the stage, to screen readers as well.
    told = page.locator("#player .pdd-told[role=status]")
    expect(told).to_contain_text(re.compile("B waves.*they hug"))
    # A change of the motion that is shown is made at once.
    chips.nth(0).press("Enter")
    reading.get_by_role("button", name="Other person").click()
    expect(told).to_contain_text(re.compile("A waves.*they hug"))
    expect(page.locator("#generate")).to_be_enabled()
    # Words that are typed are read anew, and the page says what that does.
    page.locator("#prompt textarea").press_sequentially(" B nods.")
    expect(reading.locator(".pdr-badge")).to_be_hidden()
    expect(chips).to_have_count(4)
    expect(reading.locator(".pdr-notes")).to_contain_text("Your edits were dropped")
    # Also where they are the same again before they were read.
    chips.nth(3).focus()
    page.keyboard.press("Delete")
    expect(chips).to_have_count(3)
    expect(reading.locator(".pdr-badge")).to_be_visible()
    page.evaluate("""(() => {
        const { view } = document.querySelector("#reading .pdr"), { text } = view.asking;
        for (const typed of [text + " ", text]) view.typed(typed);
    })()""")
    expect(chips).to_have_count(4)
    # An edit that the server refuses is taken back, and it is said why.
    chips.nth(3).focus()
    page.keyboard.press("Delete")
    expect(reading.locator(".pdr-badge")).to_be_visible()
    refused = """(() => {
        const { view } = document.querySelector("#reading .pdr"), { text } = view.asking;
        view.sync({ text, shown: { text, number: view.number, edited: true, error: "Too many acts." } });
        return [view.note, view.draft.plan.acts.length];
    })()"""
    note, acts = page.evaluate(refused)
    assert note == "Too many acts." and acts >= 3
