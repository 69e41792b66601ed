"""The checks that every request passes before the page sees it: limits, where it comes from, and who sent it.

Starlette's TrustedHostMiddleware and RequestBodyLimitMiddleware would do a part of it: the first answers
without naming the setting, the second bounds no time. So both are done here.
"""

from __future__ import annotations

import hmac
import json
import logging
import re
from functools import partial
from urllib.parse import parse_qs, quote, urlsplit

from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from motion import InputError
from webdemo.server.accounts.quotas import OverQuota, Quota, network_of
from webdemo.server.accounts.visitors import SESSION_COOKIE, VISITOR_COOKIE, YEAR, find_visitor, new_token, set_cookie
from webdemo.server.audit import SENDER
from webdemo.server.lab import Lab
from webdemo.server.logs import REFERENCE
from webdemo.server.settings import Settings, is_loopback, on_a_space
from webdemo.server.store.database import BROKEN, DISK_FULL, is_full
from webdemo.server.store.scratch import PERSON
from webdemo.ui.visitor import Visitor

from .exchange import BAD_UPLOAD, BoundedBody, Exchange, declared_length, too_large
from .page_html import PATHS
from .payloads import Payloads
from .routes import API, LIVE, PROGRESS, Refused, is_public_page, is_upload, needs_no_sign_in, path_below

log = logging.getLogger(__name__)

_NOT_HEARD = (b"x-forwarded-host", b"x-forwarded-proto", b"x-gradio-server")
"""Headers from any client from which Gradio would take the page's address. Here they are dropped: the address is
Host's, and the scheme is that of a trusted proxy."""
_CHANGING = ("POST", "PUT", "PATCH", "DELETE")
_WATCHED = ("/healthz", "/metrics")
"""Paths for those who watch the server, which have rules of their own and say what is wrong."""
_LIVE_WEIGHT = 0.05
"""The number of requests that a message of a live stream counts as: some fifteen come in a second."""
_DEAR = frozenset(("/", "/config", f"{API}info", f"{API}startup-events"))
_DEAR_WEIGHT = 10.0
"""The number of GETs that one of these counts as: they are long, or made anew for a name of the server's."""
_PAGE_WEIGHT = 5.0
"""The number of requests that a view of a public page counts as: reading a scene of three minutes takes 0.2 s."""
_BY_A_BAD_FORM = (AttributeError, LookupError, TypeError, ValueError)
"""What Gradio raises over a form that is none."""
_RANGE = re.compile(rb"bytes=(?:\d{1,15}-\d{0,15}|-\d{1,15})")
"""What Gradio knows of ranges; a header that says anything else is left out, as RFC 9110 has it."""
_HOST = re.compile(r"[a-z0-9._\[\]:-]*+")
_LARGE = 2**18
"""Bytes of a body above which it needs one of the places for large ones until it is answered."""
_MOST_FIELDS = 50
"""Parameters of an address."""
_MOST_VALUES = 20_000
"""Of a call's body: the page's own have a few dozen."""


