"""The page in another language: the browser's own, or the one that the address asks for."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from .serving import SLOW

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
