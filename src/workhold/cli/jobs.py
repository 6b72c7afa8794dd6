"""Jobs from a file, in the words of the command line, and the parts of a family.

A TOML file has a table ``[[job]]`` for each job, a CSV file has a row for each::

unit = "mm" # entries here apply to every job toolkit = ["plate-20mm", "own.toml"]

    [[job]]
    part = "bracket.dxf"                 # or a folder, or a built-in name
    avoid = [3, 7]
    load = ["force=200 at=10,5 direction=30..60"]

The first line of a CSV file has the option names; several entries of a cell are separated by ``|``. Parts,
toolkits and files of loads are looked up beside the file first. A family takes files, folders and names, and
files of jobs with rules for each part.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from attrs import AttrsInstance, evolve, fields, fields_dict, frozen, resolve_types

from workhold.cli.commands import print_remark
from workhold.cli.options import CALLED, PartOptions
from workhold.cli.program_options import ProgramOptions
from workhold.cli.search_options import QueryOptions, SeatingOptions, add_dowel_fit
from workhold.cli.values import read_unit
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.family.family import ExcludedPart, MemberRequest
    from workhold.files.part_list import ListedPart
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.requirements import Tolerance
    from workhold.model.workpiece import Workpiece

__all__ = ["JOB_ENDINGS", "make_family_queries", "list_family_parts", "read_jobs"]

JOB_ENDINGS = (".csv", ".toml")
PART, TOOLKIT = "part", "toolkit"
GROUPS = PartOptions, QueryOptions, SeatingOptions, ProgramOptions
Words = TypeVar("Words", PartOptions, QueryOptions, SeatingOptions, ProgramOptions)
KEYS = (PART, TOOLKIT, *(name for group in GROUPS for name in fields_dict(group)))
KINDS = {one.name: one.type for group in GROUPS for one in fields(resolve_types(group))}
# How words that are true or false are written.
TRUTHS = {"true": True, "yes": True, "false": False, "no": False}
# Words of which there may be several.
LISTS = {TOOLKIT} | {name for name, kind in KINDS.items() if kind == list[str] | None}
FILES = (PART, TOOLKIT, "loads", "program", "tools")


@frozen
class JobOptions:
    """A job of a file.

    Parameters
    ----------
    place : the job's position in its file, for messages.
    part : file, folder or built-in name.
    toolkits : names and files; None where the file gives none.
    options : by option name, the file's values for reading the part, its fixtures, their seating and the
        program.
    """

    place: str
    part: str
    toolkits: list[str] | None
    options: Mapping[str, Any]

    def replace_options(self, typed: Words) -> Words:
        """Return a group of typed options, in which options given in the job's file replace the typed ones."""
        return evolve(typed, **self.make_options(type(typed)))

    def make_options(self, group: type[AttrsInstance]) -> dict[str, Any]:
        """Return by name the options of this group that the job's file gives."""
        return {name: self.options[name] for name in fields_dict(group) if name in self.options}


