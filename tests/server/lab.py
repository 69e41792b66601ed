"""A server with the stub engine, for tests and for looking at it: ``python tests/server/lab.py PORT DATA``.

Settings come from the environment as always; ``STUB_PAUSE`` is the stub's seconds a step, ``STUB_PARTNER`` those of a
frame of its live partner.
"""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))


def add_accounts(file: Path, *names: str) -> None:
    """Makes accounts without ids, as a file made by hand has them: what is ada's belongs to "user ada"."""
    from webdemo.server.accounts.users import Users

    for name in names:
        Users(file).add(name, f"password of {name}")
    file.write_text(re.sub(r"#[0-9a-f]{8}:", ":", file.read_text()))


def stub_module() -> ModuleType:
    """The page tests' engine without networks."""
    name = "stub_engine_of_the_page_tests"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ROOT / "tests" / "ui" / "stub_engine.py")
        sys.modules[name] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return sys.modules[name]


if __name__ == "__main__":
    from webdemo.server.logs import set_up_logs
    from webdemo.server.serve import make_server
    from webdemo.server.settings import read_settings

    pause, partner = (float(os.environ.get(name, "0")) for name in ("STUB_PAUSE", "STUB_PARTNER"))
    engine = stub_module().StubEngine(pause=pause, partner_pause=partner)
    settings = read_settings(port=int(sys.argv[1]), data=sys.argv[2])
    set_up_logs(settings.log_level, content=settings.log_content)
    make_server(settings, engine=engine, scratch=True).run()
