"""Everything that is timed: ``python -m webdemo benchmark``."""
