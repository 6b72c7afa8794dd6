"""Runs of ``workhold batch`` over a catalogue in a scratch folder: timed, killed, resumed, and their records compared."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from time import perf_counter, sleep
from typing import Any

from attrs import frozen

from catalogue import catalogue
from report import child_environment

__all__ = ["Run", "killed_and_resumed", "make_records", "run_batch", "write_parts"]

TOOLKITS = ("gripper-one-column", "fence-20mm")
BEST = 3
# Shares of the records after which a worker is killed, and after which the run itself is.
WORKERS_KILLED, RUN_KILLED = (0.15, 0.4), 0.65
# Seconds between two looks at what is done, and after which a run that does nothing is given up.
LOOK, PATIENCE = 0.02, 900.0
KIB = 1024


@frozen
class Run:
    """What a run took.

    Parameters
    ----------
    seconds : by the clock.
    processor : of the run and all its workers.
    memory : largest resident size of one of its processes, in bytes.
    words : what it said.
    """

    seconds: float
    processor: float
    memory: int
    words: str


def write_parts(folder: Path, count: int) -> Path:
    """The first parts of the catalogue as files."""
    folder.mkdir()
    for part in catalogue(count):
        told = {"name": part.name, "units": "mm", "loops": [[list(v) for v in loop] for loop in part.loops]}
        (folder / f"{part.name}.json").write_text(json.dumps(told), encoding="utf-8")
    return folder


def started(parts: Path, out: Path, workers: int) -> subprocess.Popen[str]:
    """A run that has begun."""
    command = [sys.executable, "-m", "workhold", "batch", str(parts), "--toolkit", ",".join(TOOLKITS)]
    command += ["--best", str(BEST), "--workers", str(workers), "--out", str(out)]
    # What it says is short, so the pipe never fills.
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    return subprocess.Popen(command, env=child_environment(), **pipes)


def run_batch(parts: Path, out: Path, workers: int) -> Run:
    """A run to its end.

    Raises
    ------
    RuntimeError
        When it ends with an error.
    """
    start = perf_counter()
    process = started(parts, out, workers)
    assert process.stdout is not None
    with ended_with(process):
        words = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    if process.returncode:
        raise RuntimeError(f"workhold batch ended with {process.returncode}: {words.strip()[-300:]}")
    seconds = perf_counter() - start
    return Run(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * KIB, words)


@contextmanager
def ended_with(process: subprocess.Popen[str]) -> Iterator[None]:
    """Ends a run with its workers when the block ends by an error or a signal, so that nothing writes any more."""
    try:
        yield
    except BaseException:
        end(process)
        raise


def end(process: subprocess.Popen[str]) -> None:
    """Kill a run and wait until its workers, which end by themselves, are gone."""
    left = workers_of(process.pid)
    process.kill()
    for pid in left:
        wait_for_end(pid)
    process.wait()


def make_records(out: Path) -> dict[str, tuple[int, str]]:
    """Size and hash of every record, by its path."""
    found = {}
    for path in sorted(out.glob("work/*/*.json")):
        content = path.read_bytes()
        found[path.relative_to(out).as_posix()] = len(content), sha256(content).hexdigest()
    return found


def workers_of(pid: int) -> list[int]:
    """The worker processes of a run: its children that were spawned to compute."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            command = (entry / "cmdline").read_bytes()
        except (OSError, ValueError):
            continue
        if parent == pid and b"spawn_main" in command:
            found.append(int(entry.name))
    return found


def killed_and_resumed(parts: Path, out: Path, expected: int) -> dict[str, Any]:
    """A run of two workers whose workers are killed, then the run itself; and the same command again to its end.

    Parameters
    ----------
    expected : how many records there will be.
    """
    process = started(parts, out, 2)
    assert process.stdout is not None
    with ended_with(process):
        killed, before = kill_in_the_middle(process, out, expected)
    process.wait()
    process.stdout.close()
    again = run_batch(parts, out, 2)
    return {"workers_killed": killed, "records_when_killed": before, "resumed_seconds": again.seconds}


def kill_in_the_middle(process: subprocess.Popen[str], out: Path, expected: int) -> tuple[int, int]:
    """Kill workers and then the run as records come: how many workers, and the records there were in the end."""
    killed, begun = 0, perf_counter()
    thresholds = [share * expected for share in WORKERS_KILLED]
    while process.poll() is None and perf_counter() - begun < PATIENCE:
        done = sum(1 for _ in out.glob("work/*/*.json"))
        if thresholds and done >= thresholds[0]:
            for pid in workers_of(process.pid)[:1]:
                os.kill(pid, signal.SIGKILL)
                killed += 1
            thresholds.pop(0)
        if not thresholds and done >= RUN_KILLED * expected:
            end(process)
            break
        sleep(LOOK)
    return killed, sum(1 for _ in out.glob("work/*/*.json"))


def wait_for_end(pid: int, most: float = 30.0) -> None:
    """Wait until a process is gone, killing it when it does not end by itself."""
    begun = perf_counter()
    while Path(f"/proc/{pid}").exists():
        if perf_counter() - begun > most:
            os.kill(pid, signal.SIGKILL)
            return
        sleep(LOOK)
