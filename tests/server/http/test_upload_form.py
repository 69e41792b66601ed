"""The form of an upload is read while it passes, in pieces of any size."""

import pytest

from webdemo.server.http.exchange import MOST_FILES, UploadForm
from webdemo.server.http.routes import Refused

TYPE = b"multipart/form-data; boundary=xyz"


def part(head: str, body: bytes = b"data") -> bytes:
    return f"--xyz\r\nContent-Disposition: form-data; {head}\r\n\r\n".encode() + body + b"\r\n"


GOOD = part('name="files"; filename="walk.bvh"')
END = b"--xyz--\r\n"


def feed(body: bytes, size: int = 7, kind: bytes = TYPE) -> None:
    form = UploadForm(kind)
    for first in range(0, len(body), size):
        form.feed(body[first : first + size], last=first + size >= len(body))


@pytest.mark.parametrize("size", [1, 7, 10_000])
def test_files_pass(size: int) -> None:
    feed(2 * GOOD + END, size)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (END, "no file is in it"),
        (GOOD, "cut short"),
        (GOOD[:-2], "cut short"),
        (b"nonsense", "damaged"),
        (part('name="other"; filename="walk.bvh"') + END, 'called "files"'),
        (part('name="files"') + END, 'called "files"'),
        (part('name="files"; filename="..."') + END, "no name"),
        (part(f'name="files"; filename="{"x" * 9000}.bvh"') + END, "damaged"),
        ((MOST_FILES + 1) * GOOD + END, f"more than {MOST_FILES} files"),
    ],
)
def test_other_forms_are_refused(body: bytes, says: str) -> None:
    with pytest.raises(Refused, match=says) as refused:
        feed(body)
    assert refused.value.status == 400


@pytest.mark.parametrize(
    "kind",
    [
        b"application/json",
        b"multipart/form-data",
        b"multipart/form-data; boundary=" + b"x" * 201,
        b"multipart/form-data; boundary=xyz; charset=utf-16",
    ],
)
def test_other_types_are_refused(kind: bytes) -> None:
    with pytest.raises(Refused):
        UploadForm(kind)