def read_jobs(path: Path) -> list[JobOptions]:
    """Return the jobs of a TOML or CSV file in order;
    raise InputError for a file without jobs or with unknown words.
    """
    from workhold.files.budget import LIMITS
    from workhold.files.tables import SAVED
    from workhold.files.text import read_text

    try:
        if path.suffix.lower() == ".toml":
            entries = list(read_toml_entries(read_text(path, LIMITS["jobs"])))
        else:
            entries = list(read_csv_entries(read_text(path, LIMITS["jobs"], SAVED)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    if not entries:
        raise InputError(
            f"{path} has no jobs: write a table [[job]], or a row below the names of columns, for each."
        )
    return [make_job(entry, f"{path}: job {number}", path.parent) for number, entry in enumerate(entries, 1)]


def read_toml_entries(text: str) -> Iterator[dict[str, Any]]:
    """Yield the entries of each job: the file's common entries, overridden by the job's own."""
    from workhold.files.budget import LIMITS, Budget
    from workhold.files.tables import MOST_COLUMNS
    from workhold.files.text import parse_toml

    content = parse_toml(text)
    jobs = content.pop("job", [])
    if not isinstance(jobs, list) or not all(isinstance(job, dict) for job in jobs):
        raise InputError("its jobs are not tables: write [[job]] above each.")
    if len(content) > MOST_COLUMNS:
        # Each job has a copy of them.
        raise InputError(
            f"more than {MOST_COLUMNS:,} entries stand above its jobs: leave out those that are not needed."
        )
    budget = Budget(LIMITS["jobs"], len(text))
    for job in jobs:
        budget.spend()
        yield content | job


def read_csv_entries(text: str) -> Iterator[dict[str, Any]]:
    """Yield for each row its cells by column name; empty cells are left out, cells of list columns are split
    at "|".
    """
    from workhold.files.budget import LIMITS, Budget
    from workhold.files.tables import NOT_GIVEN, read_table

    for row in read_table(text, Budget(LIMITS["jobs"], len(text))).iterate_rows():
        cells = {key: cell for key, cell in row.cells.items() if key == PART or cell.lower() not in NOT_GIVEN}
        yield {key: cell.split("|") if normalize_word(key) in LISTS else cell for key, cell in cells.items()}


def normalize_word(key: str) -> str:
    """Return a word in small letters with underscores for hyphens: "jaw_force" for "Jaw-force"."""
    return key.strip().lower().replace("-", "_").replace(" ", "_").replace("toolkits", TOOLKIT)


def make_job(entry: Mapping[str, Any], place: str, folder: Path) -> JobOptions:
    """Return a job made of a file's entries;
    ``place`` names it in messages, and files are sought in ``folder`` first.
    """
    words: dict[str, Any] = {}
    for key, value in entry.items():
        name = normalize_word(key)
        if name not in KEYS:
            raise InputError(
                f"{place} has an unknown word {key[:40]!r}: give {', '.join(KEYS[:-1])} or {KEYS[-1]}."
            )
        if KINDS.get(name) is bool:
            words[name] = read_flag(value, f"{place}: {key}")
            continue
        values = [
            format_as_typed(item, f"{place}: {key}")
            for item in (value if isinstance(value, list) else [value])
        ]
        if name in FILES:
            values = [find_beside_jobs_file(folder, item) for item in values]
        words[name] = values if name in LISTS else ",".join(values)
    if PART not in words:
        raise InputError(f"{place} has no part: name a file, a folder or a built-in part.")
    return JobOptions(place, words.pop(PART), words.pop(TOOLKIT, None), words)


def read_flag(value: Any, place: str) -> bool:
    """Return True or False from a boolean or from one of the words in :data:`TRUTHS`;
    raise InputError for anything else.
    """
    flag = value if isinstance(value, bool) else TRUTHS.get(str(value).lower())
    if flag is None:
        raise InputError(f"{place} is neither true nor false: write one of {', '.join(TRUTHS)}.")
    return flag


def format_as_typed(value: Any, place: str) -> str:
    """Return text or a number as it would be typed on the command line;
    raise InputError for anything else.
    """
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{place} is neither text nor a number: write it as on the command line, in quotes.")
    return value if isinstance(value, str) else f"{value!r}" if isinstance(value, float) else str(value)


def find_beside_jobs_file(folder: Path, name: str) -> str:
    """Return the path of ``name`` in the folder if there is such a file, else ``name`` unchanged."""
    try:
        return str(folder / name) if name and (folder / name).exists() else name
    except (OSError, ValueError):
        return name


@frozen
class FamilyPart:
    """A part of the family before it is read: its name, and the words about it."""

    name: str
    listed: ListedPart
    words: QueryOptions
    reading: PartOptions
    machined: ProgramOptions


def list_family_parts(
    parts: list[str], words: QueryOptions, reading: PartOptions, machined: ProgramOptions, toolkit: Toolkit
) -> list[FamilyPart]:
    """Return the parts of the command line and of files of jobs, each with its options and a name of its own.

    A name that occurs again gets a number. Raises InputError for a job that names a toolkit, and beside pegs for a
    program or a thickness.
    """
    from workhold.files.part_list import list_parts

    # What flat jaws hold stays where it is; a pattern of pegs may move, and a program was not looked at there.
    with_programs = toolkit.flat_jaws is not None
    if machined.thickness is not None and not with_programs:
        raise InputError(
            f"--thickness counts in a plain vise, and a family in a {toolkit.noun} is planned without: leave it out."
        )
    plain = [name for name in parts if Path(name).suffix.lower() not in JOB_ENDINGS]
    found = [(one, words, reading, machined) for one in list_parts(plain)] if plain else []
    for name in parts:
        for job in [] if name in plain else read_jobs(Path(name)):
            if job.toolkits is not None:
                raise InputError(
                    f"{job.place} names a toolkit, but all parts of a family use the toolkit of the command "
                    "line: leave it out."
                )
            if job.make_options(ProgramOptions) and not with_programs:
                raise InputError(
                    f"{job.place} names a program, but a family of parts is planned without one: leave it out."
                )
            own_words, own_reading = job.replace_options(words), job.replace_options(reading)
            own_program = job.replace_options(machined)
            try:
                own_words.read_arguments(read_unit(own_reading.unit))
                found += [(one, own_words, own_reading, own_program) for one in list_parts([job.part])]
            except InputError as error:
                raise InputError(f"{job.place}: {error}") from error
    called = [shorten_part_name(one.name, [other.name for other, *_ in found]) for one, *_ in found]
    times, jobs = Counter[str](), []
    for name, (one, own_words, own_reading, own_program) in zip(called, found, strict=True):
        times[name] += 1
        numbered = name if times[name] == 1 else f"{name} ({times[name]})"
        jobs.append(FamilyPart(numbered, one, own_words, own_reading, own_program))
    return jobs


def shorten_part_name(name: str, names: list[str]) -> str:
    """Return the file name of a path, or the whole path if another of ``names`` has the same file name.

    >>> shorten_part_name("a/x.dxf", ["a/x.dxf", "b/y.dxf"]), shorten_part_name("a/x.dxf", ["a/x.dxf", "b/x.dxf"])
    ('x.dxf', 'a/x.dxf')
    """
    short = Path(name).name
    return name if any(Path(other).name == short for other in names if other != name) else short


def make_family_queries(
    jobs: list[FamilyPart],
    toolkit: Toolkit,
    tolerance: Tolerance | None,
    types: str | None,
    zero: str | None,
    *,
    both_sides: bool = False,
) -> tuple[list[MemberRequest], list[ExcludedPart]]:
    """Return a query for each part that can be read, and the other parts with the reasons.

    ``both_sides`` adds a query of each part turned over, for which the file of a solid is read again. Remarks
    are printed. Raises InputError for a part zero that a part does not have, for faces whose numbers are not
    certain, and for what cannot be asked of a part.
    """
    from hashlib import sha256

    from workhold.family.family import ExcludedPart, MemberRequest
    from workhold.family.members import OTHER_SIDE, RANKINGS
    from workhold.files.part.load import refuse_unsure_numbers
    from workhold.files.part_list import read_listed
    from workhold.model.query import Query
    from workhold.model.setup import choose_part_zero
    from workhold.model.solid import flip_up_axis

    usual, in_vise = RANKINGS[toolkit.travel_count], toolkit.flat_jaws is not None
    members, left_out = [], []
    for job in jobs:
        reading = (
            job.machined.adapt_part_options(job.listed.path.name, job.reading) if in_vise else job.reading
        )
        options = {
            **reading.to_read_arguments(),
            "heights": toolkit.heights,
            "peg_diameter": toolkit.peg_diameter,
        }
        read, path = read_listed(job.listed, **options), job.listed.path
        if read.loaded is None:
            left_out.append(ExcludedPart(job.name, str(path), read.refusal.rstrip(".")))
            continue
        for remark in read.loaded.remarks:
            print_remark(f"{job.name}: {remark}")
        workpiece = read.loaded.workpiece
        digest = sha256(Path(path).read_bytes()).hexdigest() if Path(path).is_file() else ""
        try:
            asked = make_member_arguments(job, workpiece, toolkit, tolerance)
            asked["rank_by"] = asked["rank_by"] or (None if toolkit.holds_by_friction else usual)
            refuse_unsure_numbers(read.loaded, asked["restrictions"].avoid, CALLED)
            # Where a program has X0 Y0, there the work offset of its part is set.
            named = zero if job.machined.program is None else job.machined.zero
            at = choose_part_zero(workpiece, named, read_unit(job.reading.unit))
            query = Query(workpiece, toolkit, types, **asked)
            if both_sides and (query.program is not None or query.raw is not None):
                raise InputError(
                    "its other side has a program of its own, and no raw block: name it in a file of jobs, once for each "
                    "side."
                )
        except InputError as error:
            raise InputError(f"{job.name}: {error}") from error
        one = MemberRequest(job.name, query, str(path), digest, at)
        members.append(one)
        if not both_sides:
            continue
        if workpiece.solid is None:
            members.append(one.turn_over(None))
            continue
        read = read_listed(job.listed, **{**options, "axis": flip_up_axis(workpiece.solid.axis)})
        if read.loaded is None:
            left_out.append(ExcludedPart(f"{job.name}, {OTHER_SIDE}", str(path), read.refusal.rstrip(".")))
        else:
            members.append(one.turn_over(read.loaded.workpiece))
    return members, left_out


def make_member_arguments(
    job: FamilyPart, workpiece: Workpiece, toolkit: Toolkit, tolerance: Tolerance | None
) -> dict[str, Any]:
    """Return the keyword arguments of the query of a member, without part, toolkit and types.

    In a plain vise thickness and program are among them. Raises InputError where the thickness is not known there.
    """
    unit, machined = read_unit(job.reading.unit), job.machined
    in_vise = toolkit.flat_jaws is not None
    has_program = in_vise and machined.program is not None
    asked = job.words.read_arguments(unit, has_program, has_program and machined.has_forces)
    asked["tolerance"] = add_dowel_fit(asked["tolerance"], tolerance)
    if not in_vise:
        return asked
    heights = machined.read_query_arguments(unit, job.reading.peg_height, workpiece)
    if workpiece.solid is None and heights.get("thickness") is None:
        raise InputError(
            "how thick it is decides which parallels it stands on: give --thickness, or thickness in a file of jobs."
        )
    return asked | heights
