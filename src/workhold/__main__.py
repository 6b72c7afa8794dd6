"""The command ``workhold``, also as ``python -m workhold``."""

import os
import sys
from typing import NoReturn

from workhold.cli.ending import INTERRUPTED, end_on_signals, report_interrupted_once

__all__ = ["run"]


def open_closed_streams() -> None:
    """Open ``os.devnull`` for each standard stream that is closed (None in ``sys``).

    Otherwise the next file opened would get the closed stream's descriptor.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), "w" if number else "r"))


def run() -> NoReturn:
    """Run the command line and exit; Ctrl-C exits in the same way during imports as during the command."""
    open_closed_streams()
    try:
        end_on_signals()
        from workhold.cli.main import run

        run()
    except KeyboardInterrupt:
        report_interrupted_once()
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    run()
