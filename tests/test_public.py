"""Everything public is named, told in a short line, and pickled, compared and copied by what it says."""

from __future__ import annotations

import copy
import inspect
import pickle
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve

import workhold

EXAMPLES = Path(__file__).parent.parent / "examples"
WEDGE = [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]
CLASSES = [name for name in workhold.__all__ if isinstance(getattr(workhold, name), type)]
# A line of a terminal or a notebook, and a bit more.
LONGEST = 200


@cache
def result() -> workhold.Result:
    """A few fixtures of a wedge."""
    return workhold.design(wedge(), workhold.Vise(pitch=15, columns=1, peg_radius=2))


def wedge(name: str = "wedge") -> workhold.Workpiece:
    return workhold.Workpiece.from_loops(name, WEDGE)


# Of each class two that differ.
MAKERS: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "Fence": (
        lambda: workhold.Fence(pitch=20, peg_radius=3, wall_offset=10),
        lambda: workhold.Fence(pitch=20, peg_radius=3, wall_offset=11),
    ),
    "Fixture": (lambda: result()[0], lambda: result()[1]),
    "FlatJaw": (
        lambda: workhold.FlatJaw(pitch=10, peg_radius=3, max_opening=60),
        lambda: workhold.FlatJaw(pitch=10, peg_radius=3),
    ),
    "InputError": (lambda: workhold.InputError("one."), lambda: workhold.InputError("two.")),
    "Load": (lambda: workhold.Load(moment=100), lambda: workhold.Load(moment=200)),
    "OpeningVise": (
        lambda: workhold.OpeningVise(pitch=10, columns=2, peg_radius=3),
        lambda: workhold.Vise(pitch=10, columns=2, peg_radius=3),
    ),
    "Peg": (lambda: result()[0].pegs[0], lambda: result()[0].pegs[1]),
    "Plate": (
        lambda: workhold.Plate(pitch=20, peg_radius=3),
        lambda: workhold.Plate(pitch=20, peg_radius=3, clamps=2),
    ),
    "Pose": (lambda: result()[0].pose, lambda: workhold.Pose(0, 0, 0)),
    "Program": (
        lambda: workhold.Program.read(EXAMPLES / "bracket.nc", thickness=12),
        lambda: workhold.Program.read(EXAMPLES / "bracket.nc", thickness=13),
    ),
    "PlainVise": (
        lambda: workhold.PlainVise(jaw_width=152, jaw_height=44, parallels=[20]),
        lambda: workhold.PlainVise(jaw_width=152, jaw_height=44, parallels=[20], stop="left"),
    ),
    "Query": (lambda: result().query, lambda: workhold.Query(wedge("other"), result().toolkit)),
    "Restrictions": (
        lambda: workhold.Restrictions(avoid=(1,), zones=(workhold.circle_zone(1, 2, 3),)),
        lambda: workhold.Restrictions(zones=(workhold.polygon_zone([(0, 0), (1, 0), (0, 1)]),)),
    ),
    "Result": (result, lambda: workhold.design(wedge("other"), result().toolkit)),
    "StrapPlate": (
        lambda: workhold.StrapPlate(pitch=20, peg_radius=3),
        lambda: workhold.StrapPlate(pitch=20, peg_radius=3, straps=3),
    ),
    "Tolerance": (lambda: workhold.Tolerance(), lambda: workhold.Tolerance.preset("plate-20mm")),
    "Vise": (
        lambda: workhold.Vise(pitch=10, columns=2, peg_radius=3, blocked=("L-B3",)),
        lambda: workhold.Vise(pitch=10, columns=2, peg_radius=3),
    ),
    "WorkholdError": (lambda: workhold.WorkholdError("one."), lambda: workhold.WorkholdError("two.")),
    "Workpiece": (wedge, lambda: wedge("other")),
}


def same(one: Any, other: Any) -> bool:
    """Errors are never equal; what they say is."""
    return bool(
        (type(one), str(one)) == (type(other), str(other)) if isinstance(one, Exception) else one == other
    )


def test_every_public_class_is_tried() -> None:
    assert sorted(MAKERS) == sorted(CLASSES)


