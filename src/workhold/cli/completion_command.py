"""``workhold completion``: what makes a shell complete commands and options."""

from __future__ import annotations

import sys
from typing import Annotated

import typer
import typer.completion

from workhold.cli.values import choice

__all__ = ["completion"]

SHELLS = ("bash", "zsh", "fish")
# What the shell sets when it asks for words; see Workhold in ``cli.main``.
VARIABLE = "_WORKHOLD_COMPLETE"


def completion(shell: Annotated[str, typer.Argument(metavar="SHELL", help="bash, zsh or fish.")]) -> None:
    """Print the script that lets a shell complete the commands and options of workhold.

    In ~/.bashrc: eval "$(workhold completion bash)"; in ~/.zshrc, after compinit: eval "$(workhold completion zsh)"; for
    fish write it to ~/.config/fish/completions/workhold.fish.

    Example: workhold completion bash
    """
    name = choice("the shell", shell, SHELLS)
    script = typer.completion.get_completion_script(prog_name="workhold", complete_var=VARIABLE, shell=name)  # type: ignore[attr-defined]
    sys.stdout.write(script + "\n")
    sys.stdout.flush()
