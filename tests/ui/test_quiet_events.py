"""The page's own events leave nothing behind beside what they change, neither in the browser nor in the server."""

from typing import Any

import pytest

from tests.ui.stub_engine import StubEngine
from tests.ui.stub_page import stub_context
from webdemo.ui.page import ENDPOINTS, build_page


def test_no_event_of_the_page_marks_the_state_of_a_run_at_components() -> None:
    """Gradio would note it at every output once an update, a quarter of a core while a run goes on."""
    page = build_page(stub_context(StubEngine()))
    marking = [
        (fn.api_name, [block.elem_id for block in fn.outputs])
        for fn in page.fns.values()
        if fn.outputs and fn.show_progress_on != []
    ]
    assert len(marking) == len(ENDPOINTS), f"only the endpoints, which no browser calls: {marking}"


def test_no_statistics_are_made_of_events(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gradio would sum up all earlier events after each one, in a thread beside the run."""
    queue: Any = build_page(stub_context(StubEngine()))._queue
    monkeypatch.setattr(queue, "_get_df", lambda records: pytest.fail("statistics were made"))
    queue.events_recorded = 1000
    assert queue.compute_analytics_summary([{"function": "run"}]) == {"functions": {}}
