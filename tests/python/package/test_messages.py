"""Messages of errors that have words of files in them."""

import pytest

from edmlift.messages import OneLineError


@pytest.mark.parametrize(
    ("message", "shown"),
    [
        ("layer ü of 3 × 4", "layer ü of 3 × 4"),
        ("two  spaces", "two  spaces"),
        ("relu of z0\n  0: no", "relu of z0 0: no"),
        ("\x1b[31m\r\t", r"\x1b[31m\r\t"),
        ("a\u2028b\x85c\udc80", r"a\u2028b\x85c\udc80"),
    ],
)
def test_a_message_is_one_line_that_can_be_printed(message: str, shown: str):
    assert str(OneLineError(message)) == shown
    assert shown.encode() and len(shown.splitlines()) == 1
