"""Tasks: the same record wherever they are done, and only what would come out the same again is one."""

from __future__ import annotations

import errno
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve
from batch_helpers import COARSE, FINE, Failing, Unprepared

import workhold
from workhold import Query, answer, conventions, load
from workhold.batch import tasks
from workhold.batch.run import BatchJob
from workhold.batch.store import (
    FolderStore,
    is_whole,
    make_checksum_line,
    parse_record,
    read_workpiece_record,
)
from workhold.batch.tables import BEST, fill_job_row
from workhold.batch.tasks import DrawingTask, QueryTask, identify_program, make_task_name, run_task
from workhold.errors import InputError
from workhold.files.result.writer import write_result_text
from workhold.search import estimate
from workhold.verification import verify_file
from workhold.version import ANSWERS

FLANGE = Path(str(files("workhold"))) / "data" / "parts" / "flange.json"


def part_of(content: bytes, ending: str = ".json") -> bytes:
    """The record of a drawing."""
    record = run_task(DrawingTask("name", "title", ending, content, {})).record
    assert record is not None
    return record


@pytest.fixture(scope="module")
def part() -> bytes:
    """The record of a part that comes with the program."""
    return part_of(FLANGE.read_bytes())


def test_a_drawing_becomes_the_part_that_it_is(part: bytes) -> None:
    record = parse_record(part)
    flange = load("flange")
    assert read_workpiece_record(record).loops[0].tolist() == flange.loops[0].tolist()
    assert (record["faces"], record["refusal"]) == (len(flange.faces), "")
    assert record["size"] == [flange.bounds[2] - flange.bounds[0], flange.bounds[3] - flange.bounds[1]]


