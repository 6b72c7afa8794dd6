"""The command ``workhold``, also as ``python -m workhold``."""

import sys
from typing import NoReturn

__all__ = ["run"]

INTERRUPTED = 130


def run() -> NoReturn:
    """Run the command line; Ctrl-C while it is being loaded ends it as it does later."""
    try:
        from workhold.cli.main import run
    except KeyboardInterrupt:
        sys.stderr.write("workhold: interrupted; no unfinished file was left behind.\n")
        sys.exit(INTERRUPTED)
    run()


if __name__ == "__main__":
    run()
