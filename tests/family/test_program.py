"""A family of parts is planned without any program, and says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from attrs import fields

from slow_program import END_MILL, path, program_of
from workhold import InputError, Query, Vise, load
from workhold.cli.jobs import jobs_of
from workhold.cli.options import PartWords
from workhold.cli.search_options import QueryWords
from workhold.family.family import Asked, family_of


def test_a_part_with_a_program_is_refused() -> None:
    program = program_of(path(END_MILL, [(0.0, 0.0, 5.0)]))
    query = Query(load("widget"), Vise(10, 2, 3), program=program, peg_height=9.0)
    with pytest.raises(InputError, match="widget has a program to let pass"):
        family_of([Asked("widget", query)])


def test_a_job_with_a_program_is_refused(tmp_path: Path) -> None:
    jobs = tmp_path / "jobs.toml"
    jobs.write_text('[[job]]\npart = "widget"\nprogram = "plate.nc"\n')

    def untyped(kind: Any) -> Any:
        return kind(**dict.fromkeys(one.name for one in fields(kind)))

    with pytest.raises(InputError, match=r"job 1 names a program: a family of parts is planned without"):
        jobs_of([str(jobs)], untyped(QueryWords), untyped(PartWords))
