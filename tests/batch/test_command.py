"""``workhold batch`` as a shop runs it: on several processes, killed in the middle, started again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from time import sleep

import pytest
from batch_helpers import records_in
from test_run import square
from typer.testing import CliRunner

from workhold.cli.main import app

TOOLS = ("--pitch", "12,16", "--columns", "1", "--peg-radius", "3", "--toolkit", "vise")
ENDING = "parquet" if find_spec("pyarrow") else "csv"
NAMES = {f"results.{ENDING}", f"best.{ENDING}", "report.html", "measured.csv", "work"}


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dozen parts, one of which cannot be read."""
    folder = tmp_path_factory.mktemp("shop")
    for side in range(30, 41):
        square(folder / f"p{side}.json", side)
    (folder / "broken.dxf").write_text("0\nSECTION\n")
    return folder


def run(*words: object) -> tuple[int, str, str]:
    outcome = CliRunner().invoke(app, ["batch", *map(str, words)])
    return outcome.exit_code, outcome.stdout, outcome.stderr


@pytest.fixture(scope="module")
def alone(shop: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What one worker makes of the dozen."""
    folder = tmp_path_factory.mktemp("alone") / "out"
    code, told, warned = run(shop, *TOOLS, "--out", folder, "--workers", 1)
    assert code == 0, warned
    assert told.startswith("24 jobs: 22 held, 2 not readable.\n12 parts, 22 answers found in ")
    assert "broken.dxf: the DXF file is cut short" in warned and warned.count("broken.dxf") == 1
    assert {path.name for path in folder.iterdir()} == NAMES
    return folder


def started(*words: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "workhold", "batch", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for_records(process: subprocess.Popen[str], folder: Path) -> None:
    """Wait until there are more records than now, or the process has ended."""
    before = len(records_in(folder))
    while process.poll() is None and len(records_in(folder)) == before:
        sleep(0.01)


@pytest.mark.parametrize(
    "signals",
    [
        ((signal.SIGKILL, -9), (signal.SIGINT, 130)),
        pytest.param(((signal.SIGTERM, 143), (signal.SIGINT, 130)) * 3, marks=pytest.mark.prove),
    ],
)
def test_two_workers_killed_in_the_middle_make_what_one_makes(
    shop: Path, alone: Path, tmp_path: Path, signals: tuple[tuple[signal.Signals, int], ...]
) -> None:
    for number, code in signals:
        with started(shop, *TOOLS, "--out", tmp_path / "out", "--workers", 2) as process:
            wait_for_records(process, tmp_path / "out")
            os.kill(process.pid, number)
            _, error = process.communicate(timeout=300)
        # It may have ended before.
        assert process.returncode in (code, 0), error
        assert "Traceback" not in error and "fault" not in error
        assert records_in(tmp_path / "out").items() <= records_in(alone).items()
    code, told, _ = run(shop, *TOOLS, "--out", tmp_path / "out", "--workers", 2)
    assert code == 0 and told.startswith("24 jobs: 22 held, 2 not readable.")
    assert records_in(tmp_path / "out") == records_in(alone)


def test_the_same_command_again_does_nothing_anew(shop: Path, alone: Path) -> None:
    code, told, _ = run(shop, *TOOLS, "--out", alone)
    assert code == 0
    assert "12 parts, 0 answers found in " in told and "; 22 were known already." in told


def test_jobs_of_a_file_have_their_own_words(shop: Path, tmp_path: Path) -> None:
    jobs = tmp_path / "jobs.toml"
    jobs.write_text(
        f'toolkits = ["plate-20mm"]\n[[job]]\npart = "{shop}/p30.json"\navoid = [0, 1, 2, 3, 4]\n'
        f'[[job]]\npart = "{shop}/p31.json"\navoid = [77]\n[[job]]\npart = "{shop}/p32.json"\n'
    )
    code, told, warned = run(jobs, "--out", tmp_path / "out", "--workers", 1)
    assert code == 0
    assert told.startswith("3 jobs: 1 held, 2 that cannot be asked.")
    assert "p31.json: " in warned and "77" in warned


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("widget",), "no toolkit is given: name one or more with --toolkit"),
        (("widget", "--toolkit", "plate-20mm", "--out", ""), "the folder for the results is not given"),
        (("nowhere", "--toolkit", "plate-20mm"), "file not found"),
        (("widget", "--toolkit", "vise"), "vise is a kind of toolkit: give --pitch and --peg-radius too"),
        (("widget", "--toolkit", "vise,plate"), "vise and plate are two kinds of toolkit"),
        (("widget", "--toolkit", "plate-21mm"), "no toolkit has that name"),
        (("widget", "--toolkit", "plate-20mm", "--workers", "0"), "--workers"),
        (("widget", "--toolkit", "plate-20mm", "--best", "no"), "--best 'no' is not a whole number"),
        (("jobs.csv",), "jobs.csv: there is no file of that name"),
    ],
)
def test_slips_are_told_before_any_work(tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    import re

    out = tmp_path / "out"
    code, _, warned = run(*words, *(() if "--out" in words else ("--out", out)))
    assert code == 2 and re.search(message, warned), warned
    assert not out.exists()


def test_what_lies_in_the_folder_of_results_is_no_part(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    square(tmp_path / "a.json", 30)
    square(tmp_path / "out" / "b.json", 31)
    code, told, warned = run(tmp_path, "--toolkit", "plate-20mm", "--out", tmp_path / "out", "--workers", 1)
    assert code == 0 and told.startswith("1 job: "), warned


def test_foreign_files_are_not_written_over(shop: Path, tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text("mine")
    code, _, warned = run(shop, *TOOLS, "--out", tmp_path)
    assert code == 2 and "was not written by workhold" in warned
    assert (tmp_path / "report.html").read_text() == "mine"
