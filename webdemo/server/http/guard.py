"""The checks that every request passes before the page sees it: limits, where it comes from, and who sent it.

Starlette's TrustedHostMiddleware and RequestBodyLimitMiddleware would do a part of it: the first answers
without naming the setting, the second bounds no time. So both are done here.
"""

from __future__ import annotations

import errno
import hmac
import json
import logging
import re
import shutil
from collections.abc import Callable
from functools import partial
from urllib.parse import parse_qs, quote, urlsplit

from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from motion import InputError
from webdemo.server.accounts.quotas import Quotas, RateLimit, network_of
from webdemo.server.accounts.visitors import (
    VISITOR_COOKIE,
    Bindings,
    Visitors,
    new_token,
    person_by_proxy,
    read_cookies,
    set_cookie,
)
from webdemo.server.audit import SENDER
from webdemo.server.logs import REFERENCE
from webdemo.server.settings import Settings, is_loopback, on_a_space
from webdemo.server.store.database import is_full
from webdemo.server.store.scratch import PERSON
from webdemo.ui.visitor import Visitor

from .exchange import BoundedBody, Exchange, UploadForm, declared_length, too_large
from .health import Figures
from .payloads import Payloads
from .routes import API, LIVE, MESSAGE, Refused, is_public_page, is_upload, needs_no_sign_in, path_below, route_of

log = logging.getLogger(__name__)

_NOT_HEARD = (b"x-forwarded-host", b"x-forwarded-proto", b"x-gradio-server")
"""Headers from any client from which Gradio would take the page's address. Here they are dropped: the address is
Host's, and the scheme is that of a trusted proxy."""
_CHANGING = ("POST", "PUT", "PATCH", "DELETE")
_DISK = "The server's disk is full, so nothing more can be kept: tell the person who runs it."
_DATABASE = "The server's database cannot be read or written: tell the person who runs it."
_ANSWERS = frozenset(f"{API}{name}" for name in ("queue/data", "call", "run", "api"))
"""Paths that send the results of runs."""
_CALLS = frozenset(f"{API}{name}" for name in ("queue/join", "call"))
"""Paths whose responses hold the id of a call, with which its result is fetched."""
_WATCHED = ("/healthz", "/metrics")
"""Paths for those who watch the server, which have rules of their own and say what is wrong."""
_LIVE_WEIGHT = 0.05
"""The number of requests that a message of a live stream counts as: some fifteen come in a second."""
_DEAR = frozenset(("/", "/config", f"{API}info", f"{API}startup-events"))
_DEAR_WEIGHT = 10.0
"""The number of GETs that one of these counts as: they are long, or made anew for a name of the server's."""
_HOST = re.compile(r"[a-z0-9._\[\]:-]*+")
_MOST_FIELDS = 50
"""Parameters of an address."""
_MOST_VALUES = 20_000
"""Of a call's body: the page's own have a few dozen."""


class OpenAnswers:
    """The number of run results being sent; used only by the server's main thread."""

    count = 0


