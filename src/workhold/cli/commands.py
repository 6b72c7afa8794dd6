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
from typing import Any, TextIO, TypeVar, get_type_hints

import typer
from attrs import fields, resolve_types
from typer.core import TyperCommand, TyperGroup

from workhold.cli.table import find_terminal_width, wrap_sentence
from workhold.errors import NO_ROOM, make_printable, shorten_middle

__all__ = [
    "PlainCommand",
    "PlainGroup",
    "make_flag",
    "redirect_to_null",
    "make_option",
    "print_remark",
    "spread_option_groups",
    "make_default_group",
]


def print_remark(message: str) -> None:
    """Print a remark on stderr with "workhold: " before it, wrapped only on a terminal.

    A remark is lost silently where the disk is full.
    """
    line = f"workhold: {make_printable(shorten_middle(message))}"
    if sys.stderr.isatty():
        line = "\n".join(wrap_sentence(line, find_terminal_width(sys.stderr)))
    try:
        typer.echo(line, err=True)
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        redirect_to_null(sys.stderr)


def redirect_to_null(stream: TextIO) -> None:
    """Redirect a stream to the null device because its reader is gone or the disk is full.

    Otherwise the interpreter would complain when it flushes the stream at exit.
    """
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


BAD_INPUT = 2
ARGUMENTS, OPTIONS, COMMANDS = "Arguments", "Options", "Commands"
# A group of options.
Words = TypeVar("Words")
# Columns of a help's left side; longer entries have a line of their own.
WIDEST_ENTRY = 27


def make_option(panel: str | None, metavar: str, help: str, *names: str, default: str | None = None) -> Any:
    """Return a Typer option with a value, to stand as the default of a parameter or of a field of a group.

    Parameters
    ----------
    panel : section of the help; None for the general one.
    metavar : placeholder for the value in the help.
    names : names of the option, such as "--out"; without any, the name is made from the parameter's.
    default : as it would be typed.
    """
    return typer.Option(default, *names, metavar=metavar, help=help, rich_help_panel=panel)


def make_flag(panel: str | None, help: str, name: str) -> Any:
    """Return a Typer option without a value, off if not given; see :func:`make_option`."""
    return typer.Option(False, name, help=help, rich_help_panel=panel)


def spread_option_groups(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command in whose signature the options of each group stand in place of the group.

    A group is an attrs class whose fields are options. When called, the new command builds the groups from
    its options and calls ``command`` with them.
    """
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


def make_default_group(kind: type[Words], **typed: Any) -> Words:
    """Return a group of options, each at its default except those given in ``typed``."""
    usual = {name: one.default.default for name, one in signature(kind).parameters.items()}
    return kind(**usual | typed)


class PlainCommand(TyperCommand):
    """A subcommand whose parameters are words."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the command's parameters and the help option, all with Typer's checks of values switched
        off.
        """
        return pass_words_unchecked(super().get_params(ctx))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write usage, text, and parameters section by section to the formatter."""
        self.format_usage(ctx, formatter)
        write_text(self, formatter)
        write_sections(self, ctx, formatter)
        restore_hyphens(formatter)


class PlainGroup(TyperGroup):
    """A group of subcommands, which shows the help where no subcommand is named."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the group's parameters and the help option, all with Typer's checks of values switched off."""
        return pass_words_unchecked(super().get_params(ctx))

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Return the arguments from the subcommand on, after parsing those before it.

        Without any argument, print the help and exit with BAD_INPUT, unless a shell asks for completions.
        """
        if not args and not ctx.resilient_parsing:
            typer.echo(ctx.get_help())
            raise typer.Exit(BAD_INPUT)
        return super().parse_args(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write usage, text, options, subcommands each with its first paragraph,
        and the epilog to the formatter.
        """
        self.format_usage(ctx, formatter)
        write_text(self, formatter)
        write_sections(self, ctx, formatter)
        commands = [
            (name, cleandoc(command.help or "").split("\n\n")[0]) for name, command in self.commands.items()
        ]
        with formatter.section(format_heading(COMMANDS)):
            formatter.write_dl(commands, col_max=WIDEST_ENTRY)
        restore_hyphens(formatter)
        formatter.write(f"\n{cleandoc(self.epilog or '')}\n")


def pass_words_unchecked(parameters: list[Any]) -> list[Any]:
    """Return the same parameters, changed in place so that Typer passes on a word, or None, unchecked.

    None stands for an option not given.
    """
    for parameter in parameters:
        if "process_value" not in vars(parameter):
            parameter.process_value = partial(take_parameter_value, parameter, parameter.process_value)
    return parameters


def take_parameter_value(parameter: Any, checked: Callable[[Any, Any], Any], ctx: Any, value: Any) -> Any:
    """Return the value of a parameter, unchecked if it is a word or None (an option not given).

    For any other value, return what ``checked(ctx, value)`` returns.
    """
    if isinstance(value, str) or (value is None and not parameter.required):
        return value if parameter.callback is None else parameter.callback(ctx, parameter, value)
    return checked(ctx, value)


def format_heading(words: str) -> str:
    """Return a heading of the help, bold on a terminal."""
    return typer.style(words, bold=True)


# A hyphen at which no line is broken, so that names of options stay whole and can be copied.
NO_BREAK = "\N{NON-BREAKING HYPHEN}"


def replace_hyphens(text: str) -> str:
    """Return text with non-breaking hyphens, so that names of options are not split across lines.

    >>> replace_hyphens("--peg-radius").count("-")
    0
    """
    return text.replace("-", NO_BREAK)


def restore_hyphens(formatter: Any) -> None:
    """Replace non-breaking hyphens by plain ones in all that a formatter has so far, in place."""
    formatter.buffer[:] = [text.replace(NO_BREAK, "-") for text in formatter.buffer]


def write_text(command: Any, formatter: Any) -> None:
    """Write the help text of a command to the formatter."""
    formatter.write_paragraph()
    with formatter.indentation():
        formatter.write_text(replace_hyphens(cleandoc(command.help or "")))


def write_sections(command: Any, ctx: Any, formatter: Any) -> None:
    """Write the parameters of a command to the formatter,
    each in the section of its panel; the general section is last.
    """
    sections: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.get_params(ctx):
        entry = parameter.get_help_record(ctx)
        if entry is None:
            continue
        others = OPTIONS
        if parameter.param_type_name == "argument":
            # Typer would add the type of the value, which is text for all of them.
            others, entry = ARGUMENTS, (parameter.metavar, entry[1])
        panel = getattr(parameter, "rich_help_panel", None) or others
        sections.setdefault(panel, []).append((entry[0], replace_hyphens(entry[1])))
    for name in sorted(sections, key=lambda name: name == OPTIONS):
        with formatter.section(format_heading(name)):
            formatter.write_dl(sections[name], col_max=WIDEST_ENTRY)
