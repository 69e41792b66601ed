"""The server says whether it is well: health, figures and logs."""

from __future__ import annotations

import gc
import json
import logging
import re
import time
import traceback
from typing import Any

import gradio as gr
import pytest
from fastapi.testclient import TestClient
from prometheus_client.parser import text_string_to_metric_families

from tests.server.clients import FIELDS, JOIN, answer_of, events_of, lab_of, wait_for
from tests.server.lab import stub_module
from webdemo.inference import GenerateRequest
from webdemo.server.http.health import Health
from webdemo.server.logs import JsonLines, log_instead_of_printing

CRASH = ["crash", *FIELDS[1:5], 3, *FIELDS[6:]]
"""What the stub breaks at."""


def test_ready_when_a_generation_works(local: TestClient) -> None:
    until = time.monotonic() + 60
    while (answer := local.get("/healthz")).status_code != 200:
        assert time.monotonic() < until
        time.sleep(0.05)
    names = ("database", "disk", "generation", "progress")
    assert answer.json() == {"status": "ready", "checks": dict.fromkeys(names, "ok")}
    lab_of(local).health.broken(RuntimeError())
    answer = local.get("/healthz")
    assert answer.status_code == 503 and "RuntimeError" in answer.json()["checks"]["generation"]
    lab_of(local).health._tried_at -= 100
    local.get("/healthz")
    while local.get("/healthz").status_code != 200:
        assert time.monotonic() < until
        time.sleep(0.05)


def test_nobody_looks_for_garbage_in_what_has_loaded() -> None:
    """Among the objects of the networks that took 0.3 s, in which nothing was answered."""
    loaded: list[Any] = [[]]
    assert any(kept is loaded for kept in gc.get_objects())
    Health(stub_module().StubEngine())._try()
    assert not any(kept is loaded for kept in gc.get_objects())
    gc.unfreeze()


def samples(client: TestClient) -> dict[str, dict[tuple[tuple[str, str], ...], float]]:
    """What Prometheus would read: values by name, then by labels."""
    found: dict[str, dict[tuple[tuple[str, str], ...], float]] = {}
    for family in text_string_to_metric_families(client.get("/metrics").text):
        for sample in family.samples:
            found.setdefault(sample.name, {})[tuple(sorted(sample.labels.items()))] = sample.value
    return found


def test_every_figure_is_there_and_counts(local: TestClient) -> None:
    before = samples(local)
    answer_of(events_of(local, "generate", FIELDS))
    assert "event: error" in events_of(local, "generate", CRASH)
    model = GenerateRequest.model
    wait_for(lambda: not lab_of(local).queue.running)
    after = samples(local)

    def more(name: str, **labels: str) -> float:
        key = tuple(sorted(labels.items()))
        return after[name][key] - before.get(name, {}).get(key, 0.0)

    call = "/gradio_api/call/{api_name}"  # never what somebody wrote
    assert more("pasdedeux_http_requests_total", route=call, method="POST", status="200") == 2
    assert more("pasdedeux_http_seconds_count", route=f"{call}/{{event_id}}") == 2
    assert more("pasdedeux_http_requests_total", route="/metrics", method="GET", status="200") == 1
    assert more("pasdedeux_runs_total", model=model, outcome="done") == 1
    assert more("pasdedeux_runs_total", model=model, outcome="failed") == 1
    assert more("pasdedeux_errors_total", kind="RuntimeError") >= 1
    assert more("pasdedeux_stage_seconds_count", model=model, stage="queue") == 2
    stages = {dict(key)["stage"] for key in after["pasdedeux_stage_seconds_count"]}
    assert stages >= {"queue", "text", "sampling", "finish"}
    for gauge in ("queue_waiting", "queue_running", "ready"):
        assert () in after[f"pasdedeux_{gauge}"]
    assert after["process_resident_memory_bytes"][()] > 10 * 2**20


def test_an_error_is_found_in_the_log_by_its_id(local: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    """The page's sentence names the request; the log says under that name where the error came from."""
    with caplog.at_level(logging.INFO):
        said = events_of(local, "generate", CRASH)
    reference = re.search(r"its log says more under ([0-9a-f]{12})", said)
    assert reference is not None
    lines = [json.loads(JsonLines().format(record)) for record in caplog.records]
    (line,) = [line for line in lines if "error" in line and line["message"] == "A request failed."]
    assert line["request"] == reference[1] and line["error"] == "RuntimeError"
    assert any("stub_engine.py" in place for place in line["where"])
    assert "crash" not in json.dumps([line for line in lines if line["logger"].startswith("webdemo")])


def test_gradios_own_errors_hold_no_prompt(
    local: TestClient,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """It prints what it was sent, a line each: a forged line of the log among them."""
    forged = 'SECRET PROMPT\n{"level": "error", "message": "forged"}'
    monkeypatch.setattr(traceback, "print_exc", log_instead_of_printing)

    def breaks(component: gr.Textbox, value: Any) -> str:
        raise ValueError(f"{value} is no sentence")

    monkeypatch.setattr(gr.Textbox, "preprocess", breaks)
    said = events_of(local, "generate", [forged, *FIELDS[1:]])
    assert "event: error" in said
    lines = [JsonLines().format(record) for record in caplog.records]
    printed = "".join(capfd.readouterr())
    assert not any("SECRET" in text or "forged" in text for text in (*lines, printed))
    (line,) = [json.loads(line) for line in lines if "An event failed." in line]
    assert line["error"] == "ComponentProcessingError" and line["where"]


def test_logs_hold_no_prompt_and_no_forged_line(local: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    forged = 'x\r\n{"level": "error", "message": "forged"}'
    with caplog.at_level(logging.DEBUG):
        local.get("/?run=SECRETKEY&x=" + "%0d%0aSet-Cookie:%20a=b")
        local.post(JOIN, json={"session_hash": "s", "data": ["SECRET PROMPT"]}, headers={"user-agent": "a"})
        logging.getLogger("elsewhere").warning("got %s", "SECRET PROMPT")
        logging.getLogger("webdemo").warning("%s", forged)
        try:
            raise ValueError("SECRET PROMPT")
        except ValueError:
            logging.getLogger("webdemo").exception("A request failed.")
    lines = [JsonLines().format(record) for record in caplog.records]
    assert not any("SECRET" in line or "\n" in line for line in lines)
    assert json.loads(lines[-2])["message"] == forged
    assert json.loads(lines[-1])["error"] == "ValueError"
    kept = json.loads(JsonLines(content=True).format(caplog.records[-1]))
    assert kept["error_text"] == "SECRET PROMPT"
