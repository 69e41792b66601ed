"""Runs :mod:`training.evaluate.paper_tables.run` as a command."""

from .run import main

if __name__ == "__main__":
    raise SystemExit(main())
