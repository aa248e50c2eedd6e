"""Messages of errors that have words of files in them."""

import re


class OneLineError(Exception):
    """Its message is one line of text that can be printed, whatever a name in a file is made of."""

    def __init__(self, message: str) -> None:
        super().__init__(_printable(re.sub(r"\s*\n\s*", " ", message)))


def _printable(text: str) -> str:
    """With what a terminal would obey, or not show, as an escape sequence."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )
