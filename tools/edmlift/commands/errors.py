"""What a command says when it cannot go on."""

import contextlib
from collections.abc import Iterator

TROUBLE, WRONG_OPTION, INTERRUPTED = 1, 2, 130  # exit statuses; argparse has the second, too


class CommandError(Exception):
    """What is wrong, in one line."""


class OptionError(CommandError):
    """What is wrong with an option."""


@contextlib.contextmanager
def about_options() -> Iterator[None]:
    """A ValueError in here is about an option."""
    try:
        yield
    except ValueError as error:
        raise OptionError(str(error)) from None
