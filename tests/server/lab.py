"""A server with the stub engine, for tests and for looking at it: ``python tests/server/lab.py PORT DATA``.

Settings come from the environment as always; ``STUB_PAUSE`` is the stub's seconds a step, ``STUB_PARTNER`` those of a
frame of its live partner.
"""

from __future__ import annotations

import importlib.util
import os
import socket
import sys
from pathlib import Path
from types import ModuleType

from sqlalchemy import update

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))


def free_port() -> int:
    """A port of this machine that nobody listens at."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def add_accounts(data: Path, *names: str) -> None:
    """Makes accounts without ids: what is ada's belongs to "user ada"."""
    from webdemo.server.accounts.accounts import Accounts
    from webdemo.server.store.database import Account, Database

    database = Database(data / "history.db")
    for name in names:
        Accounts(database).add(name, f"password of {name}")
    with database.session.begin() as session:
        session.execute(update(Account).values(key=Account.name))
    database.close()


def stub_module() -> ModuleType:
    """The page tests' engine without networks."""
    name = "stub_engine_of_the_page_tests"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ROOT / "tests" / "ui" / "stub_engine.py")
        sys.modules[name] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return sys.modules[name]


def serve(port: int, data: str) -> None:
    """Serves until the process ends."""
    from webdemo.server.http import exchange
    from webdemo.server.logs import set_up_logs
    from webdemo.server.queue import events
    from webdemo.server.serve import make_server
    from webdemo.server.settings import read_settings
    from webdemo.server.store import database

    exchange.BACK_OFF, database.SOUND_SECONDS = 0.0, 1.0  # no test waits for a refusal or for a look at the database
    events.UNREAD_SECONDS = 3600.0  # some fetch their answers last
    pause, partner = (float(os.environ.get(name, "0")) for name in ("STUB_PAUSE", "STUB_PARTNER"))
    engine = stub_module().StubEngine(pause=pause, partner_pause=partner)
    settings = read_settings(port=port, data=data)
    set_up_logs(settings.log_level, content=settings.log_content)
    make_server(settings, engine=engine, scratch=True).run()


def serve_apart(port: int, data: str, log: str, environment: dict[str, str]) -> None:
    """Serves in a process that was forked from one in which :mod:`tests.server.ready` is imported."""
    os.environ.clear()
    os.environ.update(environment)
    written = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for output in (1, 2):
        os.dup2(written, output)
    serve(port, data)


if __name__ == "__main__":
    serve(int(sys.argv[1]), sys.argv[2])
