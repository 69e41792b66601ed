"""The person behind a request, from the server around the page to the code that answers an event."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

from starlette.requests import Request


@dataclass(frozen=True)
class Visitor:
    """The person behind a request.

    Attributes:
        person: the key of their turn in the queue; the address, for people without a name.
        owner: the key of the history that a run goes to; empty if nobody could find it again.
        reference: the request's id in the server's log; empty where the page is served alone.
        base: where the page is, such as "https://lab.example/motion/"; empty where that is not known.
        account: the name they signed in by; empty without accounts.
        address: the address they come from, if strangers are known by a cookie that they could throw away;
            empty otherwise.
    """

    person: str = "local"
    owner: str = "local"
    reference: str = ""
    base: str = ""
    account: str = ""
    address: str = ""

    @property
    def source(self) -> str:
        """The address, or the person where addresses do not count: to whom shares are given."""
        return self.address or self.person


LOCAL = Visitor()
"""The user of a page that runs without the server."""


def request_of_event() -> Any:
    """The request of the event that this thread answers; None elsewhere, as in the shell, which needs no Gradio."""
    context = sys.modules.get("gradio.context")
    return getattr(context and context.LocalContext.request.get(None), "request", None)


def visitor() -> Visitor:
    """The visitor whose event is being answered in this thread."""
    request = request_of_event()
    return LOCAL if request is None else visitor_of(request)


def visitor_of(request: Request) -> Visitor:
    """The person who sent a request, as the guard found them."""
    visitor = request.scope.get("state", {}).get("visitor")
    return visitor if isinstance(visitor, Visitor) else LOCAL
