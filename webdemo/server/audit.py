"""Log lines of the server's log for sign-ins, opened links, imports, deletions and acts of administrators.

They are those of the logger ``webdemo.server.audit``, with ``act``, ``ok``, ``person`` and ``address``. They hold
names, addresses, ids and counts, never a password, a cookie, a link or what somebody wrote.
"""

from __future__ import annotations

import hashlib
import logging
from contextvars import ContextVar

from webdemo.server.logs import REFERENCE
from webdemo.ui.visitor import request_of_event, visitor

log = logging.getLogger(__name__)

SENDER: ContextVar[tuple[str, str]] = ContextVar("sender", default=("", ""))
"""The person and the address behind the request that is being answered."""
LONGEST = 300
"""Characters of a value."""


def audit(act: str, *, ok: bool = True, person: str = "", **details: str | float | None) -> None:
    """Writes one line.

    Args:
        act: in a few words with hyphens, such as "sign-in" or "link-opened"; those of administrators begin with
            "admin-".
        ok: False where it was refused or failed.
        person: by default the person whose request or event this thread answers.
        details: further plain values. Give :func:`fingerprint` in place of anything that opens a door.
    """
    someone, somewhere, reference = _sender()
    short = {k: v[:LONGEST] if isinstance(v, str) else v for k, v in details.items() if v is not None}
    line = {"act": act, "ok": ok, "person": person or someone, "address": somewhere, "request": reference}
    log.info("audit", extra=line | short)


def fingerprint(secret: str) -> str:
    """Twelve characters that stand for a secret, so that lines about the same one can be told, and no more."""
    return hashlib.sha256(secret.encode()).hexdigest()[:12]


def _sender() -> tuple[str, str, str]:
    """The person, the address and the id of the request that this thread answers."""
    client = getattr(request_of_event(), "client", None)  # of an event of the page, perhaps in a queue
    if client is None:
        return *SENDER.get(), REFERENCE.get()
    who = visitor()
    return who.account or who.person, client.host, who.reference
