"""What every request passes before the page sees it: an id, limits, where it comes from, and who sent it."""

from __future__ import annotations

import errno
import hmac
import json
import logging
import re
import shutil
import time
import uuid
from collections.abc import Collection
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, quote, urlsplit

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import MutableHeaders
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from webdemo.ui.visitor import Visitor

from .bodies import BoundedBody, Refused, declared_length, too_large
from .cards import message_card
from .figures import Figures
from .logs import REFERENCE
from .settings import Settings, is_loopback, on_a_space
from .visitors import VISITOR_COOKIE, Bindings, Rates, Visitors, new_token

log = logging.getLogger(__name__)

PUBLIC = ("/login", "/logout", "/healthz", "/metrics")
"""Paths that need no sign-in; /metrics has a rule of its own."""
API = "/gradio_api/"
_CLOSED = re.compile(
    r"/(monitoring|docs|redoc|openapi\.json|gradio_api/(proxy=|vibe|undo-vibe|run-history|runs|deep_link|dev/"
    r"|stream/|process_recording|custom_component|file=\w+:|file/\w+:))",
    re.IGNORECASE,
)
"""What Gradio offers and this page does not use: proxies, code editing, monitoring, other hosts' files."""
_NOT_HEARD = (b"x-forwarded-host", b"x-forwarded-proto", b"x-gradio-server")
"""Headers from which Gradio would take the page's address, whoever sends them: here it is Host's, and the
scheme what a proxy says that is believed."""
_CHANGING = ("POST", "PUT", "PATCH", "DELETE")
_LONGEST_URL = 4096
_ROUTES = frozenset(
    f"/{name}"
    for name in (
        "login",
        "logout",
        "healthz",
        "metrics",
        "config",
        "theme.css",
        "static",
        "assets",
        "favicon.ico",
    )
)
_API_ROUTES = frozenset(
    ("queue", "upload", "upload_progress", "file", "call", "run", "api", "info", "heartbeat", "cancel",
     "reset", "component_server", "startup-events", "app_id")
)  # fmt: skip


_NOTHING = "There is nothing here."
_DISK = "The server's disk is full, so nothing more can be uploaded: tell the person who runs it."
_ANSWERS = frozenset(f"{API}{name}" for name in ("queue/data", "call", "run", "api"))
"""Where the results of runs are sent."""


class OpenAnswers:
    """How many answers of runs are being sent; used by the server's one thread."""

    count = 0


