"""Models of the settings on the page and in the API: a released checkpoint, a class, and a broken one."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from gradio_client import Client
from playwright.sync_api import Page, expect

from tests.inference.own.released_files import write_intergen
from tests.test_own_model_document import TABLE, TOY

SLOW = 200_000
TABLES = f"""{TABLE}
[models.authors]
method = "intergen"
label = "InterGen (authors)"
files = ["intergen.ckpt", "global_mean.npy", "global_std.npy", "bpe_simple_vocab_16e6.txt.gz"]

[models.broken]
pipeline = "nowhere.py:Broken"
"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory, start_server: Callable[..., str]) -> str:
    folder = tmp_path_factory.mktemp("lab")
    write_intergen(folder)
    (folder / "toy.py").write_text(TOY)
    (folder / "lab.toml").write_text(TABLES)
    environment = {"PASDEDEUX_SETTINGS": str(folder / "lab.toml"), "PASDEDEUX_DATA": str(folder / "data")}
    return start_server(["-m", "webdemo", "serve", "--port", "{port}"], env=environment)


def generate(page: Page, label: str, words: str) -> None:
    """Chooses a model, asks for a second of motion in few steps and waits until it plays."""
    page.locator("#way").get_by_text(label, exact=True).click()
    page.locator("#prompt textarea").fill(words)
    for slider, value in (("#seconds", "1"), ("#steps", "4")):
        field = page.locator(f"{slider} input[type=number]")
        if not field.is_visible():  # the advanced settings are folded
            page.locator("#advanced button").first.click()
        field.fill(value)
        field.press("Tab")
    page.locator("button#generate").click()
    expect(page.locator(".pdd-title").first).to_have_text(words, timeout=SLOW)
    expect(page.locator("button#cancel")).to_be_disabled(timeout=SLOW)


def test_models_of_the_settings_are_on_the_page_and_in_the_api(lab: str, open_page: Callable[..., Page]) -> None:
    page = open_page(lab)
    expect(page.locator("#way")).to_contain_text("InterGen (authors)", timeout=SLOW)
    assert "broken" not in page.locator("#way").inner_text()
    generate(page, "InterGen (authors)", "Two people wave to each other.")
    expect(page.locator("body")).to_contain_text("262 numbers")
    generate(page, "Toy twins", "Two people sway.")

    client = Client(lab, verbose=False)
    answer = client.predict(prompt="Two people sway.", seconds=1, model="toy", api_name="/generate")
    assert "toy" in str(answer)
    with pytest.raises(Exception, match=r"The model broken cannot be used"):
        client.predict(prompt="Two people sway.", seconds=1, model="broken", api_name="/generate")