class Guard:
    """The outermost ASGI middleware.

    Args:
        app: the guarded application.
        settings: limits and host names.
        quotas: requests of a person and of an address.
        visitors: identifies visitors.
        figures: metrics to update.
        answers: counts the results being sent.
        payloads: validates the payloads of calls.
        admit: makes room for an upload of a visitor, or raises InputError.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        settings: Settings,
        visitors: Visitors,
        quotas: Quotas,
        figures: Figures,
        answers: OpenAnswers,
        payloads: Payloads,
        admit: Callable[[Visitor, float], None],
    ) -> None:
        self.app, self.settings, self.visitors, self.figures = app, settings, visitors, figures
        self.answers, self.payloads, self.admit = answers, payloads, admit
        self.bindings = Bindings()
        self.quotas = quotas
        self.hosts = {name.lower() for name in settings.hosts}
        if self.hosts or settings.local:  # its own health check, and tunnels to it, name the loopback
            self.hosts |= {"localhost", "127.0.0.1", "::1"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Checks a request, then passes it on."""
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        exchange = Exchange(scope, send, root=self.settings.root_path, frame_sites=self.settings.frame_sites)
        REFERENCE.set(exchange.reference)
        address = (scope.get("client") or ("", 0))[0]
        SENDER.set(("", address))
        route = "(none)"
        try:
            path = path_below(self.settings.root_path, scope["path"], scope.get("query_string", b""))
            exchange.path = path
            route = route_of(path)
            heard = [pair for pair in scope["headers"] if pair[0] not in _NOT_HEARD or on_a_space()]
            heard = [pair for pair in heard if pair[0] != b"range" or b"," not in pair[1]]  # Gradio knows one part
            scope = {**scope, "path": path, "raw_path": path.encode(), "headers": heard}
            await self._pass(exchange, scope, receive, route)
        except ClientDisconnect:  # in the middle of a body: there is nobody to answer
            pass
        except Exception as error:
            await exchange.refuse(self._refusal_of(error, exchange.reference))
        finally:
            self._note(exchange, route)

    async def _pass(self, exchange: Exchange, scope: Scope, receive: Receive, route: str) -> None:
        """Lets a request through to the page, if it is let in."""
        self._check_head(scope, exchange.headers)
        visitor = await self._visitor(scope, exchange)
        if visitor is None:
            await exchange.respond(_sign_in_first(self.settings.root_path, scope, exchange.in_browser))
            return
        if scope["method"] in _CHANGING:
            exchange.body = await self._body(scope, exchange.headers, receive, visitor)
        else:
            self._check_names(scope, visitor.person)
        if (
            scope["path"] == "/" or scope["path"].startswith("/study/")
        ) and VISITOR_COOKIE.encode() not in exchange.headers.get(b"cookie", b""):
            exchange.cookie = self._visitor_cookie(scope)
        if scope["method"] == "POST" and route in _CALLS:
            exchange.heard = self._binds(visitor.person)
        scope["state"] = {**scope.get("state", {}), "visitor": visitor, "reference": exchange.reference}
        PERSON.set(visitor.person)
        SENDER.set((visitor.account or visitor.person, SENDER.get()[1]))
        self.answers.count += route in _ANSWERS
        try:
            await self.app(scope, exchange.body or receive, exchange.answer)
        except Exception:
            if exchange.body is None or exchange.body.refused is None:
                raise
        finally:
            self.answers.count -= route in _ANSWERS
        await exchange.finish()

    def _refusal_of(self, error: Exception, reference: str) -> Refused:
        """The response to an error, which is counted, and logged if it is internal."""
        if isinstance(error, Refused):
            self.figures.refused.labels(error.reason).inc()
            return error
        if (isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)) or is_full(error):
            self.figures.refused.labels("disk").inc()
            return Refused(507, _DISK, "disk")
        self.figures.errors.labels(type(error).__name__).inc()
        log.error("A request failed.", exc_info=error)
        if isinstance(error, SQLAlchemyError):
            return Refused(503, _DATABASE, "database")
        sentence = f"Something went wrong inside the program; its log says more under {reference}."
        return Refused(500, sentence, "")

    def _note(self, exchange: Exchange, route: str) -> None:
        """Counts and logs an exchange."""
        method = exchange.scope["method"]
        method = method if method in (*_CHANGING, "GET", "HEAD", "OPTIONS") else "other"
        status = exchange.status or 499
        self.figures.requests.labels(route, method, str(status)).inc()
        self.figures.answer_seconds.labels(route).observe(exchange.first_byte)
        # Neither the query nor the whole path: both can hold the key of a run or of a file.
        log.log(
            logging.DEBUG if route == MESSAGE else logging.INFO,  # a live stream sends some fifteen a second
            "request",
            extra={
                "method": method,
                "route": route,
                "status": status,
                "first_byte_seconds": round(exchange.first_byte, 4),
                "seconds": round(exchange.seconds, 4),
            },
        )

    # ---- the head --------------------------------------------------------------------------------

    def _check_head(self, scope: Scope, headers: dict[bytes, bytes]) -> None:
        """Raises Refused for foreign names, and for another site's page that asks in a visitor's name."""
        if b"transfer-encoding" in headers and b"content-length" in headers:  # a proxy may take the other
            raise Refused(400, "The request has a length and comes in pieces: send one of both.", "bad head")
        host = headers.get(b"host", b"").decode("latin-1").lower()
        origin = headers.get(b"origin", b"").decode("latin-1").lower()
        try:
            name, asks = urlsplit(f"//{host}").hostname or "", urlsplit(origin).netloc
        except ValueError:
            raise Refused(400, "The request's Host or Origin is not an address.", "bad head") from None
        if not _HOST.fullmatch(host):
            raise Refused(400, "The request's Host is not a name.", "bad head")
        if self.hosts and name not in self.hosts:
            raise Refused(421, "This server is not called so: set PASDEDEUX_HOSTS to the names it has.", "host")
        if scope["method"] not in _CHANGING:
            return
        elsewhere = bool(origin) and asks != host
        if elsewhere or headers.get(b"sec-fetch-site") == b"cross-site":
            raise Refused(403, "Another site's page cannot do this: open the page itself.", "cross-site")

    async def _visitor(self, scope: Scope, exchange: Exchange) -> Visitor | None:
        """The visitor who sent the request; None if they must sign in first."""
        headers = exchange.headers
        path, address = scope["path"], (scope.get("client") or ("127.0.0.1", 0))[0]
        host = headers.get(b"host", b"").decode("latin-1").lower()
        base = f"{scope['scheme']}://{host}{self.settings.root_path}/"
        nobody = Visitor(f"address {network_of(address)}", "", exchange.reference, base)
        if path in _WATCHED:  # they answer while everything else waits
            return nobody
        try:
            find = partial(
                self.visitors.of,
                read_cookies(headers),
                address,
                reference=exchange.reference,
                base=base,
                by_proxy=person_by_proxy(self.settings, scope),
            )  # which looks into the database where people have accounts
            visitor = await run_in_threadpool(find) if self.settings.accounts else find()
        except (Refused, SQLAlchemyError) as error:
            if not (isinstance(error, Refused) and error.reason == "proxy" and needs_no_sign_in(path)):
                raise
            visitor = None
        if visitor is None and needs_no_sign_in(path):
            visitor = nobody
        if scope["method"] in _CHANGING or is_public_page(path):  # a motion is read for each of these
            weight, limits = self._weight(scope, headers), (self.quotas.requests, self.quotas.address_requests)
        else:
            weight, limits = _DEAR_WEIGHT if path in _DEAR else 1.0, (self.quotas.gets, self.quotas.address_gets)
        self._take(visitor or nobody, weight, *limits)
        return visitor

    @staticmethod
    def _take(visitor: Visitor, weight: float, person: RateLimit, address: RateLimit) -> None:
        person.take(visitor.person, weight)
        if visitor.address:  # deleting the cookie does not make a new visitor
            address.take(visitor.address, weight)

    def _visitor_cookie(self, scope: Scope) -> str:
        response = Response()
        set_cookie(
            response,
            VISITOR_COOKIE,
            new_token(),
            seconds=365 * 86400,
            root=self.settings.root_path,
            secure=scope["scheme"] == "https",
        )
        return response.headers["set-cookie"]

    # ---- the body --------------------------------------------------------------------------------

    def _most(self, path: str) -> float:
        """Most bytes of a body; an upload's form has some overhead around the file."""
        megabytes = self.settings.upload_megabytes + 1 if is_upload(path) else self.settings.body_megabytes
        return megabytes * 2**20

    def _weight(self, scope: Scope, headers: dict[bytes, bytes]) -> float:
        """The number of requests that this one counts as; each megabyte of an upload adds one. An undeclared length
        counts as the largest allowed."""
        path, declared = scope["path"], declared_length(headers)
        if path.startswith(LIVE):
            return _LIVE_WEIGHT
        if not is_upload(path) or declared > (most := self._most(path)):
            return 1.0
        return 1.0 + (declared if b"content-length" in headers else most) / 2**20

    async def _body(self, scope: Scope, headers: dict[bytes, bytes], receive: Receive, visitor: Visitor) -> BoundedBody:
        """The body of a request that may have one, checked where it is a call of the page's."""
        path, declared = scope["path"], declared_length(headers)
        most = self._most(path)
        if declared > most:
            raise too_large(most)
        form = None
        if is_upload(path):
            size = declared if b"content-length" in headers else most
            self._check_disk(size)
            await self._make_room(visitor, size)
            form = UploadForm(headers.get(b"content-type", b""))
        body = BoundedBody(receive, most=most, seconds=self.settings.body_seconds, form=form)
        if form is None and path.startswith(API):
            self._check_call(await body.whole(), visitor.person, path)
        return body

    async def _make_room(self, visitor: Visitor, size: float) -> None:
        """Makes room for an upload among the visitor's own files."""
        try:
            await run_in_threadpool(self.admit, visitor, size)
        except InputError as error:
            raise Refused(507, str(error), "room") from None

    def _check_disk(self, size: float) -> None:
        free = self.settings.free_megabytes * 2**20
        if free and shutil.disk_usage(self.settings.data).free < free + size:
            raise Refused(507, _DISK, "disk")

    def _endpoint(self, path: str) -> int | None:
        """The function that a path names; None if it names none."""
        way, _, name = path[len(API) :].partition("/")
        return self.payloads.number_of(name.partition("/")[0]) if way in ("call", "run", "api") else None

    def _check_call(self, body: bytes, person: str, path: str) -> None:
        endpoint = self._endpoint(path)
        if not body:
            return
        if sum(map(body.count, (b"[", b"{", b","))) > _MOST_VALUES:  # each weighs far more once it is read
            raise Refused(413, "The request has too many values: send fewer.", "too large")
        try:
            fields = json.loads(body)
        except (ValueError, RecursionError):
            raise Refused(400, "The request's body is not JSON.", "bad body") from None
        fields = fields if isinstance(fields, dict) else {}
        if path.startswith(f"{API}call/"):
            fields.pop("fn_index", None)  # Gradio calls what the address names
        if (endpoint is not None or path.startswith(f"{API}queue/join")) and fields.get("data") is None:
            fields["data"] = []  # as many values as a function without inputs takes
        self.payloads.check(fields, endpoint, person)
        session, event = fields.get("session_hash"), fields.get("event_id")
        if session is not None:
            self.bindings.check(session, person, begin=True)
        if event is not None:
            self.bindings.check(event, person, known=True)

    # ---- whose -----------------------------------------------------------------------------------

    def _check_names(self, scope: Scope, person: str) -> None:
        """Raises Refused if an address names a session or a call that is another person's."""
        path = scope["path"]
        try:
            query = parse_qs(scope.get("query_string", b"").decode("latin-1"), max_num_fields=_MOST_FIELDS)
        except ValueError:
            raise Refused(400, "The address has too many parameters.", "bad path") from None
        if not path.startswith(API):
            return
        way, *names = path[len(API) :].split("/")
        for session in query.get("session_hash", []) + (names[:1] if way == "heartbeat" else []):
            self.bindings.check(session, person)
        if way == "call":
            self.bindings.check("/".join(names[1:]).rstrip("/"), person, known=True)

    def _binds(self, person: str) -> Callable[[bytes], None]:
        """Returns a listener that ties the answer to a call to the person who made it."""

        def hear(answer: bytes) -> None:
            try:
                event = json.loads(answer)["event_id"]
            except (ValueError, KeyError, TypeError):
                return
            self.bindings.check(event, person, begin=True)

        return hear


def may_read_figures(settings: Settings, address: str, authorization: str) -> bool:
    """True if /metrics may be read: from this machine, or with the token."""
    token = settings.metrics_token
    if token:
        return hmac.compare_digest(authorization.encode(), f"Bearer {token}".encode())
    return is_loopback(address)


def _sign_in_first(root: str, scope: Scope, in_browser: bool) -> Response:
    if scope["method"] == "GET" and in_browser:
        query = scope.get("query_string", b"").decode("latin-1")
        wanted = scope["path"] + (f"?{query}" if query else "")
        return RedirectResponse(f"{root}/login?next={quote(wanted, safe='')}", status_code=303)
    sentence = "Sign in first: reload the page, or give auth=(name, password) where a program asks."
    return JSONResponse({"detail": sentence}, status_code=401)
