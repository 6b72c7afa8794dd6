"""Jobs from a file: a TOML table ``[[job]]`` or a CSV row for each, in the words of the command line.

    unit = "mm"                          # what stands here counts for every job
    toolkit = ["plate-20mm", "own.toml"]

    [[job]]
    part = "bracket.dxf"                 # or a folder, or a built-in name
    avoid = [3, 7]
    load = ["force=200 at=10,5 direction=30..60"]

A CSV file has these words in its first line; several entries of a cell stand apart by ``|``. Parts, toolkits and files of
loads are sought beside the file first.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from io import StringIO
from pathlib import Path
from typing import Any

from attrs import fields_dict, frozen

from workhold.cli.options import PartWords
from workhold.cli.search_options import QueryWords
from workhold.cli.seating_options import SeatingWords
from workhold.errors import InputError

__all__ = ["JOB_ENDINGS", "JobWords", "read_jobs"]

JOB_ENDINGS = (".csv", ".toml")
# Bytes; a job takes a hundred.
LARGEST_FILE = 100_000_000
PART, TOOLKIT = "part", "toolkit"
OF_PART, OF_QUERY, OF_SEATING = (tuple(fields_dict(words)) for words in (PartWords, QueryWords, SeatingWords))
KEYS = (PART, TOOLKIT, *OF_PART, *OF_QUERY, *OF_SEATING)
# Words that are true or false.
FLAGS = {"foolproof": {"true": True, "yes": True, "false": False, "no": False}}
# Words of which there may be several.
LISTS = (TOOLKIT, "layer", "avoid", "keep_out", "angle", "load")
FILES = (PART, TOOLKIT, "loads")


@frozen
class JobWords:
    """A job of a file.

    Parameters
    ----------
    place : where it stands, for messages.
    part : file, folder or built-in name.
    toolkits : names and files; None where the file gives none.
    reading, query, seating : what the file says of reading the part, of its fixtures and of their seating, by the names of
        options.
    """

    place: str
    part: str
    toolkits: tuple[str, ...] | None
    reading: Mapping[str, Any]
    query: Mapping[str, Any]
    seating: Mapping[str, Any]


def read_jobs(path: Path) -> list[JobWords]:
    """The jobs of a file.

    Raises
    ------
    InputError
        When it cannot be read, holds no jobs, or a word that is not known.
    """
    from workhold.files.text import read_text

    try:
        text = read_text(path, LARGEST_FILE, "jobs")
        entries = list(toml_entries(text) if path.suffix.lower() == ".toml" else csv_entries(text))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    if not entries:
        raise InputError(f"{path} has no jobs: write a table [[job]], or a row below the names of columns, for each.")
    return [job_of(entry, f"{path}: job {number}", path.parent) for number, entry in enumerate(entries, 1)]


def toml_entries(text: str) -> Iterator[dict[str, Any]]:
    """The entries of each job of a TOML file.

    Raises
    ------
    InputError
        When it is none, or its jobs are no tables.
    """
    from workhold.files.text import toml_table

    content = toml_table(text)
    jobs = content.pop("job", [])
    if not isinstance(jobs, list) or not all(isinstance(job, dict) for job in jobs):
        raise InputError("its jobs are no tables: write [[job]] above each.")
    for job in jobs:
        yield content | job


def csv_entries(text: str) -> Iterator[dict[str, Any]]:
    """The cells of each row of a CSV file, without the empty ones.

    Raises
    ------
    InputError
        For a row with more cells than there are columns.
    """
    first = text.partition("\n")[0]
    delimiter = ";" if first.count(";") > first.count(",") else ","
    for number, row in enumerate(csv.DictReader(StringIO(text), delimiter=delimiter), 1):
        if None in row:
            raise InputError(f"row {number} has more cells than there are columns: put cells with commas in quotes.")
        entry = {key.strip().lower(): cell.strip() for key, cell in row.items() if cell and cell.strip()}
        if entry:
            yield {key: cell.split("|") if named(key) in LISTS else cell for key, cell in entry.items()}


def named(key: str) -> str:
    """The name of a word, however it is written: ``jaw-force`` is ``jaw_force``."""
    return key.strip().lower().replace("-", "_").replace(" ", "_").replace("toolkits", TOOLKIT)


def job_of(entry: Mapping[str, Any], place: str, folder: Path) -> JobWords:
    """A job from its entries.

    Raises
    ------
    InputError
        For a word that is not known, and a value that is none.
    """
    words: dict[str, Any] = {}
    for key, value in entry.items():
        name = named(key)
        if name not in KEYS:
            raise InputError(f"{place} has an unknown word {key[:40]!r}: give {', '.join(KEYS[:-1])} or {KEYS[-1]}.")
        if name in FLAGS:
            words[name] = flag_of(value, FLAGS[name], f"{place}: {key}")
            continue
        values = [text_of(item, f"{place}: {key}") for item in (value if isinstance(value, list) else [value])]
        if name in FILES:
            values = [beside(folder, item) for item in values]
        words[name] = values if name in LISTS else ",".join(values)
    if PART not in words:
        raise InputError(f"{place} has no part: name a file, a folder or a built-in part.")
    told = ({name: words[name] for name in of if name in words} for of in (OF_PART, OF_QUERY, OF_SEATING))
    toolkits = tuple(words[TOOLKIT]) if TOOLKIT in words else None
    return JobWords(place, words[PART], toolkits, *told)


def flag_of(value: Any, known: Mapping[str, bool], place: str) -> bool:
    """A value that is true or false, or one of the words for that.

    Raises
    ------
    InputError
        For anything else.
    """
    flag = value if isinstance(value, bool) else known.get(str(value).lower())
    if flag is None:
        raise InputError(f"{place} is neither true nor false: write one of {', '.join(known)}.")
    return flag


def text_of(value: Any, place: str) -> str:
    """A value as it would be typed.

    Raises
    ------
    InputError
        For what nobody can type.
    """
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{place} is neither text nor a number: write it as on the command line, in quotes.")
    return value if isinstance(value, str) else f"{value!r}" if isinstance(value, float) else str(value)


def beside(folder: Path, name: str) -> str:
    """A file beside the file of jobs, if there is one of a name; else the name."""
    try:
        return str(folder / name) if name and (folder / name).exists() else name
    except (OSError, ValueError):
        return name
