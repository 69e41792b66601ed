"""Files in the calls of the page: every component that takes one takes the sender's own alone."""

from __future__ import annotations

from pathlib import Path

import gradio as gr
import pytest

from webdemo.server.http import payloads
from webdemo.server.http.body_limits import Refused
from webdemo.server.http.payloads import Payloads


@pytest.mark.parametrize("component", [gr.File, gr.UploadButton])
def test_a_call_names_the_senders_own_upload_alone(
    component: type, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(payloads, "owns", lambda person, path: path == f"/uploads/{person}/x.glb")
    with gr.Blocks() as page:
        part = component()
        part.upload(lambda file: None, inputs=part)
    calls = Payloads(page)
    mine = {"path": "/uploads/ada/x.glb", "meta": {"_type": "gradio.FileData"}}
    calls.check({"fn_index": 0, "data": [mine]}, None, "ada")
    for person, value in (
        ("eve", mine),
        ("ada", {"path": "/etc/passwd"}),
        ("ada", "/uploads/ada/x.glb"),
        ("ada", {}),
    ):
        with pytest.raises(Refused, match="must be uploaded"):
            calls.check({"fn_index": 0, "data": [value]}, None, person)
