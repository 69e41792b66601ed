"""How a step of the training ends in a shell."""

from __future__ import annotations

import sys
from collections.abc import Callable

from safetensors import SafetensorError

from webdemo.motion import InputError


def exit_code(job: Callable[[], None]) -> int:
    """Runs a job; 0, or 2 after one line on stderr that says what is wrong and what to do."""
    try:
        job()
    except InputError as error:
        message = str(error)
    except (OSError, SafetensorError) as error:  # a full disk, as the tensor writer says it
        message = f"A file could not be written ({error}): free disk space or choose another folder."
    else:
        return 0
    print(" ".join(message.split()), file=sys.stderr)
    return 2
