"""Shared parts of all commands: remarks on standard error, a plain help in sections, and words as typed.

Typer would format the help with Rich and check every value with pydantic. Both take longer to import than
most commands take to run. The help needs no boxes, and :mod:`workhold.cli.values` reads the words anyway.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import partial, wraps
from inspect import Parameter, Signature, cleandoc, signature
from typing import Any, TextIO, get_type_hints

import typer
from attrs import fields, resolve_types
from typer.core import TyperCommand, TyperGroup

from workhold.limits import NO_ROOM
from workhold.plain import plain, shortened

__all__ = ["PlainCommand", "PlainGroup", "forget", "option", "spread", "tell"]


def tell(message: str) -> None:
    """One line on stderr, whatever the message quotes; a full disk, as of a log, loses it and changes nothing else."""
    try:
        typer.echo(f"workhold: {plain(shortened(message))}", err=True)
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        forget(sys.stderr)


def forget(stream: TextIO) -> None:
    """Nobody reads a stream any more, or it has no room: send the rest nowhere, so that the interpreter ends in peace."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


BAD_INPUT = 2
ARGUMENTS, OPTIONS, COMMANDS = "Arguments", "Options", "Commands"
# Columns of a help's left side; longer entries have a line of their own.
WIDEST_ENTRY = 27


def option(panel: str | None, metavar: str, help: str, *names: str, default: str | None = None) -> Any:
    """An option of a section of the help, as the default value of a parameter or of a field in a group of words."""
    return typer.Option(default, *names, metavar=metavar, help=help, rich_help_panel=panel)


def spread(command: Callable[..., None]) -> Callable[..., None]:
    """A command in whose place of each group of words, an attrs class of options, the class's fields stand as options."""
    kinds = get_type_hints(command, include_extras=True)
    groups = {
        name: kinds[name] for name in signature(command).parameters if hasattr(kinds[name], "__attrs_attrs__")
    }
    parameters: list[Parameter] = []
    for name, parameter in signature(command).parameters.items():
        shown = signature(groups[name]).parameters.values() if name in groups else [parameter]
        hints = (
            {one.name: one.type for one in fields(resolve_types(groups[name]))} if name in groups else kinds
        )
        parameters += [one.replace(annotation=hints[one.name], kind=Parameter.KEYWORD_ONLY) for one in shown]

    @wraps(command)
    def spread_out(**words: Any) -> None:
        taken = {
            name: {one: words.pop(one) for one in signature(kind).parameters} for name, kind in groups.items()
        }
        command(**words, **{name: kind(**taken[name]) for name, kind in groups.items()})

    spread_out.__dict__["__signature__"] = Signature(parameters)
    spread_out.__annotations__ = {one.name: one.annotation for one in parameters}
    return spread_out


class PlainCommand(TyperCommand):
    """A subcommand whose parameters are words."""

    def get_params(self, ctx: Any) -> list[Any]:
        """The parameters and the help option, whose words are not checked here."""
        return as_typed(super().get_params(ctx))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Usage, text, and the parameters by their sections."""
        self.format_usage(ctx, formatter)
        self.format_help_text(ctx, formatter)
        write_sections(self, ctx, formatter)


class PlainGroup(TyperGroup):
    """A group of subcommands; without any word it shows the help."""

    def get_params(self, ctx: Any) -> list[Any]:
        """The parameters and the help option, whose words are not checked here."""
        return as_typed(super().get_params(ctx))

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the words in front of the subcommand, or show the help where there is none and no shell asks for one.

        Raises
        ------
        typer.Exit
            Without any word.
        """
        if not args and not ctx.resilient_parsing:
            typer.echo(ctx.get_help())
            raise typer.Exit(BAD_INPUT)
        return super().parse_args(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Usage, text, options, subcommands with the first paragraph of their texts, and the epilog as it is."""
        self.format_usage(ctx, formatter)
        self.format_help_text(ctx, formatter)
        write_sections(self, ctx, formatter)
        commands = [
            (name, cleandoc(command.help or "").split("\n\n")[0]) for name, command in self.commands.items()
        ]
        with formatter.section(heading(COMMANDS)):
            formatter.write_dl(commands, col_max=WIDEST_ENTRY)
        formatter.write(f"\n{cleandoc(self.epilog or '')}\n")


def as_typed(parameters: list[Any]) -> list[Any]:
    """The same parameters, which from now on hand on a word, or None for an option not given, without a check."""
    for parameter in parameters:
        if "process_value" not in vars(parameter):
            parameter.process_value = partial(taken, parameter, parameter.process_value)
    return parameters


def taken(parameter: Any, checked: Callable[[Any, Any], Any], ctx: Any, value: Any) -> Any:
    """The value of a parameter; what is neither a word nor missing by right is for Typer to check."""
    if isinstance(value, str) or (value is None and not parameter.required):
        return value if parameter.callback is None else parameter.callback(ctx, parameter, value)
    return checked(ctx, value)


def heading(words: str) -> str:
    """A heading of the help, bold on a terminal."""
    return typer.style(words, bold=True)


def write_sections(command: Any, ctx: Any, formatter: Any) -> None:
    """Write a command's parameters, each in the section named by its panel; the options without one come last."""
    sections: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.get_params(ctx):
        entry = parameter.get_help_record(ctx)
        if entry is None:
            continue
        others = OPTIONS
        if parameter.param_type_name == "argument":
            # Typer would add the type of the value, which is text for all of them.
            others, entry = ARGUMENTS, (parameter.metavar, entry[1])
        sections.setdefault(getattr(parameter, "rich_help_panel", None) or others, []).append(entry)
    for name in sorted(sections, key=lambda name: name == OPTIONS):
        with formatter.section(heading(name)):
            formatter.write_dl(sections[name], col_max=WIDEST_ENTRY)
