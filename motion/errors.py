"""Errors that a user is meant to read."""


class InputError(ValueError):
    """Something the user gave cannot be used.

    The message is one sentence that says what is wrong and what to do about it; the page, the
    shell and the API show it as it stands.
    """
