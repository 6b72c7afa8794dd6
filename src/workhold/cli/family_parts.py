"""The parts of a family as they are typed: files, folders and names, and files of jobs with rules for each part."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from attrs import evolve, frozen

from workhold.cli.options import PartWords
from workhold.cli.saying import tell
from workhold.cli.search_options import QueryWords, with_fit_of
from workhold.cli.values import length_unit
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.family.family import Asked, LeftOut
    from workhold.files.part_list import ListedPart
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.tolerance import Tolerance

__all__ = ["Job", "asked_of", "jobs_of"]


@frozen
class Job:
    """A part of the family before it is read: what it is called, and what is asked of it."""

    name: str
    listed: ListedPart
    words: QueryWords
    reading: PartWords


def jobs_of(parts: list[str], words: QueryWords, reading: PartWords) -> list[Job]:
    """The parts of the command line and of files of jobs, no two called alike.

    Raises
    ------
    InputError
        For parts that do not exist, and jobs that mean nothing or name a toolkit of their own.
    """
    from workhold.cli.job_file import JOB_ENDINGS, read_jobs
    from workhold.files.part_list import part_list

    plain = [name for name in parts if Path(name).suffix.lower() not in JOB_ENDINGS]
    found = [(one, words, reading) for one in part_list(plain)] if plain else []
    for name in parts:
        for job in [] if name in plain else read_jobs(Path(name)):
            if job.toolkits is not None:
                raise InputError(f"{job.place} names a toolkit: the parts of a family share that of the command line.")
            own_words, own_reading = evolve(words, **job.query), evolve(reading, **job.reading)
            try:
                own_words.asked(length_unit(own_reading.unit))
                found += [(one, own_words, own_reading) for one in part_list([job.part])]
            except InputError as error:
                raise InputError(f"{job.place}: {error}") from error
    called = [called_by(one.name, [other.name for other, _, _ in found]) for one, _, _ in found]
    times, jobs = Counter[str](), []
    for name, (one, own_words, own_reading) in zip(called, found, strict=True):
        times[name] += 1
        jobs.append(Job(name if times[name] == 1 else f"{name} ({times[name]})", one, own_words, own_reading))
    return jobs


def called_by(name: str, names: list[str]) -> str:
    """What a part is called: by its file alone, where no other of the names ends in the same.

    >>> called_by("a/x.dxf", ["a/x.dxf", "b/y.dxf"]), called_by("a/x.dxf", ["a/x.dxf", "b/x.dxf"])
    ('x.dxf', 'a/x.dxf')
    """
    short = Path(name).name
    return name if any(Path(other).name == short for other in names if other != name) else short


def asked_of(
    jobs: list[Job], toolkit: Toolkit, tolerance: Tolerance | None, types: str | None, zero: str | None
) -> tuple[list[Asked], list[LeftOut]]:
    """What is asked for each part that can be read, and the parts that cannot.

    Raises
    ------
    InputError
        For a zero that a part does not have, and a query that cannot be.
    """
    from hashlib import sha256

    from workhold.family.family import Asked, LeftOut
    from workhold.family.losses import RANKINGS
    from workhold.files.part_list import read_listed
    from workhold.model.part_zero import part_zero
    from workhold.model.query import Query

    usual = RANKINGS[toolkit.travels]
    members, left_out = [], []
    for job in jobs:
        read, path = read_listed(job.listed, **job.reading.options()), job.listed.path
        if read.loaded is None:
            left_out.append(LeftOut(job.name, str(path), read.refusal.rstrip(".")))
            continue
        for remark in read.loaded.remarks:
            tell(f"{job.name}: {remark}")
        unit = length_unit(job.reading.unit)
        asked = job.words.asked(unit)
        asked["tolerance"] = with_fit_of(asked["tolerance"], tolerance)
        asked["ranking"] = asked["ranking"] or usual
        workpiece = read.loaded.workpiece
        digest = sha256(Path(path).read_bytes()).hexdigest() if Path(path).is_file() else ""
        try:
            at = part_zero(workpiece, zero, unit)
        except InputError as error:
            raise InputError(f"{job.name}: {error}") from error
        members.append(Asked(job.name, Query(workpiece, toolkit, types, **asked), str(path), digest, at))
    return members, left_out
