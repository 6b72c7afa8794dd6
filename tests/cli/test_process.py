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

pytestmark = pytest.mark.thorough

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

# What would have to be compiled is not part of what is tested.
import workhold.kernels.base.libraries as libraries
libraries.is_built = lambda rooms=(): True
module = types.ModuleType("workhold.search.design")
module.answer = answer
sys.modules["workhold.search.design"] = module
from workhold.cli.main import run
run()
"""

# Something is found, so that the end waits for it; who is told once more does not go on.
OBEDIENT = "options['progress'](0.1, 3); print('found', flush=True); cancel.wait(600); return fake_result(3, complete=False)"
STUBBORN = "options['progress'](0.1, 3); print('found', flush=True); cancel.wait(600); time.sleep(600)"
# Deaf in compiled code, with a thread that the interpreter waits for, a file half written, and nothing found.
DEAF = """
    import threading
    from pathlib import Path
    from workhold.files.atomic import write_text_file
    threading.Thread(target=time.sleep, args=(60,)).start()
    with write_text_file(Path("half.txt")) as stream:
        stream.write("half")
        stream.flush()
        print("deaf", flush=True)
        while True:
            try:
                time.sleep(60)
            except BaseException:
                pass
"""
# Where the signal comes in what compiled code calls back, from where nothing can be raised.
CALLED_BACK = """
    import ctypes
    def wait():
        print("deaf", flush=True)
        time.sleep(60)
    while True:
        ctypes.CFUNCTYPE(None)(wait)()
"""
# Done, with what takes Python a second to clear up.
SLOW_TO_CLEAR_UP = """
    import os
    class Slow:
        def __del__(self, write=os.write, sleep=time.sleep):
            write(1, b"clearing up\\n")
            sleep(1)
    sys.modules["slow"] = types.ModuleType("slow")
    sys.modules["slow"].slow = Slow()
    {then}
"""
FAULTY = "raise RuntimeError('secret of the inside')"
# Seconds to wait for what comes at once on a machine that has nothing else to do.
PATIENCE = 120


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


def wait_for_search(process: subprocess.Popen[str], *said: str) -> None:
    """Wait until the search has begun, and has said some words more."""
    assert process.stdout is not None
    for word in ("searching", *said):
        assert process.stdout.readline() == f"{word}\n"


def test_ctrl_c_keeps_what_was_found(tmp_path: Path) -> None:
    process = start(OBEDIENT, tmp_path, "--out", "r.json")
    wait_for_search(process, "found")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130
    data = json.loads((tmp_path / "r.json").read_text())
    assert data["complete"] is False
    assert len(data["fixtures"]) == 3
    assert "3 fixtures" in out
    assert (
        "stopping; the fixtures found so far are kept, if their proof takes little time (Ctrl-C again ends at once).\n"
        in err
    )
    assert "r.json is marked so" in err
    assert "Traceback" not in err


def test_a_second_ctrl_c_ends_at_once_and_leaves_no_file(tmp_path: Path) -> None:
    (tmp_path / "r.json").write_text(OURS)
    process = start(STUBBORN, tmp_path, "--out", "r.json")
    wait_for_search(process, "found")
    process.send_signal(signal.SIGINT)
    assert process.stderr is not None
    while "stopping" not in process.stderr.readline():
        assert process.poll() is None
    # Two signals that are seen at the same moment are one: some programs tell a process, and its group as well.
    end = time.monotonic() + PATIENCE
    while process.poll() is None and time.monotonic() < end:
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=1)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("r.json", OURS)]


@pytest.mark.parametrize("behaviour", [DEAF, CALLED_BACK], ids=["deaf", "called back"])
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_what_is_deaf_is_ended_without_unfinished_files(
    tmp_path: Path, number: signal.Signals, code: int, behaviour: str
) -> None:
    """One signal is enough, though the main thread passes over it and another thread is waited for."""
    process = start(behaviour, tmp_path, "--out", "r.json")
    wait_for_search(process, "deaf")
    process.send_signal(number)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == code
    assert "Traceback" not in err and ("interrupted; no unfinished file" in err) == (code == 130)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("interrupted", [False, True])
def test_after_a_search_only_what_was_interrupted_is_waited_for(interrupted: bool) -> None:
    """What was found is written in any time; without an interruption Ctrl-C has nothing to keep."""
    program = f"""
import signal, time
from workhold.cli import ending
from workhold.cli.ending import set_event_on_interrupt, end_on_signals, note_results_to_keep
if {interrupted}:
    # What the watcher does when its patience is over is done below.
    ending.GRACE = 600
end_on_signals()
with set_event_on_interrupt("what was found is kept") as event:
    if {interrupted}:
        print("ready", flush=True)
        event.wait(60)
    else:
        note_results_to_keep()
        assert not event.is_set()
if {interrupted}:
    ending.ending.end_unless_storing(signal.SIGINT)
    print("written", flush=True)
else:
    ready = False
    while True:
        try:
            if not ready:
                ready = True
                print("ready", flush=True)
            time.sleep(60)
        except BaseException:
            pass
