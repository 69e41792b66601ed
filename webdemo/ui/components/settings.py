"""Settings that the browser fits to a choice."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any


def looked_up(table: Mapping[str, Sequence[Any]]) -> str:
    """JavaScript that answers with the updates of a table by the value, or values joined by "/", of its inputs.

    The browser answers at once, so that no late update takes back what was set meanwhile.
    """
    return f"(...keys) => ({json.dumps(table)})[keys.map((key) => key ?? '').join('/')]"
