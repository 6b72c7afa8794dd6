"""A batch: records alone tell what is done, and no part, failure or full disk ends more than it must."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import pytest
from attrs import define
from batch_helpers import COARSE, FINE, IMPOSSIBLE, InlineQueue, records_in, rows_of, run_in

from workhold.batch import store as store_module
from workhold.batch.durations import TaskDurations
from workhold.batch.run import BatchState
from workhold.batch.tasks import Outcome, Task, run_task
from workhold.errors import InputError


def square(path: Path, side: float, name: str = "square") -> Path:
    """A file with a square with a cut corner."""
    loops = [[[0, 0, 0], [side, 0, 0], [side, side - 8, 0], [side - 5, side, 0], [0, side, 0]]]
    path.write_text(json.dumps({"name": name, "units": "mm", "loops": loops}))
    return path


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """Three parts, of which two are equal, and one that cannot be read."""
    folder = tmp_path / "shop"
    folder.mkdir()
    square(folder / "a.json", 30)
    square(folder / "b.json", 44)
    square(folder / "copy.json", 30, "another name")
    (folder / "bad.json").write_text("{")
    return folder


def states_of(batch: BatchState, folder: Path) -> dict[tuple[str, str], str]:
    return {(one.row["part"], one.row["toolkit"]): one.row["state"] for one in rows_of(batch, folder)}


def test_every_part_with_every_toolkit_is_a_row(shop: Path, tmp_path: Path) -> None:
    batch = run_in(tmp_path, shop, queue=InlineQueue(), held_in=(COARSE, IMPOSSIBLE))
    assert states_of(batch, tmp_path) == {
        ("a.json", "coarse"): "held",
        ("a.json", "impossible"): "refused",
        ("b.json", "coarse"): "held",
        ("b.json", "impossible"): "refused",
        ("bad.json", "coarse"): "unreadable",
        ("bad.json", "impossible"): "unreadable",
        ("copy.json", "coarse"): "held",
        ("copy.json", "impossible"): "refused",
    }
    assert batch.is_complete
    reasons = {job.refusal for job in batch.jobs}
    assert "there is no such vise." in reasons and any("not valid JSON" in reason for reason in reasons)


def test_equal_parts_share_a_task_and_the_longest_comes_first(shop: Path, tmp_path: Path) -> None:
    queue = InlineQueue()
    batch = run_in(tmp_path, shop, queue=queue, held_in=(COARSE, FINE))
    jobs = [title for title in queue.titles if " in " in title]
    assert jobs == ["b.json in fine", "b.json in coarse", "a.json in fine", "a.json in coarse"]
    assert (batch.fresh, batch.kept) == (4, 0)


def test_a_second_run_redoes_nothing(shop: Path, tmp_path: Path) -> None:
    run_in(tmp_path, shop, queue=InlineQueue())
    before = records_in(tmp_path)
    (shop / "a.json").rename(shop / "renamed.json")
    again = run_in(tmp_path, shop, queue=InlineQueue(0))
    assert again.is_complete and (again.fresh, again.kept) == (0, 2)
    assert records_in(tmp_path) == before


def test_a_run_that_stops_anywhere_goes_on_where_it_stopped(shop: Path, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    run_in(whole, shop, queue=InlineQueue(), held_in=(COARSE, FINE))
    parts = 0
    for most in range(1, 20):
        queue = InlineQueue(1)
        batch = run_in(tmp_path / "parts", shop, queue=queue, held_in=(COARSE, FINE))
        if batch.is_complete:
            break
        assert len(queue.titles) == 1 and len(records_in(tmp_path / "parts")) == most
        assert "open" in states_of(batch, tmp_path / "parts").values() or not batch.jobs
        parts = most
    # The last record was the last task's.
    assert parts == len(records_in(whole)) - 1 and records_in(tmp_path / "parts") == records_in(whole)


def test_a_record_that_lost_its_end_is_made_again(shop: Path, tmp_path: Path) -> None:
    run_in(tmp_path, shop, queue=InlineQueue())
    before = records_in(tmp_path)
    for name in before:
        (tmp_path / name).write_bytes(before[name][:-1])
    run_in(tmp_path, shop, queue=InlineQueue())
    assert records_in(tmp_path) == before


def damaged(record: bytes) -> bytes:
    """A record with one figure changed, which ends as it should and is still JSON."""
    place = next(k for k in range(len(record) // 2, len(record)) if record[k : k + 1].isdigit())
    changed = record[:place] + str((record[place] - 47) % 10).encode() + record[place + 1 :]
    json.loads(changed)
    return changed


@pytest.mark.parametrize(
    "damage", ["figure", "cut", "empty", "swapped", "moved", "no checksum", "half a checksum"]
)
def test_a_record_that_is_not_what_was_written_is_made_again(shop: Path, tmp_path: Path, damage: str) -> None:
    """Whatever it holds, and however right its ends are."""
    run_in(tmp_path, shop, queue=InlineQueue())
    before = records_in(tmp_path)
    first, *_, last = before
    for name, content in before.items():
        path, beside = tmp_path / name, (tmp_path / name).with_suffix(".sha256")
        match damage:
            case "figure":
                path.write_bytes(damaged(content) if b"loops" in content else content[:-4])
            case "cut":
                path.write_bytes(content[: len(content) // 2] + content[-4:])
            case "empty":
                path.write_bytes(b"")
            case "no checksum":
                beside.unlink()
            case "half a checksum":
                beside.write_bytes(beside.read_bytes()[:20])
    if damage in ("swapped", "moved"):
        # Each whole in itself; of those that were moved the checksums went along.
        for ending in (".json", ".sha256")[: 1 + (damage == "moved")]:
            one, other = ((tmp_path / name).with_suffix(ending) for name in (first, last))
            content = one.read_bytes()
            one.write_bytes(other.read_bytes())
            other.write_bytes(content)
    queue = InlineQueue()
    run_in(tmp_path, shop, queue=queue)
    assert records_in(tmp_path) == before
    assert len(queue.titles) == (2 if damage in ("swapped", "moved") else len(before))


def test_another_question_is_another_task(shop: Path, tmp_path: Path) -> None:
    run_in(tmp_path, shop, queue=InlineQueue())
    queue = InlineQueue()
    run_in(tmp_path, shop, queue=queue, best=4)
    assert sorted(queue.titles) == ["a.json in coarse", "b.json in coarse"]


@define
class Full(InlineQueue):
    """Has no room on its own disk."""

    def outcome(self, task: Task) -> Outcome:
        return Outcome(task.name, None, "The system refused something.", has_no_room=True)


@define
class Fragile(InlineQueue):
    """Loses every task of one title."""

    title: str = ""

    def outcome(self, task: Task) -> Outcome:
        return Outcome(task.name, None, "Two workers ended.") if task.title == self.title else run_task(task)


def test_a_failure_is_a_row_and_is_tried_again_by_the_next_run(shop: Path, tmp_path: Path) -> None:
    lost = run_in(tmp_path, shop, queue=Fragile(title="b.json in coarse"))
    assert states_of(lost, tmp_path)["b.json", "coarse"] == "failed"
    assert {job.failure for job in lost.jobs} == {"", "Two workers ended."}
    queue = InlineQueue()
    again = run_in(tmp_path, shop, queue=queue)
    assert queue.titles == ["b.json in coarse"]
    assert states_of(again, tmp_path)["b.json", "coarse"] == "held"


def test_a_part_whose_reading_fails_is_a_row(shop: Path, tmp_path: Path) -> None:
    lost = run_in(tmp_path, shop, queue=Fragile(title="b.json"))
    assert states_of(lost, tmp_path)["b.json", "coarse"] == "unreadable"
    assert states_of(lost, tmp_path)["a.json", "coarse"] == "held"


def test_a_full_disk_is_one_sentence_and_what_is_done_is_kept(
    shop: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[Path] = []
    write = store_module.write_bytes

    def until_full(path: Path, record: bytes) -> None:
        if len(written) == 10:
            with store_module.explain_system_errors(path):
                raise OSError(errno.ENOSPC, "No space left on device")
        written.append(path)
        write(path, record)

    monkeypatch.setattr(store_module, "write_bytes", until_full)
    with pytest.raises(
        InputError, match=r"No space left on device\. The answers so far are kept: make room, and start"
    ):
        run_in(tmp_path, shop, queue=InlineQueue(), held_in=(COARSE, FINE))
    monkeypatch.undo()
    # Each with its checksum.
    assert len(records_in(tmp_path)) == 5
    queue = InlineQueue()
    assert run_in(tmp_path, shop, queue=queue, held_in=(COARSE, FINE)).is_complete
    assert len(queue.titles) == len(records_in(tmp_path)) - 5
    with pytest.raises(InputError, match=r"The system refused something\. The answers so far are kept"):
        run_in(tmp_path, shop, queue=Full(), best=9)


def test_a_record_that_another_run_has_made_meanwhile_is_taken(shop: Path, tmp_path: Path) -> None:
    class Meanwhile(InlineQueue):
        def outcome(self, task: Task) -> Outcome:
            if task.title == "b.json in fine":
                run_in(tmp_path, shop, queue=InlineQueue(), held_in=(COARSE, FINE))
            return run_task(task)

    queue = Meanwhile()
    batch = run_in(tmp_path, shop, queue=queue, held_in=(COARSE, FINE))
    assert [title for title in queue.titles if " in " in title] == ["b.json in fine"]
    assert set(states_of(batch, tmp_path).values()) == {"held", "unreadable"}


def test_a_file_that_changes_while_the_batch_runs_is_told(shop: Path, tmp_path: Path) -> None:
    class Changing(InlineQueue):
        def outcome(self, task: Task) -> Outcome:
            for path in shop.glob("[ab].json"):
                square(path, 60)
            return run_task(task)

    # Longest first: the largest file is read before the others are looked at again.
    square(shop / "long.json", 50, "n" * 500)
    batch = run_in(tmp_path, shop, queue=Changing())
    changed = {part.request.listed.name: part.refusal for part in batch.parts if "changed" in part.refusal}
    assert set(changed) >= {"b.json"}


@pytest.mark.parametrize("content", [b"part,seconds,who\na.dxf,1.5,Ann\n", b"\xff\n", b"abc def,1,x\n"])
def test_what_others_wrote_down_is_left_as_it_is(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "measured.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"was not written by workhold: give another folder, or rename it\."):
        TaskDurations(path)
    assert path.read_bytes() == content
    path.write_bytes(b"0a1b")
    assert not TaskDurations(path).known


def test_what_tasks_took_is_kept_and_lines_cut_short_are_passed_over(shop: Path, tmp_path: Path) -> None:
    batch = run_in(tmp_path, shop, queue=InlineQueue())
    path = tmp_path / "measured.csv"
    known = TaskDurations(path).known
    assert set(known) == {Path(name).stem for name in records_in(tmp_path)}
    assert all(seconds > 0 and worker == "inline" for seconds, worker in known.values())
    path.write_bytes(path.read_bytes()[:-9] + os.urandom(20))
    assert len(TaskDurations(path).known) <= len(known)
    rows = [one.row for one in rows_of(batch, tmp_path)]
    assert all(row["estimated_seconds"] > 0 for row in rows if row["state"] == "held")
