"""The small pages hold what users wrote as text, never as markup."""

from webdemo.server.http.error_pages import message_card, sign_in_card

EVIL = '"><script>alert(1)</script>'


def test_nothing_that_came_from_outside_becomes_markup() -> None:
    pages = (
        message_card(EVIL, home=EVIL, reference=EVIL),
        sign_in_card(action=EVIL, wanted=EVIL, name=EVIL, error=EVIL),
    )
    for page in pages:
        assert "<script" not in page and "&lt;script&gt;" in page


def test_the_form_says_why_and_keeps_the_name() -> None:
    shared = sign_in_card(action="login", wanted="/?run=abc")
    assert "the motion that you were sent" in shared and 'role="alert"' not in shared
    again = sign_in_card(action="login", wanted="/", name="ann", error="Wrong password.")
    assert 'value="ann"' in again and "Wrong password." in again and "generate motion" in again
