"""``python -m training.evaluate``: see :mod:`training.evaluate.generation`."""

from training.evaluate.generation import main

if __name__ == "__main__":
    main()
