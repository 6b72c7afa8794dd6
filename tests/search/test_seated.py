"""The seating of the first fixtures in a result: their order, rules, files of every form, what an interruption leaves."""

from __future__ import annotations

import csv
import pickle
from collections.abc import Iterator
from itertools import pairwise
from math import inf
from pathlib import Path
from threading import Event
from typing import Any

import attrs
import numpy as np
import pytest

import workhold
from seating_examples import solved
from workhold import InputError, OpeningVise, Plate, Query, Result, Vise, Workpiece
from workhold.files.result.fixture_forms import collect_seating_figures
from workhold.kernels.seating.columns import PEG, PLACE_X, SEPARATION, THETA
from workhold.model.notes import PushedByHand
from workhold.model.quality import FIGURE_RANKING, SEATING_FIGURES
from workhold.model.seating import CLOSE_READING, SMALL_CAPTURE
from workhold.seating import solver as solver_module
from workhold.seating.contact_forces import is_equilibrium
from workhold.seating.pattern import Pattern
from workhold.seating.solver import NO_PASS, SeatingSolver

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
VISE = Vise(pitch=20, columns=2, peg_radius=3)
LOOKED_AT = 8


READ = SeatingSolver.make_seating


@pytest.fixture(scope="module", autouse=True)
def read_once() -> Iterator[None]:
    """Work out the seating of each fixture once for all tests, but for those that look at how that is done."""
    known: dict[Any, Any] = {}

    def read(self: SeatingSolver, fixture: Any, *asked: Any) -> Any:
        key = fixture.pose, fixture.travel, self.workpiece, solver_module.is_equilibrium
        if key not in known:
            known[key] = READ(self, fixture, *asked)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SeatingSolver, "make_seating", read)
        yield


@pytest.fixture(scope="module")
def plain() -> Result:
    """All fixtures, whose seating nobody asked for."""
    return workhold.design(WEDGE, VISE)


@pytest.fixture(scope="module")
def seated() -> Result:
    """The same with the seating of the first."""
    return workhold.design(WEDGE, VISE, seating=LOOKED_AT)


def warned(result: Result) -> list[float]:
    """How much there is to beware of in each fixture whose seating is told."""
    return [result[k].quality["warnings"] + told.warning_count for k, told in enumerate(result.seating)]


@pytest.mark.thorough
def test_the_first_fixtures_are_ordered_anew_and_all_others_stay(plain: Result, seated: Result) -> None:
    assert len(seated.seating) == LOOKED_AT and seated.complete
    before, after = ([(f.pegs, f.pose) for f in one[:LOOKED_AT]] for one in (plain, seated))
    assert before != after and sorted(before, key=repr) == sorted(after, key=repr)
    assert list(plain[LOOKED_AT:]) == list(seated[LOOKED_AT:])
    counts = warned(seated)
    assert counts == sorted(counts) and counts[0] < counts[-1]
    # Equal ones stand as they stood.
    for one, other in pairwise(range(LOOKED_AT)):
        if counts[one] == counts[other]:
            assert before.index(after[one]) < before.index(after[other])


@pytest.mark.thorough
def test_each_seating_is_that_of_its_fixture(seated: Result) -> None:
    [alone] = workhold.seatings(seated, seated[3:4])
    told = seated[3].seating
    assert told is seated.seating[3]
    # The pattern was solved for another of its fixtures.
    assert list(alone.figures.values()) == pytest.approx(list(told.figures.values()), abs=1e-9)
    assert [seat.kind for seat in alone.seats] == [seat.kind for seat in told.seats]
    assert seated[LOOKED_AT].seating is None
    assert "with the seating of the first 8" in repr(seated) and "caught below" in repr(seated[0])
    again = pickle.loads(pickle.dumps(seated[3]))
    assert again.listing.result[0].seating == told


