"""``python -m training.evaluate``: see :mod:`training.evaluate.captions`."""

from training.evaluate.captions import main

if __name__ == "__main__":
    raise SystemExit(main())
