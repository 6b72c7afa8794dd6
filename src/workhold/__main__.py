"""``python -m workhold``: the command line."""

from workhold.cli.main import run

run()
