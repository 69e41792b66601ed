"""Files of the server's are neither read nor waited for, whatever a value says."""

from __future__ import annotations

from typing import Any

import pytest

from ..clients import FIELDS, PREDICT, REACT
from .target import CANARY, Target


def file_data(path: str, **more: Any) -> dict[str, Any]:
    """A file as Gradio's values name it."""
    return {"path": path, "meta": {"_type": "gradio.FileData"}, **more}


def places(target: Target) -> list[str]:
    """Paths and addresses that are none of a visitor's business, or never end."""
    return [
        str(target.canary),
        "/etc/passwd",
        "/dev/zero",
        "/proc/self/environ",
        "app.py",
        "../../etc/passwd",
        str(target.data / "history.db"),
        f"{target.data}/scratch/uploads/../../../../canary.txt",
        f"{target.url}/healthz",
        "http://127.0.0.1:9/x",
        "HTTP://127.0.0.1:9/x",
        "file:///etc/passwd",
        "",
        "\0",
    ]


@pytest.mark.parametrize("endpoint", ["generate", "react", "predict"])
def test_no_value_names_a_file_of_the_servers(target: Target, endpoint: str) -> None:
    """The prompt was copied into the served folder, and the manifest said where; /dev/zero never ended."""
    rest = {"generate": FIELDS[1:], "react": REACT, "predict": PREDICT}[endpoint]
    for path in places(target):
        for value in (file_data(path), file_data(path, url=path), [file_data(path)], {"x": file_data(path)}):
            said = target.call("eve", endpoint, [value, *rest])
            assert "event: complete" not in said and CANARY not in said and "root:" not in said, (value, said)
    assert not target.copies(CANARY) and target.healthy()


@pytest.mark.parametrize("place", range(1, len(FIELDS)))
def test_nor_does_any_other_value_of_a_call(target: Target, place: int) -> None:
    data: list[Any] = list(FIELDS)
    data[place] = file_data(str(target.canary))
    assert "event: complete" not in target.call("eve", "generate", data)
    assert not target.copies(CANARY)


def test_nor_does_an_event_of_the_page(target: Target) -> None:
    """Every function, not those for programs alone, and every way in which Gradio takes a call."""
    config = target.ask("eve", "GET", "/config").json()
    file = file_data(str(target.canary))
    for function in config["dependencies"]:
        data = [file] * len(function["inputs"])
        if not data:
            continue
        body = {"data": data, "fn_index": function["id"], "session_hash": "eves"}
        for path in ("queue/join", "run/generate", "api/generate"):
            answer = target.ask("eve", "POST", f"/gradio_api/{path}", json=body)
            assert answer.status_code in (400, 403, 404), (function["api_name"], path, answer.text)
    assert not target.copies(CANARY) and target.healthy()


def test_uploads_and_downloads_go_on_working(target: Target) -> None:
    path = target.upload("ada", "clip.bvh", b"HIERARCHY")
    said = target.call("ada", "react", [file_data(path), *REACT])
    assert "event: error" in said and "clip.bvh has no MOTION part" in said  # so it was read
    said = target.call("ada", "generate", FIELDS)
    assert "event: complete" in said
    (made,) = [line for line in said.split('"') if line.endswith(".npz") and line.startswith("/")][:1]
    assert target.ask("ada", "GET", f"/gradio_api/file={made}").content[:2] == b"PK"
