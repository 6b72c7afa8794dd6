"""The errors workhold raises on purpose, and how those of the system are known.

Every message is one plain sentence that names the place and the remedy, because the command line prints it as
it is.
"""

from __future__ import annotations

import errno

from workhold.plain import plain, shortened

__all__ = ["NO_ROOM", "InputError", "WorkholdError", "lacks_memory"]

# A full disk, a used up quota, a limit of the size of files.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# What the system's loader, libraries and threads say where there is no memory for them.
NO_MEMORY = ("failed to map segment", "annot allocate memory", "can't start new thread")


class WorkholdError(Exception):
    """Base of every error workhold raises on purpose."""


class InputError(WorkholdError, ValueError):
    """A file, a flag or a value given by the user cannot be used; the command line exits with code 2.

    What the message quotes of the input may be of any length and steer a terminal; the message does not.
    """

    def __init__(self, message: str) -> None:
        super().__init__(plain(shortened(message)))


def lacks_memory(error: BaseException | None) -> bool:
    """Whether an error is due to too little memory; libraries and threads report it in words of their own."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if any(words in str(error) for words in NO_MEMORY):
            return True
        error = error.__cause__ or error.__context__
    return False
