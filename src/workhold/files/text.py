"""Users' text files, JSON and TOML, read whole within a limit of size.

Two things that Python's readers accept are refused. One is a repeated key, for which Python silently takes
the last value. The other is a whole number too large for a float.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, NoReturn

from workhold.errors import InputError
from workhold.files.budget import FileLimits

__all__ = ["parse_json", "read_at_most", "read_limited", "read_text", "refuse_large_file", "parse_toml"]

# Floats end at 1.8e308.
MOST_DIGITS = 308
# Bytes that are read at once of a file that turns out longer than the system said.
BLOCK = 1 << 20
# Lists and objects of JSON, which take up to 200 bytes of memory each, and values after others in them, which
# take as much where every key is another: together less than 500 MB.
MOST_BRACKETS, MOST_COMMAS = 1_000_000, 2_000_000


def read_text(path: Path, limits: FileLimits, saved: str = "save it as UTF-8") -> str:
    """Return the text of a UTF-8 file, with or without a byte order mark.

    Parameters
    ----------
    limits : limits for this kind of file.
    saved : advice for a file in another encoding.

    Raises
    ------
    InputError
        Without the file's name: when it cannot be read, is too large, or is not text.
    """
    content = read_limited(path, limits)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(f"the file is not UTF-8 text (byte {error.start}, line {line}): {saved}.") from error


def refuse_large_file(path: Path, limits: FileLimits) -> None:
    """Raise InputError, without the file's name, when there is no such file or it has more bytes than ``limits`` allow.

    Raises OSError or ValueError where the system cannot tell.
    """
    if not path.exists():
        raise InputError("there is no file of that name.")
    if not path.is_file():
        raise InputError(f"this is not a file: give {limits.what}.")
    size, most = path.stat().st_size, limits.most_bytes
    if most is not None and size > most:
        raise InputError(
            f"the file has {size / 1e6:.0f} MB, more than the {most / 1e6:g} MB of {limits.what}: {limits.remedy}."
        )


def read_limited(path: Path, limits: FileLimits) -> bytes:
    """Return the content of a file.

    Parameters
    ----------
    limits : limits for this kind of file.

    Raises
    ------
    InputError
        Without the file's name: when it cannot be read, or is too large.
    """
    try:
        refuse_large_file(path, limits)
        most = limits.most_bytes
        content = read_at_most(path, most)
        if most is not None and len(content) > most:
            raise InputError(f"the file grows while it is read: give {limits.what} that is finished.")
        return content
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"the file cannot be read ({(getattr(error, 'strerror', None) or str(error)).lower()})."
        ) from error


def read_at_most(path: Path, most: int | None) -> bytes:
    """Return the content of a regular file; if it has more than ``most`` bytes, only its beginning, which is
    longer than ``most``.

    From the length the caller sees that the file is too large. None means no limit.
    """
    size = path.stat().st_size
    with path.open("rb") as stream:
        # As many bytes as are asked for are set aside before any is read.
        content = stream.read((size if most is None else min(size, most)) + 1)
        while (most is None or len(content) <= most) and (more := stream.read(BLOCK)):
            content += more
    return content


def parse_json(text: str, hook: Callable[[dict[str, Any]], Any] | None = None, times: float = 1.0) -> Any:
    """Return the content of JSON text.

    Parameters
    ----------
    hook : called for each object as soon as it is read; its result replaces the object.
    times : factor on the number of lists, objects and values that a file may hold.

    Raises
    ------
    InputError
        A sentence without the file's name, that gives line and column where the form is broken.
    """
    if len(text) > times * MOST_BRACKETS:
        for most, what in ((times * MOST_BRACKETS, "[{"), (times * MOST_COMMAS, ",")):
            if sum(map(text.count, what)) > most:
                raise InputError(
                    f"the file holds more than {most / 1e6:g} million "
                    f"{'values' if what == ',' else 'lists and objects'}: save less in it."
                )
    try:
        return make_json_decoder(hook).decode(text)
    except json.JSONDecodeError as error:
        raise InputError(
            f"the file is not valid JSON: {error.msg.lower()} at line {error.lineno}, column {error.colno}."
        ) from error
    except RecursionError as error:
        raise InputError("the file is nested too deeply.") from error


def parse_toml(text: str) -> dict[str, Any]:
    """Return the content of TOML text.

    Raises
    ------
    InputError
        A sentence without the file's name, that gives the line where the form is broken.
    """
    try:
        content = tomllib.loads(text)
        refuse_long_numbers(content)
        return content
    except RecursionError as error:
        raise InputError("the file is nested too deeply.") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        reason = " ".join(str(error).split()).rstrip(".") or "it is broken"
        raise InputError(f"the file is not valid TOML: {reason[:1].lower()}{reason[1:]}.") from error


def refuse_constant(name: str) -> NoReturn:
    """Raise InputError for a constant such as NaN or Infinity, which JSON does not have."""
    raise InputError(f"{name} is not a number: correct it.")


def parse_whole_number(digits: str) -> int:
    """Return a whole number from its digits; raise InputError for one too large for a float."""
    if len(digits) > MOST_DIGITS:
        raise InputError(f"the file holds a number with {len(digits)} digits: correct it.")
    return int(digits)


def make_dict_without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the pairs of a JSON object as a dict; raise InputError for a key that is given twice."""
    content = dict(pairs)
    if len(content) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for k, key in enumerate(keys) if key in keys[:k])
        raise InputError(f'the key "{twice[:60]}" is given twice in one place: leave one of them out.')
    return content


def refuse_long_numbers(value: Any) -> None:
    """Raise InputError for a whole number too large for a float, anywhere in nested dicts and lists."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            refuse_long_numbers(item)
    elif isinstance(value, int) and abs(value) >= 10**MOST_DIGITS:
        raise InputError(f"the file holds a number with more than {MOST_DIGITS} digits: correct it.")


@lru_cache(maxsize=16)
def make_json_decoder(hook: Callable[[dict[str, Any]], Any] | None) -> json.JSONDecoder:
    """Return a decoder that refuses constants, long numbers
    and repeated keys, and applies ``hook`` to objects.
    """
    return json.JSONDecoder(
        parse_constant=refuse_constant,
        parse_int=parse_whole_number,
        object_pairs_hook=make_dict_without_repeats
        if hook is None
        else lambda pairs: hook(make_dict_without_repeats(pairs)),
    )