def test_of_very_many_fixtures_the_best_are_sought(
    part: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are the first of all, and how many there are is told about."""
    assert isinstance(COARSE.query, Query)
    counted = run_task(QueryTask("name", "title", part, COARSE.query, 3)).record
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked, **more: 4_240_000)
    sought = run_task(QueryTask("name", "title", part, COARSE.query, 3)).record
    assert counted is not None and sought is not None
    all_counted, best = parse_record(counted), parse_record(sought)
    assert best["fixtures"] == all_counted["fixtures"] and len(best["fixtures"]) == 3
    assert best["note_data"][0] == {"kind": "many", "count": 4_240_000, "listed": 3}
    assert sum(best["found"].values()) == 3 < sum(all_counted["found"].values())
    (tmp_path / "best.json").write_bytes(sought)
    assert verify_file(tmp_path / "best.json").faults == ()
    rows = [dict[str, Any](), dict[str, Any]()]
    nobodys: Any = None
    for row, record in zip(rows, (all_counted, best), strict=True):
        fill_job_row(row, {}, record, BatchJob(nobodys, COARSE))
    assert rows[0]["fixtures"] == sum(all_counted["found"].values()) and rows[0]["reason"] is None
    assert (rows[1]["fixtures"], rows[1]["distinct"]) == (4_200_000, None)
    assert "about 4,200,000 fixtures" in rows[1]["reason"]


def test_a_drawing_that_cannot_be_read_is_a_record_without_a_name_of_its_file() -> None:
    record = parse_record(part_of(b"0\nSECTION\n", ".dxf"))
    assert record["refusal"].startswith("the DXF file is cut short")


def test_an_answer_is_the_first_of_all_fixtures_and_counts_all(part: bytes) -> None:
    assert isinstance(COARSE.query, Query)
    outcome = run_task(QueryTask("name", "title", part, COARSE.query, 3))
    whole = answer(Query(evolve(load("flange"), name="part"), COARSE.query.toolkit), threads=2)
    assert sum(whole.found.values()) > 3
    first = evolve(whole, query=evolve(whole.query, best=3), table=whole.table.take(slice(0, 3)))
    assert outcome.record == "".join(write_result_text(first)).encode()
    assert run_task(QueryTask("other", "title", part, COARSE.query, 3)).record == outcome.record


def test_an_answer_tells_the_seating_of_those_it_keeps(part: bytes, tmp_path: Path) -> None:
    """Of the first two of three kept, and of one where only one is; in the order that it gives them, and in the tables."""
    assert isinstance(COARSE.query, Query)
    query = evolve(COARSE.query, seating=2, opening=0.001)
    whole = answer(evolve(query, workpiece=evolve(load("flange"), name="part")))
    for kept in (3, 1):
        record = run_task(QueryTask("name", "title", part, query, kept)).record
        first = evolve(whole.slice_rows(slice(0, kept)), query=evolve(whole.query, best=kept))
        assert (
            len(first.seating) == min(kept, 2)
            and first.notes
            and record == "".join(write_result_text(first)).encode()
        )
        (tmp_path / "r.json").write_bytes(record)
        told = [one.figures for one in workhold.open(tmp_path / "r.json").seating]
        assert told == [
            {key: pytest.approx(value, abs=1e-9) for key, value in one.figures.items()}
            for one in first.seating
        ]
        assert all(set(one) < set(BEST) for one in told)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (MemoryError(), "more memory"),
        (OSError(errno.ENOMEM, "Cannot allocate memory"), "more memory"),
        (
            OSError(errno.EIO, "Input/output error"),
            "refused something that this task needs: Input/output error",
        ),
        (RuntimeError("odd"), r"workhold has a fault \(RuntimeError: odd\)"),
    ],
)
def test_what_may_not_come_again_is_no_record(error: Exception, words: str) -> None:
    import re

    outcome = run_task(Failing("name", "title", error=error))
    assert outcome.record is None and not outcome.has_no_room
    assert re.search(words, outcome.failure)


def test_what_would_come_again_is_a_record() -> None:
    outcome = run_task(Failing("name", "title", error=InputError("no such face.")))
    assert outcome.record is not None and parse_record(outcome.record)["refusal"] == "no such face."


def test_a_worker_that_is_not_fit_is_no_reason_to_refuse_a_part() -> None:
    lacking = run_task(Unprepared("name", "title", error=InputError("no kernels.")))
    assert (lacking.record, lacking.failure) == (None, "no kernels.")
    other = run_task(Failing("name", "title", program="0.0.1 abc", error=InputError("no such face.")))
    assert other.record is None and "another version of workhold" in other.failure


def test_a_full_disk_is_told_from_other_failures() -> None:
    assert run_task(
        Failing("name", "title", error=OSError(errno.ENOSPC, "No space left on device"))
    ).has_no_room


def test_names_tell_apart_all_that_has_a_say(monkeypatch: pytest.MonkeyPatch) -> None:
    names = {
        make_task_name(*content)
        for content in (
            (b"a", b"b"),
            (b"ab",),
            (b"a", "b"),
            (b"a", {"k": 1}),
            (COARSE.entry, 3),
            (COARSE.entry, 4),
        )
    }
    assert len(names | {make_task_name(FINE.entry, 3)}) == 7
    before = make_task_name(b"a")
    monkeypatch.setattr(tasks, "identify_program", lambda: "another")
    assert make_task_name(b"a") != before


def test_names_outlive_what_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A docstring of the sources decides nothing; a number of the conventions, or a raised one of answers, does."""

    def now() -> str:
        identify_program.cache_clear()
        return identify_program()

    try:
        first = now()
        monkeypatch.setattr(conventions, "__doc__", "In other words.")
        monkeypatch.setattr(conventions, "GAP_SLACK", conventions.GAP_SLACK)
        assert now() == first
        monkeypatch.setattr(conventions, "GAP_SLACK", 2 * conventions.GAP_SLACK)
        other = now()
        monkeypatch.setattr(tasks, "ANSWERS", ANSWERS + 1)
        assert len({first, other, now()}) == 3
    finally:
        monkeypatch.undo()
        identify_program.cache_clear()


def test_other_records_have_another_number(part: bytes) -> None:
    """Where this fails because answers or files have changed, raise ``version.ANSWERS`` and write the new pair here."""
    records = [
        part,
        *(run_task(QueryTask("name", "title", part, one.query, 3)).record for one in (COARSE, FINE)),
    ]
    assert (ANSWERS, sha256(b"".join(records)).hexdigest()[:16]) == (3, "0cd87a47255268de")


def test_a_record_cut_short_anywhere_is_none(part: bytes, tmp_path: Path) -> None:
    store = FolderStore(tmp_path)
    assert store.read("abcd") is None and not store.has("abcd")
    store.write("abcd", part)
    assert store.has("abcd") and store.read("abcd") == part
    assert Path(store.get_location("abcd")) == tmp_path / "ab" / "abcd.json"
    for length in range(len(part)):
        assert not is_whole("abcd", part[:length], make_checksum_line("abcd", part))
    Path(store.get_location("abcd")).write_bytes(part[:-1])
    assert store.read("abcd") is None and not store.has("abcd")