@pytest.mark.thorough
def test_warnings_are_of_a_small_opening_and_a_close_reading(seated: Result) -> None:
    for told in seated.seating:
        reading = told.find_least_reading()
        assert reading is not None and told.capture_opening is not None
        assert len(told.warnings) == (told.capture_opening < SMALL_CAPTURE) + (reading < CLOSE_READING)
        assert told.is_foolproof == (reading >= CLOSE_READING)
    one = seated.seating[0]
    small = attrs.evolve(one, capture_opening=0.5)
    assert [words.partition("less than ")[2] for words in small.warnings] == ["0.500 mm"]
    nearest = min((seat for seat in one.seats if seat.is_wrong), key=lambda seat: abs(seat.difference))
    near = attrs.evolve(one, seats=(*one.seats, attrs.evolve(nearest, kind="unsettled", difference=-0.09)))
    assert (small.warning_count, near.warning_count, one.warning_count) == (2, 1, 0)
    alike = attrs.evolve(one, seats=(*one.seats, attrs.evolve(nearest, difference=2e-4)))
    assert alike.warnings == ("a wrong seat reads the same",)
    assert (
        "reads only 0.090 mm differently" in near.warnings[0] and not near.is_foolproof and one.is_foolproof
    )
    for toolkit, opened in (
        (Plate(pitch=20, peg_radius=3), "the clamp is drawn back"),
        (OpeningVise(20, 2, 3), "the jaws are closed"),
        (VISE, "the jaws are opened"),
    ):
        words = f"the part is caught only while {opened} by less than 0.500 mm"
        assert small.with_toolkit(toolkit).warnings == (words,)
    untold = attrs.evolve(one, capture_opening=0.0, lowest_pass=None, cage=None, placing=None)
    assert (
        untold.warnings == ("it is not known how far you may open without losing the part",)
        and untold.figures["placing"] == 0.0
    )
    assert collect_seating_figures(untold.to_fields())["placing"] == 0.0
    free = attrs.evolve(one, capture_opening=None)
    assert not free.warnings and free.is_caught_from(1e9) and free.figures["capture_opening"] == inf
    assert not one.is_caught_from(one.capture_opening or 0.0) and one.is_caught_from(
        0.999 * (one.capture_opening or 0.0)
    )


@pytest.mark.thorough
def test_the_result_is_the_same_on_any_number_of_threads(
    seated: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SeatingSolver, "make_seating", READ)
    other = workhold.design(WEDGE, VISE, seating=LOOKED_AT, threads=1)
    for number, result in enumerate((seated, other)):
        workhold.save(result, tmp_path / f"{number}.json")
    assert (tmp_path / "0.json").read_bytes() == (tmp_path / "1.json").read_bytes()


@pytest.mark.thorough
def test_every_form_says_the_same(seated: Result, tmp_path: Path) -> None:
    for name in ("a.json", "a.npz", "a.csv"):
        workhold.save(seated, tmp_path / name)
    workhold.save(workhold.open(tmp_path / "a.npz"), tmp_path / "b.json")
    workhold.save(workhold.open(tmp_path / "a.json"), tmp_path / "b.npz")
    workhold.answer_to_file(seated.query, tmp_path / "c.npz")
    for name, other in (("a.json", "b.json"), ("a.npz", "b.npz"), ("a.npz", "c.npz")):
        assert (tmp_path / name).read_bytes() == (tmp_path / other).read_bytes()
    read = workhold.open(tmp_path / "a.json")
    assert [one.to_fields() for one in read.seating] == [one.to_fields() for one in seated.seating]
    assert [one.warnings for one in read.seating] == [one.warnings for one in seated.seating]
    assert all(sum(seat.is_own for seat in one.seats) == 1 for one in read.seating)
    rows = list(csv.DictReader((tmp_path / "a.csv").open()))
    for k, row in enumerate(rows):
        told = [row[figure.key] for figure in SEATING_FIGURES]
        if k >= LOOKED_AT:
            assert set(told) == {""}
        else:
            assert list(map(float, told)) == pytest.approx(list(seated.seating[k].figures.values()), abs=1e-9)
    frame = pytest.importorskip("pandas") and seated.to_pandas()
    assert frame["wrong_seats"].notna().sum() == LOOKED_AT
    assert list(frame.columns) == list(rows[0])