class Guard:
    """An ASGI middleware around everything.

    Args:
        app: what it guards.
        settings: limits and names.
        visitors: who is who.
        figures: what is counted.
        answers: counts those that are being sent.
        endpoints: names that programs may call.
        functions: numbers of the page's events.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        settings: Settings,
        visitors: Visitors,
        figures: Figures,
        answers: OpenAnswers,
        endpoints: Collection[str],
        functions: Collection[int],
    ) -> None:
        self.app, self.settings, self.visitors, self.figures = app, settings, visitors, figures
        self.answers, self.endpoints, self.functions = answers, endpoints, functions
        self.bindings = Bindings()
        self.rates = Rates(settings.rate)
        self.address_rates = Rates(settings.rate * settings.address_people)
        names = settings.hosts or (["localhost", "127.0.0.1", "::1"] if settings.local else [])
        self.hosts = {name.lower() for name in names}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        reference = uuid.uuid4().hex[:12]
        REFERENCE.set(reference)
        began, status, first = time.perf_counter(), 0, 0.0
        headers = dict(scope["headers"])
        cookie = ""

        body: BoundedBody | None = None
        held: list[Message] = []
        instead = (500, 404) if b"text/html" in headers.get(b"accept", b"") else (500,)

        async def answer(message: Message) -> None:
            if body is not None and body.refused is not None and not status:
                return  # what its reader makes of the refusal is not the answer
            if held or (message["type"] == "http.response.start" and message["status"] in instead):
                held.append(message)  # there is something better to say, or an error follows that says more
                return
            await pass_on(message)

        async def pass_on(message: Message) -> None:
            nonlocal status, first
            if message["type"] == "http.response.start":
                status, first = message["status"], time.perf_counter() - began
                self._dress(MutableHeaders(scope=message), reference, cookie)
            await send(message)

        route, root = "(none)", self.settings.root_path
        try:
            path = self._path(scope)
            heard = [pair for pair in scope["headers"] if pair[0] not in _NOT_HEARD or on_a_space()]
            scope = {**scope, "path": path, "raw_path": path.encode(), "headers": heard}
            route = _route(path)
            visitor, body = await self._admit(scope, headers, receive, reference)
            if visitor is None:
                response = _sign_in_first(self.settings.root_path, path, scope, headers)
                await response(scope, receive, answer)
            else:
                if path == "/" and VISITOR_COOKIE.encode() not in headers.get(b"cookie", b""):
                    cookie = self._visitor_cookie(scope)
                scope["state"] = {**scope.get("state", {}), "visitor": visitor, "reference": reference}
                self.answers.count += route in _ANSWERS
                try:
                    await self.app(scope, body or receive, answer)
                finally:
                    self.answers.count -= route in _ANSWERS
                    refused, body = body.refused if body else None, None
                    if refused is not None:
                        raise refused
                if held and held[0]["status"] == 404:
                    raise Refused(404, _NOTHING, "not found")
                for message in held:
                    await pass_on(message)
        except Refused as refused:
            self.figures.refused.labels(refused.reason).inc()
            if not status:
                await _refusal(refused, reference, headers, root)(scope, receive, pass_on)
        except Exception as error:
            if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
                self.figures.refused.labels("disk").inc()
                if not status:
                    await _refusal(Refused(507, _DISK, ""), reference, headers, root)(scope, receive, pass_on)
                return
            self.figures.errors.labels(type(error).__name__).inc()
            log.exception("A request failed.")
            if not status:
                broken = Refused(
                    500, f"Something went wrong inside the program; its log says more under {reference}.", ""
                )
                await _refusal(broken, reference, headers, root)(scope, receive, pass_on)
        finally:
            method = scope["method"] if scope["method"] in (*_CHANGING, "GET", "HEAD", "OPTIONS") else "other"
            self.figures.requests.labels(route, method, str(status or 499)).inc()
            self.figures.answer_seconds.labels(route).observe(first)
            # Neither the query nor the whole path: both can hold the key of a run or of a file.
            log.info(
                "request",
                extra={"method": method, "route": route, "status": status or 499,
                       "first_byte_seconds": round(first, 4),
                       "seconds": round(time.perf_counter() - began, 4)},
            )  # fmt: skip

    # ---- who and what ----------------------------------------------------------------------------

    def _path(self, scope: Scope) -> str:
        """The path below the base path; raises Refused for one that tries tricks."""
        path, root = scope["path"], self.settings.root_path
        if len(path) + len(scope.get("query_string", b"")) > _LONGEST_URL:
            raise Refused(414, "The address is too long.", "bad path")
        if root and (path == root or path.startswith(f"{root}/")):
            path = path[len(root) :] or "/"
        if "\0" in path or "\\" in path or ".." in path.split("/") or not path.isprintable():
            raise Refused(404, _NOTHING, "bad path")
        if _CLOSED.match(path):
            raise Refused(404, _NOTHING, "closed")
        return path

    async def _admit(
        self, scope: Scope, headers: dict[bytes, bytes], receive: Receive, reference: str
    ) -> tuple[Visitor | None, BoundedBody | None]:
        """Checks a request against everything; gives its visitor and, where it may have one, its body."""
        host = headers.get(b"host", b"").decode("latin-1").lower()
        self._check_origin(scope, headers, host)
        path, address = scope["path"], (scope.get("client") or ("127.0.0.1", 0))[0]
        base = f"{scope['scheme']}://{host}{self.settings.root_path}/"
        cookies = _cookies(headers)
        visitor = await run_in_threadpool(self.visitors.of, cookies, address, reference=reference, base=base)
        if visitor is None and (path in PUBLIC or path.startswith("/login/")):
            visitor = Visitor(f"address {address}", "", reference, base)
        if scope["method"] in _CHANGING:
            upload = path.startswith(f"{API}upload")
            # An upload's form has a little around the file.
            most = (self.settings.upload_megabytes + 1 if upload else self.settings.body_megabytes) * 2**20
            declared = declared_length(headers)
            weight = 1.0
            if upload and declared <= most:  # its megabytes count as requests; not declared, as the most
                weight += (declared if b"content-length" in headers else most) / 2**20
            self.rates.take(visitor.person if visitor else f"address {address}", weight)
            if visitor is not None and visitor.address:  # whoever throws their cookie away is not new
                self.address_rates.take(visitor.address, weight)
            if visitor is None:
                return None, None
            if declared > most:
                raise too_large(most)
            if upload:
                self._check_room(declared)
            body = BoundedBody(receive, most=most, seconds=self.settings.body_seconds)
            if not upload and path.startswith(API):
                self._check_endpoint(path)
                self._check_body(await body.whole(), visitor.person)
            return visitor, body
        if visitor is not None and path.startswith(API):
            for session in _named_sessions(path, scope.get("query_string", b"")):
                self.bindings.check(session, visitor.person, begin=False)
        return visitor, None

    def _check_origin(self, scope: Scope, headers: dict[bytes, bytes], host: str) -> None:
        """Raises Refused for another site's page that asks in a visitor's name, and for foreign names."""
        origin = headers.get(b"origin", b"").decode("latin-1").lower()
        try:
            name, asks = urlsplit(f"//{host}").hostname or "", urlsplit(origin).netloc
        except ValueError:
            raise Refused(400, "The request's Host or Origin is not an address.", "bad head") from None
        if self.hosts and name not in self.hosts:
            raise Refused(
                421, "This server is not called so: set PASDEDEUX_HOSTS to the names it has.", "host"
            )
        if scope["method"] not in _CHANGING:
            return
        elsewhere = bool(origin) and asks != host
        if elsewhere or headers.get(b"sec-fetch-site") == b"cross-site":
            raise Refused(403, "Another site's page cannot do this: open the page itself.", "cross-site")

    def _check_room(self, size: float) -> None:
        free = self.settings.free_megabytes * 2**20
        if free and shutil.disk_usage(self.settings.data).free < free + size:
            raise Refused(507, _DISK, "disk")

    def _check_endpoint(self, path: str) -> None:
        way, _, name = path[len(API) :].partition("/")
        if way in ("call", "run", "api") and name.partition("/")[0] not in self.endpoints:
            raise Refused(404, "There is no endpoint of this name: see /gradio_api/info.", "forged")

    def _check_body(self, body: bytes, person: str) -> None:
        if not body:
            return
        try:
            fields = json.loads(body)
        except (ValueError, RecursionError):
            raise Refused(400, "The request's body is not JSON.", "bad body") from None
        fields = fields if isinstance(fields, dict) else {}
        function, session = fields.get("fn_index"), fields.get("session_hash")
        if function is not None and (type(function) is not int or function not in self.functions):
            raise Refused(404, "The page has no such function: reload it.", "forged")
        if session is not None:
            if not isinstance(session, str):
                raise Refused(400, "The session's name is not text: reload the page.", "forged")
            self.bindings.check(session, person, begin=True)

    # ---- answers ---------------------------------------------------------------------------------

    def _dress(self, headers: MutableHeaders, reference: str, cookie: str) -> None:
        headers["X-Request-ID"] = reference
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "same-origin"  # the address of an opened run is its key
        if not on_a_space():  # a Space shows its page in a frame
            headers["Content-Security-Policy"] = "frame-ancestors 'self'"
        if cookie:
            headers.append("Set-Cookie", cookie)

    def _visitor_cookie(self, scope: Scope) -> str:
        return cookie_header(
            VISITOR_COOKIE, new_token(), seconds=365 * 86400, root=self.settings.root_path,
            secure=scope["scheme"] == "https",
        )  # fmt: skip


def cookie_header(name: str, value: str, *, seconds: float, root: str, secure: bool) -> str:
    """A Set-Cookie that scripts cannot read and other sites' forms do not send."""
    secure, same_site = (True, "None") if on_a_space() else (secure, "Lax")  # a Space's page is in a frame
    parts = [f"{name}={value}", f"Max-Age={int(seconds)}", f"Path={root or '/'}"]
    parts += ["HttpOnly", f"SameSite={same_site}"]
    return "; ".join([*parts, "Secure"] if secure else parts)


