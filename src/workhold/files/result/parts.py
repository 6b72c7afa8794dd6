"""The two parts of a result file: its head, checked by pydantic, and its fixtures as JSON objects, one after the other.

A file with one fixture per line, as workhold writes it, is read line by line, so that no more than one fixture at a time is
an object; any other layout of the same JSON is read as a whole. Whoever reads a result file reads it by this module.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from workhold.errors import InputError
from workhold.files.result.forms import Head
from workhold.files.result.head import checked_head
from workhold.files.text import json_value

__all__ = ["read_parts"]

# Bytes of a file of another layout, which takes twenty times as much memory.
LARGEST_WHOLE = 200_000_000

Taken = TypeVar("Taken")
Take = Callable[[Iterable[Any], Path], Taken]


class OtherLayoutError(Exception):
    """The file does not have one fixture on every line."""


def read_parts(path: Path, take: Take[Taken]) -> tuple[Head, Taken]:
    """Head and fixtures of a result file.

    Parameters
    ----------
    take : makes something of the fixtures, once from first to last; it may be called a second time from the start.

    Raises
    ------
    InputError
        When the file cannot be read, or is no result file, and what ``take`` raises.
    """
    try:
        try:
            data, taken = read_lines(path, take)
        except OtherLayoutError:
            data, taken = read_whole(path, take)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not a result file: it is not text.") from error
    except RecursionError as error:
        raise InputError(f"{path} is not a result file: its brackets are nested too deeply.") from error
    return checked_head(data, path), taken


def read_lines(path: Path, take: Take[Taken]) -> tuple[Any, Taken]:
    """Head and fixtures of a file with one fixture per line.

    Raises
    ------
    OtherLayoutError
        When the lines are not of that form.
    """
    with path.open(encoding="utf-8-sig") as stream:
        before: list[str] = []
        for line in stream:
            before.append(line)
            if line.strip() == '"fixtures": [':
                break
        else:
            raise OtherLayoutError
        after: list[str] = []
        taken = take(fixture_lines(stream, after), path)
        try:
            data = json_value("".join(before + after) + stream.read())
        except ValueError as error:
            raise OtherLayoutError from error
    return data, taken


def fixture_lines(stream: Iterable[str], after: list[str]) -> Iterator[Any]:
    """The fixtures on their lines; the line that ends the list goes to ``after``."""
    last = False
    for line in stream:
        text = line.strip()
        if text.startswith("]"):
            after.append(line)
            return
        if last:
            raise OtherLayoutError
        last = not text.endswith(",")
        try:
            yield json_value(text.removesuffix(","))
        except ValueError as error:
            raise OtherLayoutError from error
    raise OtherLayoutError


def read_whole(path: Path, take: Take[Taken]) -> tuple[Any, Taken]:
    """Head and fixtures of a file of any layout."""
    if path.is_file() and path.stat().st_size > LARGEST_WHOLE:
        raise InputError(
            f"{path} is too large a file to be read but with one fixture on every line, as workhold writes it."
        )
    text = path.read_text(encoding="utf-8-sig")
    if not text.strip():
        raise InputError(f"{path} is empty: it is not a result file.")
    try:
        data = json_value(text)
    except InputError as error:
        raise InputError(f"{path} is not a result file: {error}") from error
    if not isinstance(data, dict) or not isinstance(data.get("fixtures"), list):
        raise InputError(f"{path} is not a result file: it has no list of fixtures.")
    return data, take(data["fixtures"], path)
