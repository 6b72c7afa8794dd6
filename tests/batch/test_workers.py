"""Worker processes: each outcome once, and the death of a worker loses nothing."""

from __future__ import annotations

from pathlib import Path
from threading import Event

import pytest
from batch_helpers import Fatal, Onlooker, ends_at_once

from workhold.batch import workers as module
from workhold.batch.store import plain_record
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
        assert record is not None and plain_record(record)["refusal"] == f"{name} was done."
    assert outcomes["task3"].record is None
    assert outcomes["task3"].failure.startswith(
        "Two workers ended, the last by signal 9, while they worked on this"
    )
    assert sorted(p.name for p in tmp_path.iterdir()) == ["task1-0", "task3-0", "task3-1"]
    told = sorted(sentence.partition(" ended ")[2] for sentence in onlooker.sentences)
    assert told == [
        "by signal 9 while it worked on title 1, which is tried again.",
        "by signal 9 while it worked on title 3, for the second time.",
        "by signal 9 while it worked on title 3, which is tried again.",
    ]
    # None is left behind.
    assert processes and not any(process.is_alive() for process in processes)


def test_no_worker_is_started_for_nothing() -> None:
    with LocalWorkers(2, Onlooker()) as queue:
        assert list(queue.run(iter([]), Event())) == []
        assert not queue.workers
        stop = Event()
        stop.set()
        assert list(queue.run(iter(tasks(Path("nowhere"), 0)), stop)) == []
        assert not queue.workers


def test_workers_that_cannot_be_started_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "worker", ends_at_once)
    monkeypatch.setattr(module, "MOST_FAILED_STARTS", 2)
    with (
        LocalWorkers(1, Onlooker()) as queue,
        pytest.raises(InputError, match="2 in a row ended with code 3 before"),
    ):
        list(queue.run(iter(tasks(tmp_path, 0)), Event()))
