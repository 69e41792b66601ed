"""Caches what opens the page: Gradio would copy and traverse its whole configuration for every visitor."""

from __future__ import annotations

import asyncio
from collections import OrderedDict

from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

KEPT = 16
"""Most cached variants: they differ by host name, scheme and whether the answer may be packed."""
PATHS = ("/", "/config")
_ANY = b"any-host.invalid"
"""Stands for the name by which a visitor calls this server; the guard lets no name in that is more than a name."""
_LEVEL = 5
"""Of packing: a third of the time of the highest, which saves two per cent."""
_ASKED = b"""<script>{
  const asked = new URLSearchParams(location.search).get("lang");
  if (/^[a-z]{2,3}(-[a-z0-9]+)*$/i.test(asked ?? "")) Object.defineProperty(navigator, "language", { value: asked });
}</script>"""
"""Stands before Gradio's scripts, which take the browser's language: ``?lang=fr`` in the address goes before it."""


class PageCache:
    """An ASGI middleware that answers GET of :data:`PATHS` from memory, compressed; it runs inside the access checks.

    The answers are the same for all visitors and whatever the query, which scripts read: personal content arrives
    through events. So they hold no secret that their compressed size could give away.

    Args:
        app: renders the page.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._page = GZipMiddleware(_Page(app), compresslevel=_LEVEL)
        self._kept: OrderedDict[tuple[object, ...], list[Message]] = OrderedDict()
        self._making = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers a request for the page; passes every other one on."""
        if scope["type"] != "http" or scope["method"] != "GET" or scope["path"] not in PATHS:
            await self.app(scope, receive, send)
            return
        sent = dict(scope["headers"])
        packed = b"gzip" in sent.get(b"accept-encoding", b"")
        heard = [pair for pair in scope["headers"] if pair[0] not in (b"accept-encoding", b"cookie")]
        heard += [(b"accept-encoding", b"gzip")] if packed else []
        scope = {**scope, "headers": heard, "query_string": b""}
        key = (scope["path"], scope["scheme"], sent.get(b"host"), packed)
        if (kept := self._kept.get(key)) is None:
            async with self._making:  # whoever comes meanwhile waits for what is being made
                if (kept := self._kept.get(key)) is None:
                    kept = await self._made(key, scope, receive)
        for message in kept:
            await send(_copy(message))

    async def _made(self, key: tuple[object, ...], scope: Scope, receive: Receive) -> list[Message]:
        """The messages of an answer, which is kept if it is whole."""
        made: list[Message] = []

        async def keep(message: Message) -> None:
            made.append(_copy(message))

        await self._page(scope, receive, keep)
        if made and made[0].get("status") == 200:
            self._kept[key] = made
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
        return made


class _Page:
    """An ASGI application that has each answer of another made once, whatever the host's name, and gives it the name.

    :data:`_ASKED` is put at the beginning of a page's head.

    Args:
        app: makes them; their addresses are those of :data:`_ANY`.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._made: dict[tuple[str, str], tuple[Message, bytes]] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers under the name by which it is asked."""
        key = scope["path"], scope["scheme"]
        start, body = self._made.get(key) or await self._make(scope, receive)
        if start["status"] == 200:
            self._made[key] = start, body
        body = body.replace(_ANY, dict(scope["headers"]).get(b"host", b""))
        headers = [pair for pair in start["headers"] if pair[0] != b"content-length"]
        headers.append((b"content-length", str(len(body)).encode()))
        await send({**start, "headers": headers})
        await send({"type": "http.response.body", "body": body})

    async def _make(self, scope: Scope, receive: Receive) -> tuple[Message, bytes]:
        made: list[Message] = []

        async def keep(message: Message) -> None:
            made.append(_copy(message))

        heard = [pair for pair in scope["headers"] if pair[0] != b"host"]
        await self.app({**scope, "headers": [*heard, (b"host", _ANY)]}, receive, keep)
        start = next(message for message in made if message["type"] == "http.response.start")
        body = b"".join(message["body"] for message in made if message.get("body"))
        return start, body.replace(b"<head>", b"<head>" + _ASKED, 1)


def _copy(message: Message) -> Message:
    """A message with a copy of its headers, since outer middleware adds to them."""
    return {**message, "headers": list(message["headers"])} if "headers" in message else message
