"""The usual order: the best K are the first K of all, ties included, and verification derives it anew."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from operator import mul
from pathlib import Path
from random import Random

import pytest
from attrs import evolve
from test_random_restrictions import random_toolkit

import workhold
from cad_parts import cad_part
from strategies import random_outline
from workhold import FlatJaw, Plate, Query, Vise, Workpiece, answer
from workhold.fixels.toolkit import Toolkit
from workhold.listing import collector
from workhold.model.first_choice import HOUSE_ORDER
from workhold.search import design, lattice_shares, shares
from workhold.verification import verify_file

PLATE = [(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]
BORE = [(38, 30, 1), (62, 30, 1)]
TOOLKITS: dict[str, Toolkit] = {
    "vise": Vise(pitch=20, columns=3, peg_radius=3),
    "vise of known rows": Vise(pitch=25, columns=2, rows=4, peg_radius=3, max_opening=90),
    "one clamp": Plate(pitch=25, peg_radius=3, directions=("-x", "-y")),
    "one clamp on a small plate": Plate(pitch=20, peg_radius=3, columns=5, rows=4, travel=(10, 40)),
    "two clamps": Plate(pitch=25, peg_radius=3, clamps=2),
    "fence": workhold.Fence(pitch=20, peg_radius=3, wall_offset=10, columns=6, rows=5),
    "fence and two clamps": workhold.Fence(pitch=25, peg_radius=3, wall_offset=10, clamps=2),
    "flat jaw": FlatJaw(pitch=10, peg_radius=3, columns=9),
}


@pytest.fixture(autouse=True)
def searches_of_any_size_stop_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """What only long searches do, and with few fixtures decided at a time."""
    monkeypatch.setattr(shares, "SQUARE_FIRST", 0.0)
    monkeypatch.setattr(design, "LIMITED_FROM", 0.0)
    monkeypatch.setattr(lattice_shares, "COUNTED_WHOLE", 0)
    monkeypatch.setattr(collector, "WAITING_LONG", 50)
    monkeypatch.setattr("workhold.listing.contact_groups.FIRST_CONTACTS", 32)


def assert_first(query: Query, kept: Sequence[int]) -> int:
    """The best so many are the first of all, with the same least error; how many there are."""
    whole = answer(query, threads=1)
    for most in kept:
        few = answer(evolve(query, best=most), threads=1)
        assert few.table == whole.table.take(slice(most))
        assert few.least_effective_error == whole.least_effective_error
    return len(whole)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", TOOLKITS)
@pytest.mark.parametrize("number", [0, pytest.param(3, marks=pytest.mark.prove), 5])
def test_the_best_are_the_first_of_all(kind: str, number: int) -> None:
    """Of parts as they come out of CAD, in every kind of toolkit."""
    assert_first(Query(cad_part(number), TOOLKITS[kind]), (1, 2, 7, 20))


@pytest.mark.thorough
@pytest.mark.parametrize(
    "seed", [1, 2, 3, 4, *(pytest.param(seed, marks=pytest.mark.prove) for seed in range(5, 120))]
)
def test_the_best_are_the_first_of_all_of_random_parts(seed: int) -> None:
    """Random outlines and toolkits, with few orientations in a share."""
    random = Random(seed)
    part, toolkit = random_outline(random, random.choice([3, 4, 5, 6])), random_toolkit(random)
    assert_first(Query(part, toolkit), (1, 5, 20))


def written(tmp_path: Path, **changes: object) -> tuple[str, ...]:
    """What verification says of a file with some entries of its head changed; None takes one away."""
    query = Query(cad_part(0), TOOLKITS["flat jaw"])
    workhold.save(answer(query, threads=1), tmp_path / "r.json")
    fields = json.loads((tmp_path / "r.json").read_text())
    for key, value in changes.items():
        fields[key] = value(fields[key]) if callable(value) else value
        if fields[key] is None:
            del fields[key]
    (tmp_path / "s.json").write_text(json.dumps(fields))
    return verify_file(tmp_path / "s.json").faults


@pytest.mark.thorough
def test_the_file_says_the_least_error_and_verification_holds_it_to_that(tmp_path: Path) -> None:
    """Missing, too small, too large, and of a list whose first ones change places."""
    key = "least_effective_error"
    assert written(tmp_path) == ()
    assert any("is missing" in fault for fault in written(tmp_path, **{key: None}))
    for times in (1 - 1e-6, 1 + 1e-6):
        changed = written(tmp_path, **{key: partial(mul, times)})
        assert any("is given as" in fault for fault in changed)
    swapped = written(tmp_path, fixtures=lambda rows: [rows[-1], *rows[:-1]])
    assert any("is better than the one before it" in fault for fault in swapped)


@pytest.mark.thorough
def test_old_files_keep_their_order(tmp_path: Path) -> None:
    """Files ranked by figures alone say no least error, and verify."""
    figures = ["warnings", "penalty", "clamp_freedom", "clamp_amplification"]
    plate = Workpiece.from_loops("plate", [PLATE])
    result = answer(Query(plate, TOOLKITS["two clamps"], rank_by=figures), threads=1)
    assert result.least_effective_error is None
    workhold.save(result, tmp_path / "old.json")
    assert "least_effective_error" not in json.loads((tmp_path / "old.json").read_text())
    again = workhold.open(tmp_path / "old.json")
    assert again.query.rank_by == tuple(figures) and len(again) == len(result)
    usual = answer(Query(plate, TOOLKITS["two clamps"]), threads=1)
    workhold.save(usual, tmp_path / "new.json")
    assert workhold.open(tmp_path / "new.json").query.rank_by[:3] == HOUSE_ORDER


@pytest.mark.thorough
def test_the_first_lies_as_drawn_where_others_are_hardly_better() -> None:
    """A plate that could stand on any of its sides lies as drawn, a bore is left alone, whatever is ranked by then."""
    result = answer(
        Query(Workpiece.from_loops("plate", [PLATE, BORE]), Plate(pitch=20, peg_radius=3, clamps=2), best=5),
        threads=1,
    )
    assert [fixture.pose.theta_deg for fixture in result][:2] == [0.0, 0.0]
    assert all(peg.face < 4 for fixture in result for peg in fixture.pegs)
