"""A family of parts is planned without any program, and says so."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from slow_program import END_MILL, path, program_of
from workhold import InputError, Query, Vise, load
from workhold.cli.main import app
from workhold.family.family import MemberRequest, make_family


def test_a_part_with_a_program_is_refused() -> None:
    program = program_of(path(END_MILL, [(0.0, 0.0, 5.0)]))
    query = Query(load("widget"), Vise(10, 2, 3), program=program, peg_height=9.0)
    with pytest.raises(InputError, match="widget has a program to let pass"):
        make_family([MemberRequest("widget", query)])


def test_a_job_with_a_program_is_refused(tmp_path: Path) -> None:
    jobs = tmp_path / "jobs.toml"
    jobs.write_text('[[job]]\npart = "widget"\nprogram = "plate.nc"\n')
    refused = CliRunner().invoke(app, ["family", str(jobs), "--vise", "plate-20mm"])
    assert refused.exit_code == 2
    assert "job 1 names a program, but a family of parts is planned without" in refused.stderr
