"""The language that the page's address asks for: a script before Gradio's, in every answer that is a page."""

from __future__ import annotations

import asyncio
import gzip
from collections.abc import Mapping

import pytest

from webdemo.server.http.page_html import PageCache

PAGE = b"<!doctype html><html><head><script type='module' src='gradio.js'></script></head>" + b" " * 2000


def _answer(body: bytes, query: bytes = b"") -> tuple[Mapping[bytes, bytes], bytes]:
    async def app(scope, receive, send):
        headers = [(b"content-type", b"text/html"), (b"content-length", str(len(body)).encode())]
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": body})

    sent = []

    async def receive():
        return {"type": "http.request"}

    async def send(message):
        sent.append(message)

    scope = {
        "type": "http",
        "method": "GET",
        "path": "/",
        "scheme": "http",
        "query_string": query,
        "headers": [(b"accept-encoding", b"gzip")],
    }
    asyncio.run(PageCache(app)(scope, receive, send))
    headers = dict(sent[0]["headers"])
    whole = b"".join(message.get("body", b"") for message in sent[1:])
    return headers, gzip.decompress(whole) if headers.get(b"content-encoding") == b"gzip" else whole


@pytest.mark.parametrize("query", [b"", b"lang=de", b"run=1&lang=de", b"__theme=dark"])
def test_the_page_reads_the_language_of_its_address_before_gradio_does(query: bytes) -> None:
    headers, body = _answer(PAGE, query)
    assert body.count(b'.get("lang")') == 1
    assert body.index(b'"language"') < body.index(b"gradio.js")
    assert body.replace(body[body.index(b"<script>{") : body.index(b"}</script>") + 10], b"") == PAGE
    assert int(headers[b"content-length"]) < len(PAGE), "the length is that of what is sent"
