"""The command as a process: exit codes, signals, pipes, and how fast it starts."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

VISE = ("--pitch", "10,12.7", "--columns", "3", "--peg-radius", "3")
# How an earlier output of the same name begins.
OURS = '{"format": "workhold-result/1"}'
TESTS = Path(__file__).parents[1]

# Runs the command line with a search that says it has begun and then behaves as the test needs.
PROGRAM = """
import sys, time, types
sys.path.insert(0, {tests!r})
from fakes import fake_result

def answer(query, *, cancel, **options):
    print("searching", flush=True)
    {behaviour}

module = types.ModuleType("workhold.search.design")
module.answer = answer
sys.modules["workhold.search.design"] = module
from workhold.cli.main import run
run()
"""

OBEDIENT = "cancel.wait(30); return fake_result(3, complete=False)"
STUBBORN = "cancel.wait(30); time.sleep(30)"
FAULTY = "raise RuntimeError('secret of the inside')"


def start(behaviour: str, folder: Path, *arguments: object, **environment: str) -> subprocess.Popen[str]:
    """Start ``workhold design`` with a search of some behaviour."""
    program = PROGRAM.format(tests=str(TESTS), behaviour=behaviour)
    command = [sys.executable, "-c", program, "design", "widget", *VISE, *map(str, arguments)]
    return subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def wait_for_search(process: subprocess.Popen[str]) -> None:
    """Wait until the search has begun."""
    assert process.stdout is not None
    assert process.stdout.readline() == "searching\n"


def test_ctrl_c_keeps_what_was_found(tmp_path: Path) -> None:
    process = start(OBEDIENT, tmp_path, "--out", "r.json")
    wait_for_search(process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    data = json.loads((tmp_path / "r.json").read_text())
    assert data["complete"] is False
    assert len(data["fixtures"]) == 3
    assert "3 fixtures" in out
    assert "r.json is marked so" in err
    assert "Traceback" not in err


def test_a_second_ctrl_c_ends_at_once_and_leaves_no_file(tmp_path: Path) -> None:
    (tmp_path / "r.json").write_text(OURS)
    process = start(STUBBORN, tmp_path, "--out", "r.json")
    wait_for_search(process)
    process.send_signal(signal.SIGINT)
    assert process.stderr is not None
    while "stopping" not in process.stderr.readline():
        pass
    process.send_signal(signal.SIGINT)
    begun = time.monotonic()
    _, err = process.communicate(timeout=30)
    assert time.monotonic() - begun < 5
    assert process.returncode == 130
    assert "Traceback" not in err
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("r.json", OURS)]


def test_a_polite_kill_leaves_no_file(tmp_path: Path) -> None:
    process = start(OBEDIENT, tmp_path, "--out", "r.json")
    wait_for_search(process)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 143
    assert err == ""
    assert list(tmp_path.iterdir()) == []


def test_a_fault_is_owned_up_to_and_its_traceback_kept(tmp_path: Path) -> None:
    process = start(FAULTY, tmp_path, "--out", "r.json", TMPDIR=str(tmp_path))
    _, err = process.communicate(timeout=30)
    assert process.returncode == 1
    assert err.count("\n") == 1
    assert "a mistake of workhold, not of yours (RuntimeError: secret of the inside)" in err
    (kept,) = tmp_path.iterdir()
    assert str(kept) in err
    assert "Traceback" in kept.read_text()


def test_a_fault_shows_its_traceback_on_request(tmp_path: Path) -> None:
    process = start(FAULTY, tmp_path, TMPDIR=str(tmp_path), WORKHOLD_TRACEBACK="1")
    _, err = process.communicate(timeout=30)
    assert process.returncode == 1
    assert "Traceback (most recent call last)" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [("parts",), ("--help",), ("features", "widget")])
def test_nobody_reading_the_output_is_no_reason_to_complain(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "workhold", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == ""
    assert process.wait(30) in (1, 141)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_no_fault_of_ours() -> None:
    with Path("/dev/full").open("w") as full:
        outcome = subprocess.run(
            [sys.executable, "-m", "workhold", "parts"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert outcome.returncode == 2
    assert outcome.stderr == "workhold: error: the output cannot be written: No space left on device.\n"


def test_bad_input_as_a_process(process: Any, tmp_path: Path) -> None:
    outcome = process("design", "none.dxf", *VISE, "--out", "r.json")
    assert outcome.returncode == 2
    assert outcome.stderr.startswith("workhold: error: ")
    assert outcome.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_control_letters_in_a_name_do_not_reach_the_terminal(process: Any) -> None:
    outcome = process("show", "a\x1b[31m\nb.json", "1")
    assert outcome.returncode == 2
    assert "\x1b" not in outcome.stderr
    assert outcome.stderr.count("\n") == 1


# Modules that take longer to load than a small command takes; the first of each tuple stands for all it brings along.
NUMBERS = ("numpy", "numba")
OTHERS = ("ezdxf", "flint", "pydantic", "resvg_py", "rich", "scipy", "svgelements")


def loaded(program: str, folder: Path) -> list[str]:
    """The heavy modules that a program has loaded when it ends."""
    program = f"""
import atexit, sys
atexit.register(lambda: sys.stderr.write(" ".join(m for m in {NUMBERS + OTHERS} if m in sys.modules)))
{program}
"""
    outcome = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder, check=True)
    return outcome.stderr.split()


COMMAND = "from workhold.cli.main import run; sys.argv[1:] = {!r}; run()"


@pytest.mark.parametrize(
    "program",
    ["import workhold", "import workhold.cli.main", COMMAND.format(["--help"]), COMMAND.format(["design", "--help"])],
)
def test_neither_the_package_nor_the_help_needs_anything_heavy(program: str, tmp_path: Path) -> None:
    assert loaded(program, tmp_path) == []


def test_a_design_of_a_built_in_part_reads_and_writes_with_what_the_search_needs(tmp_path: Path) -> None:
    """No reader of drawings, no checker of foreign files and no typesetter is loaded, though a file is written."""
    program = PROGRAM.format(tests=str(TESTS), behaviour="return fake_result(3)")
    words = ["design", "widget", *VISE, "--out", "r.json"]
    # Where SciPy is installed, as it is for the tests, numba imports it by itself.
    assert set(loaded(f"sys.argv[1:] = {words!r}\n{program}", tmp_path)) - {"scipy"} == set(NUMBERS)
    assert (tmp_path / "r.json").exists()


def test_a_real_design_from_the_first_command_to_the_picture(process: Any, tmp_path: Path) -> None:
    outcome = process("design", "oblongPart", "--pitch", 10, "--columns", 1, "--peg-radius", 3, "--out", "r.json")
    assert outcome.returncode == 0, outcome.stderr
    data = json.loads((tmp_path / "r.json").read_text())
    assert len(data["fixtures"]) == sum(data["counts"].values()) > 0
    assert f"{len(data['fixtures'])} fixtures: " in outcome.stdout
    outcome = process("show", "r.json", 1, "--draw", "one.svg")
    assert outcome.returncode == 0, outcome.stderr
    assert (tmp_path / "one.svg").exists()