class Guard:
    """The outermost ASGI middleware.

    Args:
        app: the guarded application.
        lab: whose limits hold.
        payloads: validates the payloads of calls.
    """

    def __init__(self, app: ASGIApp, *, lab: Lab, payloads: Payloads) -> None:
        self.app, self.lab, self.payloads = app, lab, payloads
        self.settings, self.quotas, self.figures, self.bindings = lab.settings, lab.quotas, lab.figures, lab.bindings
        self._held: dict[Exchange, tuple[Quota, str, str]] = {}
        self.hosts = {name.lower() for name in lab.settings.hosts}
        if self.hosts or lab.settings.local:  # its own health check, and tunnels to it, name the loopback
            self.hosts |= {"localhost", "127.0.0.1", "::1"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Checks a request, then passes it on."""
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        exchange = Exchange(scope, send, root=self.settings.root_path)
        REFERENCE.set(exchange.reference)
        address = (scope.get("client") or ("", 0))[0]
        SENDER.set(("", address))
        try:
            path = path_below(self.settings.root_path, scope["path"], scope.get("query_string", b""))
            exchange.path = path
            heard = [pair for pair in scope["headers"] if pair[0] not in _NOT_HEARD or on_a_space()]
            heard = [pair for pair in heard if pair[0] != b"range" or _RANGE.fullmatch(pair[1])]
            scope = {**scope, "path": path, "raw_path": path.encode(), "headers": heard}
            await self._pass(exchange, scope, receive)
        except ClientDisconnect:  # in the middle of a body: there is nobody to answer
            pass
        except Exception as error:
            if exchange.status and isinstance(error.__cause__, HTTPException):  # Gradio found out in an open stream
                await send({"type": "http.response.body"})
            else:
                await exchange.refuse(self._refusal_of(error, exchange))
        finally:
            self._held.pop(exchange, None)
            self._note(exchange, scope)

    async def _pass(self, exchange: Exchange, scope: Scope, receive: Receive) -> None:
        """Lets a request through to the page, if it is let in."""
        self._check_head(scope, exchange.headers)
        visitor = await self._visitor(scope, exchange)
        if visitor is None:
            await exchange.respond(_sign_in_first(self.settings.root_path, scope, exchange.in_browser))
            return
        if scope["method"] in _CHANGING:
            exchange.body = await self._body(scope, exchange, receive, visitor)
        else:
            self._check_names(scope, visitor.person)
            if scope["path"] == PROGRESS:
                self._hold(self.quotas.watched, exchange, visitor)
        if (
            scope["path"] == "/" or scope["path"].startswith("/study/")
        ) and VISITOR_COOKIE.encode() not in exchange.headers.get(b"cookie", b""):
            response, secure = Response(), scope["scheme"] == "https"
            set_cookie(response, VISITOR_COOKIE, new_token(), seconds=YEAR, root=self.settings.root_path, secure=secure)
            exchange.cookie = response.headers["set-cookie"]
        scope["state"] = {**scope.get("state", {}), "visitor": visitor, "reference": exchange.reference}
        PERSON.set(visitor.person)
        SENDER.set((visitor.account or visitor.person, SENDER.get()[1]))
        try:
            await self.app(scope, exchange.body or receive, exchange.answer)
        except Exception as error:
            if exchange.body is None or exchange.body.refused is None:
                if is_upload(exchange.path) and isinstance(error, _BY_A_BAD_FORM):
                    raise Refused(400, BAD_UPLOAD, "bad body") from error
                raise
        await exchange.finish()

    def _refusal_of(self, error: Exception, exchange: Exchange) -> Refused:
        """The response to an error, which is counted, and logged if it is internal."""
        if isinstance(error, OverQuota):
            error = Refused(503 if error.whose == "everybody" else 429, str(error), "places")
        elif isinstance(error, InputError):
            error = Refused(404 if exchange.scope["method"] == "GET" else 422, str(error), "input")
        if isinstance(error, Refused):
            self.figures.refused.labels(error.reason).inc()
            return error
        if is_full(error):
            self.figures.refused.labels("disk").inc()
            return Refused(507, DISK_FULL, "disk")
        self.figures.errors.labels(type(error).__name__).inc()
        log.error("A request failed.", exc_info=error)
        if isinstance(error, SQLAlchemyError):
            return Refused(503, BROKEN, "database")
        sentence = f"Something went wrong inside the program; its log says more under {exchange.reference}."
        return Refused(500, sentence, "")

    def _note(self, exchange: Exchange, scope: Scope) -> None:
        """Counts and logs an exchange, by the pattern of its route: a path can hold the key of a run or of a file."""
        page = exchange.path if exchange.path in PATHS else "(none)"  # also where it comes from the cache
        route = getattr(scope.get("route"), "path", "") or page
        method = exchange.scope["method"]
        method = method if method in (*_CHANGING, "GET", "HEAD", "OPTIONS") else "other"
        status = exchange.status or 499
        self.figures.requests.labels(route, method, str(status)).inc()
        self.figures.answer_seconds.labels(route).observe(exchange.first_byte)
        often = exchange.path.startswith(LIVE)  # some fifteen a second
        log.log(
            logging.DEBUG if often else logging.INFO,
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
            raise Refused(400, "The request has a length but comes in pieces: choose one of the two.", "bad head")
        host = headers.get(b"host", b"").decode("latin-1").lower()
        origin = headers.get(b"origin", b"").decode("latin-1").lower()
        try:
            name, asks = urlsplit(f"//{host}").hostname or "", urlsplit(origin).netloc
        except ValueError:
            raise Refused(400, "The request's Host or Origin is not an address.", "bad head") from None
        if not _HOST.fullmatch(host):
            raise Refused(400, "The request's Host is not a name.", "bad head")
        if self.hosts and name not in self.hosts:
            raise Refused(421, "This server does not go by that name: set PASDEDEUX_HOSTS to its names.", "host")
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
        network = network_of(address)
        nobody = Visitor(f"address {network}", "", exchange.reference, base)
        if path in _WATCHED:  # they answer while everything else waits
            self.quotas.gets.take(f"watching {network}")
            return nobody
        try:
            find = partial(find_visitor, self.settings, self.lab.accounts, scope, nobody)
            # Whom a cookie or a proxy names, the database knows.
            named = SESSION_COOKIE.encode() in headers.get(b"cookie", b"") or self.settings.proxy_user
            visitor = await run_in_threadpool(find) if self.settings.sign_in and named else find()
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
        who, (person, everybody) = visitor or nobody, limits
        person.take(who.person, weight)
        if who.address:  # deleting the cookie does not make a new visitor
            everybody.take(who.address, weight)
        return visitor

    # ---- the body --------------------------------------------------------------------------------

    def _most(self, path: str) -> float:
        """Most bytes of a body; an upload's form has some overhead around the file."""
        megabytes = self.settings.upload_megabytes + 1 if is_upload(path) else self.settings.body_megabytes
        return megabytes * 2**20

    def _weight(self, scope: Scope, headers: dict[bytes, bytes]) -> float:
        """The number of requests that this one counts as; each megabyte of an upload adds one. An undeclared length
        counts as the largest allowed."""
        path, declared = scope["path"], declared_length(headers)
        if path.startswith(LIVE) or is_public_page(path):
            return _LIVE_WEIGHT if path.startswith(LIVE) else _PAGE_WEIGHT
        if not is_upload(path) or declared > (most := self._most(path)):
            return 1.0
        return 1.0 + (declared if b"content-length" in headers else most) / 2**20

    async def _body(self, scope: Scope, exchange: Exchange, receive: Receive, visitor: Visitor) -> BoundedBody:
        """The body of a request that may have one, checked where it is a call of the page's."""
        path, declared = scope["path"], declared_length(exchange.headers)
        most = self._most(path)
        if declared > most:
            raise too_large(most)
        size = most if b"transfer-encoding" in exchange.headers else declared
        if path == "/login":
            self._hold(self.quotas.sign_ins, exchange, visitor)
        elif is_upload(path):
            await self._make_room(visitor, size)
        elif size > _LARGE:
            self._hold(self.quotas.large, exchange, visitor)
        body = BoundedBody(receive, most=most, seconds=self.settings.body_seconds)
        if not is_upload(path) and path.startswith(API):
            self._check_call(await body.whole(), visitor, path)
        return body

    def _hold(self, quota: Quota, exchange: Exchange, visitor: Visitor) -> None:
        """Takes a place until a request is answered; raises OverQuota where there is none."""
        held = [(person, address) for kind, person, address in self._held.values() if kind is quota]
        quota.check(visitor.person, visitor.address, held)
        self._held[exchange] = (quota, visitor.person, visitor.address)

    async def _make_room(self, visitor: Visitor, size: float) -> None:
        """Makes room for an upload on the disk and among the visitor's own files."""
        try:
            await run_in_threadpool(self.lab.storage.check_disk, size)
            await run_in_threadpool(self.lab.storage.admit, visitor, size)
        except InputError as error:
            raise Refused(507, str(error), "room") from None

    def _check_call(self, body: bytes, visitor: Visitor, path: str) -> None:
        way, name, *_ = f"{path[len(API) :]}/".split("/")
        endpoint = self.payloads.number_of(name) if way in ("call", "run", "api") else None
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
        self.payloads.check(fields, endpoint, visitor.person, brief=path.startswith(f"{API}call/"))
        session, event = fields.get("session_hash"), fields.get("event_id")
        if session is not None:
            self.bindings.check(session, visitor.person, visitor.source, begin=True)
        if event is not None:
            self.bindings.check(event, visitor.person, known=True)

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
    sentence = "Sign in first: reload the page, or pass auth=(name, password) from a program."
    return JSONResponse({"detail": sentence}, status_code=401)
