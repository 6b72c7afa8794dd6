"""What is said beside the result of a command."""

from __future__ import annotations

import typer

from workhold.plain import plain, shortened

__all__ = ["tell"]


def tell(message: str) -> None:
    """One line on stderr, whatever the message quotes."""
    typer.echo(f"workhold: {plain(shortened(message))}", err=True)
