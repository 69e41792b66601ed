"""Pas de Deux: motion of two people from one sentence, in the browser.

``python app.py`` opens the page on http://127.0.0.1:7860; a Hugging Face Space runs the same file. Settings
come from the environment and a file, see docs/hosting.md; ``--host`` and ``--port`` go before those.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from webdemo import cli


def main(argv: Sequence[str]) -> int:
    """Serves the page; the networks load while it is being looked at."""
    return cli.main(["serve", *argv])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
