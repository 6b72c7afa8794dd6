"""A search written to a file in columns on its way gives the bytes that the result in memory gives, in little room."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import Any

import pytest

import workhold
from workhold import InputError, Query, Vise
from workhold.listing import collector, runs
from workhold.listing.collector import ResultCollector

QUERIES = {
    "widget": Query(workhold.load("widget"), Vise(pitch=8, columns=1, peg_radius=3)),
    "symmetric": Query(workhold.load("large4Handle"), Vise(pitch=10, columns=2, peg_radius=3)),
    "ranked by one": Query(
        workhold.load("small4Handle"), Vise(pitch=10, columns=3, peg_radius=3), rank_by="closure-margin"
    ),
    "none": Query(workhold.load("small4Handle"), Vise(pitch=70, columns=1, peg_radius=3)),
    "several ways": Query(
        workhold.load("widget"),
        workhold.Plate(pitch=25, peg_radius=3, columns=4, rows=4, directions=("-x", "-y")),
    ),
    "best": Query(workhold.load("widget"), Vise(pitch=8, columns=1, peg_radius=3), best=7),
}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """So little room that everything goes through the disk."""
    for name, value in (("PART", 100), ("ROOM", 150), ("STRIDE", 9)):
        monkeypatch.setattr(runs, name, value)
    monkeypatch.setattr(collector, "BLOCK", 64)


@pytest.mark.thorough
@pytest.mark.parametrize("name", QUERIES)
def test_the_bytes_are_those_of_the_result_in_memory(small: None, tmp_path: Path, name: str) -> None:
    """On any number of threads, and whatever the room; the folder holds nothing else afterwards."""
    whole = workhold.answer(QUERIES[name], threads=2)
    workhold.save(whole, tmp_path / "whole.npz")
    for threads in (1, 3):
        streamed = workhold.answer_to_file(QUERIES[name], tmp_path / "streamed.npz", threads=threads)
        assert (tmp_path / "streamed.npz").read_bytes() == (tmp_path / "whole.npz").read_bytes()
        assert streamed.found == whole.found and streamed.notes == whole.notes and len(streamed) == len(whole)
    assert {path.name for path in tmp_path.iterdir()} == {"whole.npz", "streamed.npz"}


@pytest.mark.thorough
def test_the_room_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts so large that there is one, and parts of a hundred, give the same result in memory."""
    files = []
    for part, stride in ((1 << 15, 1 << 9), (100, 9)):
        monkeypatch.setattr(runs, "PART", part)
        monkeypatch.setattr(runs, "STRIDE", stride)
        files.append(tmp_path / f"{part}.json")
        workhold.save(workhold.answer(QUERIES["symmetric"]), files[-1])
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.thorough
def test_progress_rises_to_its_end(small: None, tmp_path: Path) -> None:
    seen: list[float] = []
    workhold.answer_to_file(
        QUERIES["symmetric"], tmp_path / "a.npz", progress=lambda fraction, found: seen.append(fraction)
    )
    assert seen == sorted(seen) and seen[-1] == pytest.approx(1.0) and len(seen) > 10


@pytest.mark.thorough
def test_what_is_being_sorted_has_no_name_that_a_killed_program_could_leave(
    small: None, tmp_path: Path
) -> None:
    """Runs are on the disk before the file is begun, and no one sees them."""
    seen: set[str] = set()

    def progress(fraction: float, found: int) -> None:
        seen.update(path.suffix for path in tmp_path.iterdir())

    workhold.answer_to_file(QUERIES["symmetric"], tmp_path / "a.npz", progress=progress)
    assert seen == {".part"}


@pytest.mark.thorough
def test_a_cancel_in_the_search_keeps_what_was_found(small: None, tmp_path: Path) -> None:
    cancel = Event()

    def progress(fraction: float, found: int) -> None:
        if found:
            cancel.set()

    result = workhold.answer_to_file(
        QUERIES["symmetric"], tmp_path / "a.npz", progress=progress, cancel=cancel, threads=1
    )
    everything = workhold.answer(QUERIES["symmetric"])
    assert not result.complete and 0 < len(result) < len(everything)
    poses = {fixture.pose.theta_deg for fixture in everything}
    assert all(min(abs(fixture.pose.theta_deg - other) for other in poses) < 1e-6 for fixture in result[:20])


@pytest.mark.thorough
def test_a_cancel_while_fixtures_are_measured_keeps_the_first_of_them(
    small: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cancel, measured = Event(), ResultCollector.measure_part

    def stopping(self: ResultCollector, numbered: Any) -> Any:
        if numbered[0] == 2:
            cancel.set()
        return measured(self, numbered)

    monkeypatch.setattr(ResultCollector, "measure_part", stopping)
    monkeypatch.setattr("workhold.proof.deciding.GRACE", 0.0)
    result = workhold.answer_to_file(QUERIES["symmetric"], tmp_path / "a.npz", cancel=cancel, threads=1)
    assert not result.complete
    assert 0 < len(result) == sum(result.found.values()) < len(workhold.answer(QUERIES["symmetric"]))
    assert list(result) == list(workhold.open(tmp_path / "a.npz"))


def test_a_full_disk_is_told_in_a_sentence_and_leaves_the_earlier_file(
    small: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.npz").write_text("old")

    def full(**_: object) -> object:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(runs, "TemporaryFile", full)
    with pytest.raises(InputError, match=r"a\.npz cannot be written: No space left on device\."):
        workhold.answer_to_file(QUERIES["symmetric"], tmp_path / "a.npz", overwrite=True)
    assert (tmp_path / "a.npz").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]
