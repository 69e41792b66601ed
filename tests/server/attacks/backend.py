"""Every route of the application and every function of its page, as they are built and not as a list says."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from gradio.routes import App

from webdemo.server.app import create_app

from ..clients import settings_for
from ..lab import add_accounts, stub_module


class Backend:
    """The application with accounts, which has all routes.

    Args:
        folder: for its data.

    Attributes:
        blocks: the page's components, by their ids.
        routes: "METHOD /path" of each, with the names of its parameters.
        functions: the page's functions that run on the server, by their index.
        names: their names, such as "HistoryTab.act"; several indexes may share one.
    """

    def __init__(self, folder: Path) -> None:
        add_accounts(folder / "data", "ada")
        settings = settings_for(folder, accounts=True, host="0.0.0.0")
        app = create_app(settings, engine=stub_module().StubEngine())
        found = list(_routes(app.routes))
        self.routes = {f"{method} {route.path}" for route in found for method in route.methods}
        (page,) = [route.app.blocks for route in app.routes if isinstance(getattr(route, "app", None), App)]
        self.blocks = page.blocks
        self.functions = {number: fn for number, fn in page.fns.items() if fn.fn is not None}
        self.names = {number: _name(fn.fn) for number, fn in self.functions.items()}
        app.state.lab.database.close()

    def number(self, name: str) -> int:
        """The first index of the functions of a name."""
        return min(number for number, known in self.names.items() if known == name)


def _routes(routes: Any) -> Iterator[Any]:
    for route in routes:
        inner = getattr(route, "original_router", None) or getattr(route, "app", None)
        if getattr(route, "methods", None):
            yield route
        elif inner is not None:
            yield from _routes(inner.routes)


def _name(function: Any) -> str:
    while isinstance(function, partial):
        function = function.func
    return function.__qualname__
