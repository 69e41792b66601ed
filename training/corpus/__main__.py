"""``python -m training.corpus``: see :mod:`training.corpus.build`."""

from training.corpus.build import main

if __name__ == "__main__":
    raise SystemExit(main())
