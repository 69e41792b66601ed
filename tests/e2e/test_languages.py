"""The page in another language: the browser's own, or the one that the address asks for."""

from __future__ import annotations

import re
from dataclasses import replace

from playwright.sync_api import Page, expect

from webdemo.inference.requests import GenerateRequest, Result
from webdemo.inference.verdicts import judged, note

from .serving import SLOW, ask, live, status

TABS = ("Erzeugen", "Szene", "Reagieren", "Vorhersagen", "Verlauf")
SEEN = {
    "Erzeugen": ("Was tun die beiden? (auf Englisch)", "Alle Beispiele", "Händedruck", "Stärke der Führung"),
    "Szene": ("Was geschieht nacheinander? (auf Englisch)", "Abschnitt hinzufügen", "Bereich neu erzeugen"),
    "Reagieren": ("A des letzten Ergebnisses", "Video oder Webcam …", "Live-Gegenüber …", "Verfahren"),
    "Vorhersagen": ("Die Vergangenheit endet bei (s)", "Letztes Ergebnis fortsetzen", "Vergleichen"),
    "Verlauf": ("Alle Aufgaben", "Alles exportieren oder importieren", "Öffentliche Seiten"),
}
"""Some of what each tab shows."""


def _ready(page: Page) -> None:
    page.set_default_timeout(SLOW)
    expect(page.locator("#model-state")).to_contain_text("Modell bereit", timeout=SLOW)


def _panel(page: Page, tab: str):
    page.get_by_role("tab", name=tab, exact=True).click()
    return page.locator("[role=tabpanel]:visible")


def test_every_tab_and_the_player_are_german_in_a_german_browser(open_page, server) -> None:
    page = open_page(server.url, locale="de-DE", width=1440, height=900)
    _ready(page)
    assert page.evaluate("document.documentElement.lang") == "de"
    for tab in TABS:
        panel = _panel(page, tab)
        for text in SEEN[tab]:
            expect(panel.get_by_text(text).first).to_be_attached()
    panel = _panel(page, "Erzeugen")
    expect(panel.locator("button#generate")).to_have_text("Erzeugen")
    player = panel.locator(".pdd")
    expect(player.get_by_role("button", name=re.compile("^(Abspielen|Anhalten)$"))).to_be_visible(
        timeout=SLOW
    )
    expect(player.get_by_role("button", name="Vollbild")).to_have_attribute("title", "Vollbild (Eingabe)")
    expect(player.locator(".pdd-time")).to_contain_text(re.compile(r"Bild \d+ von \d+"))
    assert "__i18n__" not in page.content().split("</head>")[1]
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Handlungen").fill("dämpfung")
    expect(page.locator(".pdq-row").first).to_contain_text("Dämpfung")
    page.keyboard.press("Enter")
    expect(page.locator("#damping input").first).to_be_focused(timeout=SLOW)
    wide = page.evaluate("document.documentElement.scrollWidth - innerWidth")
    assert wide <= 0, "German is longer, and does not fit"


def test_the_address_goes_before_the_language_of_the_browser(open_page, server) -> None:
    page = open_page(f"{server.url}?lang=de", width=390, height=844)
    _ready(page)
    expect(page.get_by_role("tab", name="Erzeugen")).to_be_visible()
    expect(page.locator("#prompt textarea")).to_be_visible()
    expect(page.locator(".pdd-empty-text, .pdd-time").last).to_be_attached()
    assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0


ENGLISH = re.compile(r"\b(the|and|is|are|of|to|with|not|at|step|apart|done|walks?|hugs?|waves?)\b", re.I)
"""Words that no German line has."""
PROMPT = "They hug. Then the second person waves slowly. The zorb blorps."


def _judging(run):
    """The stub's runs with verdicts on what they show, as the engine gives them."""

    def judging(request, cancel=None):
        for event in run(request, cancel):
            if isinstance(event, Result) and isinstance(request, GenerateRequest):
                found = judged(request, event)
                event = replace(found.result, notes=(note(found.rows),) if found.rows else ())
            yield event

    return judging


def _german(text: str) -> str:
    """A text, which must hold nothing English beside what a visitor wrote."""
    seen = text.replace(PROMPT, "")
    assert seen.strip(), "nothing is said"
    assert not ENGLISH.findall(seen), seen
    return seen


def test_what_the_server_says_is_german(open_page, server, monkeypatch) -> None:
    monkeypatch.setattr(server.engine, "run", _judging(server.engine.run))
    page = open_page(f"{server.url}?lang=de", width=1280, height=900)
    _ready(page)
    ask(page, PROMPT)
    _german(status(page, "done"))
    missed = _german(status(page, "warning"))
    assert "Nicht zu sehen: A und B umarmen sich" in missed
    chips = page.locator("#reading .pdr-chip")
    expect(chips).to_have_count(2)
    assert "umarmen sich" in _german(chips.first.inner_text())
    assert "winkt, langsam" in _german(chips.last.inner_text())
    _german(page.locator("#reading .pdr-unread").inner_text().replace("zorb", "").replace("blorps", ""))
    assert "Nicht zu sehen" in _german(page.locator("#player .pdd-told").text_content())
    page.evaluate("document.querySelectorAll('#readouts details').forEach((each) => (each.open = true))")
    figures = _german(page.locator("#readouts").inner_text())
    assert "Die beiden sind im Mittel" in figures and "Fußrutschen" in figures and "Laden" not in figures
    ask(page, " ")
    assert "Die Eingabe ist leer" in _german(status(page, "error"))
    for tab, button in (("Reagieren", "#react-generate"), ("Vorhersagen", "#predict-generate")):
        _panel(page, tab).locator(button).click()
        line = page.locator("[role=tabpanel]:visible .pd-error")
        expect(line).to_be_visible(timeout=SLOW)
        assert "Noch ist keine" in _german(line.inner_text())


def test_the_same_page_is_english_for_the_others(open_page, server) -> None:
    page = open_page(server.url)
    live(page)
    ask(page, PROMPT)
    assert status(page, "done").startswith("Done in ")
    expect(page.locator("#reading .pdr-chip").first).to_contain_text("hug")
    expect(page.locator("#readouts")).to_contain_text("The two are")
