"""Public pages as strangers see them: made on the History tab, framed by another site."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import httpx
import pytest
from playwright.sync_api import expect

from tests.server.clients import FIELDS

from .plain import serve
from .serving import SLOW, live

pytestmark = pytest.mark.e2e
READY = "window.__pasdedeux?.player?.data"
FRAME = """<link rel="icon" href="data:,"><body><iframe src="{src}" width="480" height="400"></iframe>
<iframe src="{src}?theme=dark" sandbox="allow-scripts" width="480" height="400"></iframe></body>"""


def test_a_result_is_published_framed_and_ended(server: SimpleNamespace, open_page, tmp_path: Path) -> None:
    with httpx.Client(base_url=server.url, timeout=60) as client:
        called = client.post("gradio_api/call/generate", json={"data": ["They bow.", *FIELDS[1:]]}).json()
        assert "complete" in client.get(f"gradio_api/call/generate/{called['event_id']}").text
    page = live(open_page(server.url))
    page.get_by_role("tab", name="History").click()
    expect(page.locator("#history-notebook .pdn-card").first).to_contain_text("They bow.")
    page.locator("#history-publish").click()
    expect(page.locator("#sharing-link textarea, #sharing-link input")).to_have_value(
        re.compile(r"/share/[\w-]{24}$"), timeout=SLOW
    )
    address = page.locator("#sharing-link textarea, #sharing-link input").input_value()
    embed = address.replace("/share/", "/embed/")

    public = open_page(address, width=390, color_scheme="dark")
    public.wait_for_function(READY, timeout=SLOW)
    expect(public.locator("h1")).to_have_text("They bow.")
    assert public.evaluate("document.documentElement.scrollWidth") <= 390
    assert public.evaluate("document.body.classList.contains('dark')")

    (tmp_path / "frame.html").write_text(FRAME.format(src=embed))
    with serve(tmp_path) as site:
        frames = open_page(f"{site}frame.html")
        assert len(frames.frames) == 3
        for frame in frames.frames[1:]:  # the second has no origin of its own
            frame.wait_for_function(READY, timeout=SLOW)

    page.locator("#sharing-end").click()
    expect(page.locator("#history-status")).to_contain_text("has ended")
    assert httpx.get(address).status_code == 404
