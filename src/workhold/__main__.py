"""The command ``workhold``, also as ``python -m workhold``."""

import os
import sys
from typing import NoReturn

from workhold.cli.ending import INTERRUPTED, end_on_signals, say_interrupted

__all__ = ["run"]


def open_closed_streams() -> None:
    """Opens every closed standard stream to nowhere; the next file opened would take its place."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), "w" if number else "r"))


def run() -> NoReturn:
    """Runs the command line; Ctrl-C while it is being loaded ends it as it does later."""
    open_closed_streams()
    try:
        end_on_signals()
        from workhold.cli.main import run

        run()
    except KeyboardInterrupt:
        say_interrupted()
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    run()
