"""The errors workhold raises on purpose.

Every message is one plain sentence that names the place and the remedy, because the command line prints it as it is.
"""

from workhold.plain import plain, shortened

__all__ = ["WorkholdError", "InputError"]


class WorkholdError(Exception):
    """Base of every error workhold raises on purpose."""


class InputError(WorkholdError, ValueError):
    """A file, a flag or a value given by the user cannot be used; the command line exits with code 2.

    What the message quotes of the input may be of any length and steer a terminal; the message does not.
    """

    def __init__(self, message: str) -> None:
        super().__init__(plain(shortened(message)))