def may_read_figures(settings: Settings, address: str, authorization: str) -> bool:
    """Whether /metrics answers: to this machine, or to whoever has the token."""
    token = settings.metrics_token
    if token:
        return hmac.compare_digest(authorization.encode(), f"Bearer {token}".encode())
    return is_loopback(address)


def _route(path: str) -> str:
    """What a path is counted and logged as: its first word where that is known, never a key or a name."""
    if path.startswith(API):
        word, _, rest = path[len(API) :].replace("=", "/").partition("/")
        if word == "queue" and rest in ("join", "data"):
            return f"{API}queue/{rest}"
        return f"{API}{word}" if word in _API_ROUTES else "(other)"
    first = "/" + path[1:].partition("/")[0]
    return first if path == "/" or first in _ROUTES else "(other)"


def _cookies(headers: dict[bytes, bytes]) -> dict[str, str]:
    try:
        return {k: m.value for k, m in SimpleCookie(headers.get(b"cookie", b"").decode("latin-1")).items()}
    except CookieError:
        return {}


def _named_sessions(path: str, query: bytes) -> list[str]:
    named = parse_qs(query.decode("latin-1"), max_num_fields=50).get("session_hash", [])
    if path.startswith(f"{API}heartbeat/"):
        named.append(path.split("/")[3])
    return named


def _sign_in_first(root: str, path: str, scope: Scope, headers: dict[bytes, bytes]) -> Response:
    if scope["method"] == "GET" and b"text/html" in headers.get(b"accept", b""):
        query = scope.get("query_string", b"").decode("latin-1")
        wanted = path + (f"?{query}" if query else "")
        return RedirectResponse(f"{root}/login?next={quote(wanted, safe='')}", status_code=303)
    sentence = "Sign in first: reload the page, or give auth=(name, password) where a program asks."
    return JSONResponse({"detail": sentence}, status_code=401)


def _refusal(refused: Refused, reference: str, headers: dict[bytes, bytes], root: str = "") -> Response:
    if b"text/html" in headers.get(b"accept", b""):
        page = message_card(refused.sentence, home=f"{root}/", reference=reference)
        return HTMLResponse(page, status_code=refused.status)
    return JSONResponse({"detail": refused.sentence, "request": reference}, status_code=refused.status)
