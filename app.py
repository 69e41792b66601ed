"""Pas de Deux: motion of two people from one sentence, in the browser.

``python app.py`` opens the page on http://127.0.0.1:7860; a Hugging Face Space runs the same file. Settings
come from the environment and a file, see docs/hosting.md.
"""

from __future__ import annotations

import sys

from webdemo.motion import InputError
from webdemo.server.serve import serve
from webdemo.server.settings import read_settings


def main() -> None:
    """Serves the page; the networks load while it is being looked at."""
    try:
        serve(read_settings())
    except InputError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