"""
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out) == ((0, "written\n") if interrupted else (130, ""))


def test_a_signal_while_python_clears_up_does_not_change_the_code(tmp_path: Path) -> None:
    process = start(SLOW_TO_CLEAR_UP.format(then="return fake_result(3)"), tmp_path)
    wait_for_search(process)
    assert process.stdout is not None
    while process.stdout.readline() != "clearing up\n":
        assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")


def test_a_program_that_is_told_to_end_does_not_clear_up(tmp_path: Path) -> None:
    process = start(SLOW_TO_CLEAR_UP.format(then="cancel.wait(30)"), tmp_path)
    wait_for_search(process)
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=PATIENCE) == ("", "")
    assert process.returncode == 143


def test_a_polite_kill_leaves_no_file(tmp_path: Path) -> None:
    process = start(OBEDIENT, tmp_path, "--out", "r.json")
    wait_for_search(process, "found")
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 143
    assert err == ""
    assert list(tmp_path.iterdir()) == []


def test_a_fault_is_owned_up_to_and_its_traceback_kept(tmp_path: Path) -> None:
    process = start(FAULTY, tmp_path, "--out", "r.json", TMPDIR=str(tmp_path))
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert err.count("\n") == 1
    assert "workhold has a mistake, which is not yours (RuntimeError: secret of the inside)" in err
    (kept,) = tmp_path.iterdir()
    assert str(kept) in err
    assert "Traceback" in kept.read_text()


def test_a_fault_shows_its_traceback_on_request(tmp_path: Path) -> None:
    process = start(FAULTY, tmp_path, TMPDIR=str(tmp_path), WORKHOLD_TRACEBACK="1")
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert "Traceback (most recent call last)" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [("parts",), ("--help",), ("features", "widget")])
def test_nobody_reading_the_output_is_no_reason_to_complain(
    tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "workhold", *arguments],
        stdout=writer,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_no_fault_of_ours() -> None:
    with Path("/dev/full").open("w") as full:
        outcome = subprocess.run(
            [sys.executable, "-m", "workhold", "parts"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert outcome.returncode == 2
    assert outcome.stderr == "workhold: error: the output cannot be written: No space left on device.\n"


@pytest.mark.parametrize(("part", "code"), [("widget", 0), ("none.dxf", 2)])
@pytest.mark.parametrize("redirection", [">&-", "2>&-", "<&- >&- 2>&-", "2>/dev/full"])
def test_streams_that_are_closed_or_full_change_no_exit_code(part: str, code: int, redirection: str) -> None:
    """What is said is lost, and neither becomes a fault nor goes to a file that is opened next."""
    command = f'"{sys.executable}" -m workhold features {part} {redirection}'
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert "Traceback" not in done.stderr and "fault" not in done.stderr


def test_an_output_is_whole_where_no_stream_is_open(tmp_path: Path) -> None:
    """It would be the next file that is opened, and take the place of a closed stream."""
    words = "design widget --pitch 8 --columns 1 --peg-radius 3 --best 3 --out r.json"
    command = f'"{sys.executable}" -m workhold {words} <&- >&- 2>&-'
    assert subprocess.run(["bash", "-c", command], cwd=tmp_path, check=False).returncode == 0
    assert json.loads((tmp_path / "r.json").read_text())["complete"] is True


def test_a_limit_of_the_size_of_files_is_no_fault_of_ours(tmp_path: Path) -> None:
    """Of an output that the shell opened, and of one of our own."""
    resource = pytest.importorskip("resource")
    for words in (["features", "--help"], ["features", "widget", "--peg-radius", "3", "--draw", "f.svg"]):
        with (tmp_path / "out.txt").open("w") as out:
            done = subprocess.run(
                [sys.executable, "-m", "workhold", *words],
                cwd=tmp_path,
                stdout=out,
                stderr=subprocess.PIPE,
                text=True,
                check=False,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)),
            )
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert done.stderr.endswith(" cannot be written: File too large.\n")
        assert [path.name for path in tmp_path.iterdir()] == ["out.txt"]


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
    outcome = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=folder, check=True
    )
    return outcome.stderr.split()


COMMAND = "from workhold.cli.main import run; sys.argv[1:] = {!r}; run()"


@pytest.mark.parametrize(
    "program",
    [
        "import workhold",
        "import workhold.cli.main",
        COMMAND.format(["--help"]),
        COMMAND.format(["design", "--help"]),
    ],
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
    outcome = process(
        "design", "oblongPart", "--pitch", 10, "--columns", 1, "--peg-radius", 3, "--out", "r.json"
    )
    assert outcome.returncode == 0, outcome.stderr
    data = json.loads((tmp_path / "r.json").read_text())
    assert len(data["fixtures"]) == sum(data["counts"].values()) > 0
    assert f"{len(data['fixtures'])} fixtures: " in outcome.stdout
    outcome = process("show", "r.json", 1, "--draw", "one.svg")
    assert outcome.returncode == 0, outcome.stderr
    assert (tmp_path / "one.svg").exists()
