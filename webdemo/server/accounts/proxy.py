"""Signing in by a reverse proxy's header: who a person is, the proxy says, and nobody else can.

uvicorn puts the forwarded address in the place of the proxy's. So the one that the connection came from is written
down before, by :class:`PeerNoted`, and a header counts only if that is a trusted proxy's.
"""

from __future__ import annotations

import ipaddress
import re
from collections.abc import Mapping, Sequence

from starlette.types import ASGIApp, Receive, Scope, Send

from webdemo.server.http.refused import Refused
from webdemo.server.settings import Settings

PEER = "pasdedeux.peer"
"""Key of a request's scope: the address that its connection came from."""
NAME = re.compile(r"\A[a-z0-9][a-z0-9._@+-]{0,79}\Z")
"""Names of people who sign in elsewhere, in lower case: also addresses of mail."""
_NOT_BY_PROXY = "This lab is reached through its proxy, where you sign in: open its usual address."
_BAD_NAME = "The proxy's name for you cannot be used here: tell the person who runs this server."
_NOT_ALLOWED = "You belong to none of the groups that may use this lab: ask the person who runs it."


class PeerNoted:
    """Writes the address of the connection into each request's scope, before a proxy's header changes it."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes a request on."""
        if client := scope.get("client"):
            scope = {**scope, PEER: client[0]}
        await self.app(scope, receive, send)


def is_among(address: str, networks: Sequence[str]) -> bool:
    """True if an address is one of these addresses and networks; a name among them is no address."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return False
    for network in networks:
        try:
            if found in ipaddress.ip_network(network, strict=False):
                return True
        except ValueError:
            continue
    return False


def person_by_proxy(settings: Settings, scope: Scope) -> str:
    """The name that a trusted proxy gives the sender of a request; "" where it gives none.

    Raises:
        Refused: for a request that did not come through a trusted proxy and bears the header, a name that cannot be
            used, and a person of none of the allowed groups.
    """
    names = _values(scope, settings.proxy_user)
    if not names or not settings.proxy_user:
        return ""
    if not is_among(scope.get(PEER, ""), settings.proxies):
        raise Refused(403, _NOT_BY_PROXY, "proxy")
    name = names[0].strip().lower()
    if not name:
        return ""
    if len(names) > 1 or not NAME.match(name):
        raise Refused(403, _BAD_NAME, "proxy")
    if settings.groups and not set(groups_of(_values(scope, settings.proxy_groups))) & set(settings.groups):
        raise Refused(403, _NOT_ALLOWED, "proxy")
    return name


def admin_by_proxy(settings: Settings, scope: Scope) -> bool | None:
    """True if the sender's groups make them an administrator; None where groups do not decide that."""
    if not settings.admin_groups:
        return None
    return bool(set(groups_of(_values(scope, settings.proxy_groups))) & set(settings.admin_groups))


def groups_of(values: Sequence[str]) -> list[str]:
    """The groups that are listed, with commas, semicolons or bars between them."""
    return [group.strip() for value in values for group in re.split("[,;|]", value) if group.strip()]


def not_by_proxy() -> Refused:
    """The refusal of a person whom no proxy has named, where there is no other way to sign in."""
    return Refused(401, _NOT_BY_PROXY, "proxy")


def _values(scope: Mapping[str, object], header: str) -> list[str]:
    wanted = header.lower().encode("latin-1")
    headers: Sequence[tuple[bytes, bytes]] = scope.get("headers", ())  # type: ignore[assignment]
    return [value.decode("latin-1") for name, value in headers if name == wanted] if wanted else []
