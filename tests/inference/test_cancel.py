"""Cancelling a run from another thread."""

import threading

import pytest

from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import Cancelled


def test_nothing_happens_until_a_token_is_set() -> None:
    token = CancelToken()
    token.raise_if_cancelled()
    assert not token.cancelled and not token.is_set()


def test_another_thread_cancels() -> None:
    token = CancelToken()
    other = threading.Thread(target=token.cancel)
    other.start()
    other.join()
    assert token.cancelled and token.is_set()
    token.cancel()  # once more changes nothing
    with pytest.raises(Cancelled):
        token.raise_if_cancelled()
