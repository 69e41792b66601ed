"""Runs :mod:`training.evaluate.paper_tables.run` as a command."""

from .run import main

raise SystemExit(main())
