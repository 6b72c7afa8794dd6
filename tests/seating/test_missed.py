"""A fixture that is not found among its own seats is told with what is known of it, and the rest goes on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold import Fence, Fixture, Result, Vise, Workpiece
from workhold.kernels.seating.columns import THETA
from workhold.model.quality import FIGURE_RANKING
from workhold.seating import solver as solver_module
from workhold.seating.pattern import Pattern

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
KITS = {
    "vise": Vise(pitch=20, columns=2, peg_radius=3),
    "fence": Fence(pitch=15, peg_radius=3, wall_offset=6, directions=["-x"]),
}
FIND = solver_module.find_equilibria
NOT_FOUND = "This fixture was not found among the seats of its own pegs"


def missing(fixture: Fixture, toolkit: Any) -> Any:
    """What looks for seats, but on the pegs of a fixture finds none in its orientation."""
    own = Pattern.from_fixture(fixture, toolkit)
    turn = own.frame.map_from_toolkit(np.radians([fixture.pose.theta_deg, 0, 0, 0]))[0]

    def find(boundary: Any, pattern: Pattern, size: float) -> Any:
        found = FIND(boundary, pattern, size)
        if boundary.mirrored or pattern.make_key() != own.make_key():
            return found
        away = np.abs(np.angle(np.exp(1j * (found.seats[:, THETA] - turn))))
        return evolve(found, seats=found.seats[away > 1e-6])

    return find


@pytest.fixture(scope="module", params=list(KITS))
def result(request: pytest.FixtureRequest) -> Result:
    """Two fixtures with their seating."""
    return workhold.design(WEDGE, KITS[request.param], seating=2, best=2, rank_by=FIGURE_RANKING)


@pytest.mark.thorough
def test_it_is_named_and_tells_what_is_known(
    result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    first, other = result[:]
    monkeypatch.setattr(solver_module, "find_equilibria", missing(first, result.toolkit))
    made = workhold.design(WEDGE, result.toolkit, seating=2, best=2, rank_by=FIGURE_RANKING)
    assert len(made.seating) == 2 and made.complete
    told, kept = (made.seating[list(made).index(one)] for one in (first, other))
    assert (told.capture_opening, told.lowest_pass, told.way_out, told.placing) == (0.0, None, 0.0, None)
    assert (
        any(NOT_FOUND in one for one in told.unsettled)
        and told.is_hardly_caught
        and not told.is_caught_from(1e-6)
    )
    # It is a seat all the same, with the contacts, forces and friction that it has, and what else is known stays.
    whole = first.seating
    assert told.sticking_friction == pytest.approx(whole.sticking_friction, abs=1e-9)
    seats = [
        sorted(one.seats, key=lambda seat: (seat.mirrored, round(seat.pose.theta_deg, 4)))
        for one in (told, whole)
    ]
    for one, right in zip(*seats, strict=True):
        assert (one.kind, one.is_own, one.mirrored) == (right.kind, right.is_own, right.mirrored)
        assert {*one.contacts} == {*right.contacts}
        assert one.jaw_separation == pytest.approx(right.jaw_separation, abs=1e-6)
        assert sorted(one.forces) == pytest.approx(sorted(right.forces), abs=1e-6)
    assert kept.to_fields() == other.seating.to_fields()
    path = tmp_path / "r.json"
    workhold.save(made, path)
    assert workhold.verify(path).holds


def test_others_on_the_same_pegs_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first of two that stand alike: both are told with it among their seats, whichever was asked for first."""
    every = workhold.design(WEDGE, KITS["vise"])
    groups: dict[Any, list[Fixture]] = {}
    for fixture in every:
        groups.setdefault(Pattern.from_fixture(fixture, every.toolkit).make_key(), []).append(fixture)
    one, other = next(
        pair[:2]
        for pair in groups.values()
        if len(pair) > 1 and abs(pair[0].pose.theta_deg - pair[1].pose.theta_deg) > 1
    )
    monkeypatch.setattr(solver_module, "find_equilibria", missing(other, every.toolkit))
    here, there = solver_module.SeatingSolver(WEDGE, every.toolkit).solve_all([one, other])
    assert any("others may be missing" in one for one in here.unsettled) and here.capture_opening
    assert any(NOT_FOUND in one for one in there.unsettled)
    assert sum(seat.is_at(other.pose) for seat in there.seats) == 1
    assert len(here.seats) == len(there.seats)