@pytest.mark.thorough
def test_a_file_with_a_seating_that_is_none_is_refused(seated: Result, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    workhold.save(seated, path)
    text = path.read_text()
    for old, new, words in (
        ('"room_factor"', '"factor"', "fixture 1 cannot be used: seating.room_factor: it is missing"),
        ('"kind": "fixture"', '"kind": "chair"', r"seating\.seats\.8\.kind"),
        ('"seating": 8', '"seating": 3', "seating of 8 fixtures is stated, but it is asked of 3"),
        (', "seating": {', ', "sitting": {', "its seating stated, but not the one before it"),
    ):
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(InputError, match=words):
            workhold.open(path)


@pytest.mark.thorough
def test_rules_leave_out_what_is_not_as_asked_and_say_so(seated: Result) -> None:
    kept = workhold.design(WEDGE, VISE, seating=LOOKED_AT, foolproof=True)
    wanted = [told for told in seated.seating if told.is_foolproof]
    assert 0 < len(wanted) < LOOKED_AT and [t.to_fields() for t in kept.seating] == [
        t.to_fields() for t in wanted
    ]
    assert len(kept) == len(wanted) and sum(kept.found.values()) == len(seated)
    assert f"The seating of the first 8 fixtures was worked out: {len(wanted)} of them" in str(kept.notes[-1])
    # The more the jaws open, the fewer fixtures catch the part, and the more wrong seats count.
    level = sorted(told.capture_opening or inf for told in seated.seating)[4]
    opened = workhold.design(WEDGE, VISE, seating=LOOKED_AT, opening=level)
    assert len(opened) == sum(told.is_caught_from(level) for told in seated.seating) < LOOKED_AT
    assert all(told.opening == level for told in opened.seating)
    assert all(len(told.list_wrong_seats()) <= len(told.list_wrong_seats(1e9)) for told in opened.seating)
    first = workhold.design(WEDGE, VISE, seating=LOOKED_AT, foolproof=True, best=2)
    assert list(first) == list(kept[:2])


@pytest.mark.thorough
def test_seating_is_a_figure_to_rank_by() -> None:
    ranked = workhold.design(WEDGE, VISE, seating=LOOKED_AT, rank_by="capture-opening")
    openings = [round(told.capture_opening or inf, 9) for told in ranked.seating]
    assert openings == sorted(openings, reverse=True)
    same = workhold.design(WEDGE, VISE, seating=LOOKED_AT, rank_by=FIGURE_RANKING)
    assert sorted(openings) == sorted(round(told.capture_opening or inf, 9) for told in same.seating)
    assert same.query.without_seating.rank_by == ranked.query.without_seating.rank_by


def test_the_best_are_those_of_the_looked_at(seated: Result) -> None:
    best = workhold.design(WEDGE, VISE, seating=LOOKED_AT, best=3)
    assert list(best) == list(seated[:3])
    assert [told.to_fields() for told in best.seating] == [told.to_fields() for told in seated.seating[:3]]
    assert "Only the best 3 were sought" in str(best.notes[0])


@pytest.mark.thorough
def test_an_interruption_leaves_what_was_worked_out(plain: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those whose seating is told come first, the others as they were."""
    cancel, solve = Event(), SeatingSolver.make_seating

    def until_three(self: SeatingSolver, *asked: Any) -> Any:
        if len(seen) == 3:
            cancel.set()
        seen.append(asked)
        return solve(self, *asked)

    seen: list[Any] = []
    monkeypatch.setattr(SeatingSolver, "make_seating", until_three)
    result = workhold.design(WEDGE, VISE, seating=LOOKED_AT, threads=1, cancel=cancel)
    assert 3 < len(result.seating) == len(seen) < LOOKED_AT and not result.complete
    assert len(result) == len(plain) and warned(result) == sorted(warned(result))
    ranks = [list(plain).index(fixture) for fixture in result[len(seen) :]]
    assert ranks == sorted(ranks)
    assert workhold.verify(result).holds


def test_progress_goes_forward_to_the_end(tmp_path: Path) -> None:
    heard: list[tuple[int, float]] = []
    query = Query(WEDGE, VISE, seating=3)
    workhold.answer(query, progress=lambda done, _: heard.append((0, done)))
    workhold.answer_to_file(query, tmp_path / "a.npz", progress=lambda done, _: heard.append((1, done)))
    assert heard == sorted(heard) and (0, 1.0) in heard and heard[-1] == (1, 1.0)


def test_what_needs_seating_is_refused_without_it() -> None:
    for asked in ({"foolproof": True}, {"opening": 1.0}, {"rank_by": "reading"}):
        with pytest.raises(InputError, match="such as seating 100"):
            workhold.design(WEDGE, VISE, **asked)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="opening -1 is not a length"):
        workhold.design(WEDGE, VISE, seating=2, opening=-1.0)
    with pytest.raises(InputError, match=r"choose among .*capture-opening"):
        workhold.design(WEDGE, VISE, seating=2, rank_by="bliss")


@pytest.mark.thorough
def test_with_two_clamps_fixtures_stay_in_order_and_a_note_says_that_the_part_is_put_in_by_hand(
    tmp_path: Path,
) -> None:
    """In one go and through a file; what is read from the file holds, and asking does not search for figures."""
    part = Workpiece.from_loops("square", [[[0, 0, 0], [70, 0, 0], [70, 45, 0], [0, 45, 0]]])
    plate, heard = Plate(pitch=20, peg_radius=3, clamps=2, columns=4, rows=3), list[float]()
    plain, asked = workhold.design(part, plate, best=3), Query(part, plate, best=3, seating=2)
    made = workhold.answer(asked, progress=lambda done, _: heard.append(done))
    assert made.table == plain.table and made.query == asked and made.complete and heard[-1] == 1.0
    assert made.notes == (*plain.notes, PushedByHand()) and made.seating == () and made[0].seating is None
    for name in ("a.npz",):
        streamed = workhold.answer_to_file(asked, tmp_path / name)
        read = workhold.open(tmp_path / name)
        assert streamed.notes == read.notes == made.notes and read.query == made.query and read.seating == ()
        assert np.array_equal(read.table.face, made.table.face)
        assert workhold.verify(tmp_path / name, complete=True).holds
    for further in ({"opening": 1.0}, {"foolproof": True}, {"rank_by": "reading"}):
        with pytest.raises(
            InputError, match=r"put against its locators by hand, so no opening.*ask for the seating alone"
        ):
            workhold.answer(attrs.evolve(asked, **further))
    none = workhold.answer(
        Query(Workpiece.from_loops("tiny", [[[0, 0, 0], [2, 0, 0], [1, 2, 0]]]), plate, seating=2)
    )
    assert not len(none) and PushedByHand() not in none.notes


def test_of_two_clamps_no_seating_may_be_told_and_the_note_must(tmp_path: Path) -> None:
    """A file is refuted that tells one of them a seating, or leaves the note out."""
    part = Workpiece.from_loops("square", [[[0, 0, 0], [70, 0, 0], [70, 45, 0], [0, 45, 0]]])
    plate, path = Plate(pitch=20, peg_radius=3, clamps=2, columns=4, rows=3), tmp_path / "a.json"
    made = workhold.design(part, plate, seating=1, best=1)
    workhold.save(attrs.evolve(made, notes=()), path)
    assert any("the part in is stated for each" in fault for fault in workhold.verify(path).faults)
    [other] = workhold.design(WEDGE, VISE, seating=1, best=1).seating
    workhold.save(attrs.evolve(made, seating=(other,)), path)
    outcome = workhold.verify(path)
    assert "with two clamps there is none" in outcome.unproven[0].reason
    assert any("than of the 0 that it is asked of" in fault for fault in outcome.faults)


@pytest.mark.thorough
def test_an_opening_is_told_only_with_a_pass_that_is_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Passes are equilibria, and are none a little beside; without one nothing is claimed, and that is warned of."""
    solver, fixture, _ = solved(1)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    closing = solver.make_closing(pattern, False)
    for row in solver.find_join_trees(pattern)[0].passes:
        assert is_equilibrium(row, closing)
        for column in (THETA, PLACE_X, SEPARATION):
            beside = row.copy()
            beside[column] += 1e-6
            assert not is_equilibrium(beside, closing)
        other = row.copy()
        other[[PEG, PEG + 1]] = other[[PEG + 1, PEG]]
        assert not is_equilibrium(other, closing)
        # The same places with the jaws exchanged: what moves would have to pull.
        there = pattern.pegs + row[SEPARATION] * np.stack([pattern.right, 0 * pattern.right], axis=1)
        pulling = attrs.evolve(closing, pattern=attrs.evolve(pattern, pegs=there, right=1 - pattern.right))
        still = row.copy()
        still[SEPARATION] = 0.0
        assert not is_equilibrium(still, pulling)
        assert is_equilibrium(still, attrs.evolve(closing, pattern=attrs.evolve(pattern, pegs=there)))
    monkeypatch.setattr("workhold.seating.solver.is_equilibrium", lambda *_: False)
    result = workhold.design(WEDGE, VISE, seating=2, best=2)
    for told in result.seating:
        assert (told.capture_opening, told.lowest_pass, told.cage, told.placing) == (0.0, None, None, None)
        assert told.unsettled == (NO_PASS,) and told.warning_count >= 2 and not told.is_caught_from(0.001)
    workhold.save(result, tmp_path / "r.json")
    assert workhold.verify(tmp_path / "r.json").holds
