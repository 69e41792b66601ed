"""``python -m webdemo``: see :mod:`webdemo.cli`."""

import sys

from webdemo.cli import main

if __name__ == "__main__":
    sys.exit(main())
