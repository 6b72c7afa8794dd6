"""Worker processes: each outcome once, and the death of a worker loses nothing."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from threading import Event
from time import monotonic, sleep

import pytest
from batch_helpers import Fatal, Hanging, Onlooker, ends_at_once

from workhold.batch import workers as module
from workhold.batch.store import parse_record
from workhold.batch.workers import LocalWorkers
from workhold.errors import InputError


def tasks(folder: Path, *times: int) -> list[Fatal]:
    return [Fatal(f"task{number}", f"title {number}", folder, often) for number, often in enumerate(times)]


def test_a_task_whose_worker_dies_is_tried_again_and_named_when_it_dies_twice(tmp_path: Path) -> None:
    onlooker, given = Onlooker(), tasks(tmp_path, 0, 1, 0, 9, 0)
    with LocalWorkers(2, onlooker) as queue:
        outcomes = {outcome.name: outcome for outcome in queue.run(iter(given), Event())}
        processes = [one.process for one in queue.workers]
    assert set(outcomes) == {task.name for task in given}
    for name in ("task0", "task1", "task2", "task4"):
        record = outcomes[name].record
        assert record is not None and parse_record(record)["refusal"] == f"{name} was done."
    assert outcomes["task3"].record is None
    assert outcomes["task3"].failure.startswith(
        "Two workers ended, the last one by signal 9, while they worked on this"
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["task1-0", "task3-0", "task3-1"]
    told = sorted(sentence.partition(" ended ")[2] for sentence in onlooker.sentences)
    assert told == [
        "by signal 9 while it worked on title 1. Another worker tries it again.",
        "by signal 9 while it worked on title 3. Another worker tries it again.",
        "by signal 9 while it worked on title 3. This is the second time.",
    ]
    # None is left behind.
    assert processes and not any(process.is_alive() for process in processes)


def test_a_task_without_an_end_is_given_up_and_the_others_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing of what it had written is left."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    onlooker, given = Onlooker(), [Hanging("endless", "endless"), *tasks(tmp_path, 0, 0)]
    with LocalWorkers(1, onlooker, seconds=1.0) as queue:
        outcomes = {outcome.name: outcome for outcome in queue.run(iter(given), Event())}
        assert len(list(scratch.iterdir())) == 1
    assert outcomes["endless"].failure == (
        "This task was stopped after 1 s, the longest time that it may take: allow more seconds, or simplify "
        "the part or the question."
    )
    assert outcomes["endless"].record is None and len(outcomes) == 3
    assert all(outcomes[name].record for name in ("task0", "task1"))
    assert onlooker.sentences == ["worker 1 was ended, because endless took longer than 1 s."]
    assert list(scratch.iterdir()) == []


def test_workers_whose_run_was_killed_leave_nothing(tmp_path: Path) -> None:
    """They end by themselves, and remove what they wrote."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    script = (
        "import os, signal, sys; from threading import Event, Timer; from pathlib import Path;"
        "from batch_helpers import Hanging, Onlooker; from workhold.batch.workers import LocalWorkers\n"
        "if __name__ == '__main__':\n"
        "  with LocalWorkers(1, Onlooker()) as queue:\n"
        "    list(queue.run(iter([Hanging('a', 'a')]), Event()))\n"
    )
    path = [*sys.path, str(Path(__file__).parent)]
    environment = {**os.environ, "TMPDIR": str(scratch), "PYTHONPATH": os.pathsep.join(filter(None, path))}
    (tmp_path / "script.py").write_text(script)
    with subprocess.Popen([sys.executable, str(tmp_path / "script.py")], env=environment) as process:
        wait_until(lambda: any(scratch.glob("*/*/scratch")) or process.poll() is not None)
        assert any(scratch.glob("*/*/scratch"))
        process.kill()
    wait_until(lambda: not list(scratch.iterdir()))


def wait_until(holds: Callable[[], object]) -> None:
    """Waits for what comes at once on a machine that has nothing else to do."""
    end = monotonic() + 120.0
    while not holds():
        assert monotonic() < end, "waited in vain"
        sleep(0.02)


def test_no_worker_is_started_for_nothing() -> None:
    with LocalWorkers(2, Onlooker()) as queue:
        assert list(queue.run(iter([]), Event())) == []
        assert not queue.workers
        stop = Event()
        stop.set()
        assert list(queue.run(iter(tasks(Path("nowhere"), 0)), stop)) == []
        assert not queue.workers


def test_workers_that_cannot_be_started_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "run_worker", ends_at_once)
    monkeypatch.setattr(module, "MOST_FAILED_STARTS", 2)
    with (
        LocalWorkers(1, Onlooker()) as queue,
        pytest.raises(InputError, match="2 in a row ended with code 3 before"),
    ):
        list(queue.run(iter(tasks(tmp_path, 0)), Event()))