@pytest.mark.parametrize("name", sorted(MAKERS))
def test_what_is_public_pickles_copies_and_compares(name: str) -> None:
    """A copy, a deep copy and one through pickle are equal, of the same class and told alike; another one is not."""
    make, other = MAKERS[name]
    one = make()
    assert type(one).__name__ == name
    for again in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert type(again) is type(one) and same(again, one) and repr(again) == repr(one)
        if not isinstance(one, Exception):
            assert hash(again) == hash(one)
    assert not same(one, other())


@pytest.mark.parametrize("name", ["Fixture", "Program", "Result", "Workpiece"])
def test_what_is_large_is_told_in_a_short_line(name: str) -> None:
    """Neither arrays nor lists of pegs."""
    told = repr(MAKERS[name][0]())
    assert (
        len(told) < LONGEST
        and "\n" not in told
        and told.startswith(f"<{name} ".replace("Result ", "Result:"))
    )


def test_the_lines_say_what_there_is() -> None:
    """The part's size, how many fixtures of each type, and of one its rank, holes and angle."""
    assert repr(workhold.load("widget")) == "<Workpiece widget: 16 faces, 60.3001 x 43.6018 mm>"
    kinds = ", ".join(f"{count} of type {kind}" for kind, count in result().counts.items())
    assert repr(result()) == f"<Result: {len(result())} fixtures of wedge in a vise ({kinds})>"
    best = result()[0]
    holes = " ".join(peg.hole for peg in best.pegs)
    turned = f"{best.pose.theta_deg:.3f}"
    assert repr(best) == f"<Fixture 1 of {len(result())}, {best.type}: {holes} at {turned} degrees>"


def test_nothing_public_speaks_of_segments_where_faces_are_meant() -> None:
    """No argument, no field and no figure of a fixture is called after a segment."""
    for name in workhold.__all__:
        thing = getattr(workhold, name)
        words = [*inspect.signature(thing).parameters] if callable(thing) and name != "WorkholdError" else []
        assert not [word for word in words if re.search("segment", word)], name


def test_fixtures_know_their_rank_however_they_are_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    """By index, from the end, and one after the other over several blocks."""
    monkeypatch.setattr("workhold.model.result.BLOCK", 2)
    found = result()
    ranks = list(range(1, len(found) + 1))
    assert len(ranks) > 4 and [fixture.listing.rank for fixture in found] == ranks
    assert [found[k].listing.rank for k in (0, 3, -1)] == [1, 4, ranks[-1]]
    assert [fixture == found[fixture.listing.row] for fixture in found] == [True] * len(found)


@pytest.mark.parametrize("clamps", [1, 2])
def test_a_fixture_beside_a_wall_is_the_same_alone_and_in_turn(clamps: int) -> None:
    """Each has the ends, faces and clamps of its own, though all are made at once where one follows the other."""
    # Its widest hull edge lies on the wall with two corners.
    arrow = workhold.Workpiece.from_loops("arrow", [[[0, 0, 0], [20, 9, 0], [41, 0, 0], [13, 37, 0]]])
    fence = workhold.Fence(10, 2, clamp_radius=3, travel=(6, 40), wall_offset=10, columns=6, rows=6)
    found = workhold.design(arrow, evolve(fence, clamps=clamps, directions=None))
    in_turn = list(found)
    assert len({tuple(peg.beside for peg in one.pegs[:2]) for one in in_turn}) > 1
    assert in_turn == [found[k] for k in range(len(found))]


def test_a_fixture_taken_along_takes_no_more_than_itself() -> None:
    """Through pickle it still knows its rank and how many others use its holes, and the result's table stays behind."""
    many = workhold.design(workhold.load("widget"), workhold.Vise(pitch=8, columns=1, peg_radius=3))
    one = many[7]
    again = pickle.loads(pickle.dumps(one))
    assert len(pickle.dumps(one)) < len(pickle.dumps(many)) / 10
    assert again.listing.rank == 8 and again.listing.count == len(many)
    assert again.listing.others == many.table.count_in_same_holes(7) == one.listing.others
    assert again.draw() == one.draw()
