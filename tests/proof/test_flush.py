"""Pairs of locator and clamp decided in balls: the same as by bounds in doubles, and what those leave open."""

from __future__ import annotations

import numpy as np
import pytest

from workhold import Fence, Query, Workpiece
from workhold.contact.problem import Problem
from workhold.listing.wall_fixtures import WallFixtures
from workhold.proof.exact_contacts import find_drawn_segment
from workhold.proof.flush import WallCandidate, is_pressing
from workhold.search import wall_contacts
from workhold.search.flush_search import lay_part_on_wall
from workhold.search.wall_search import WallSearch

KITE = [[0, 0, 0], [56, 6, 0], [48, 44, 0], [10, 37, 0.2]]
ARCH = [[0, 0, 0], [40, 0, 0], [40, 20, 1], [0, 20, 0]]
SLOT = [[0, 0, 0], [30, 4, 1], [28, 18, 0], [0, 14, 0.3]]


def searched(
    loop: list[list[float]], direction: str, margin: float = 0.0
) -> tuple[WallSearch, set[tuple[object, ...]]]:
    """A search that is done, and what it found."""
    fence = Fence((9, 7), 2, wall_offset=4, clamp_radius=2.5, directions=[direction])
    search = WallSearch(
        Problem.from_query(Query(Workpiece.from_loops("part", [loop]), fence, contact_margin=margin))
    )
    parts = [part for edge in search.edges for part in search.iterate_fixtures(edge)]
    found = WallFixtures.concatenate(parts)
    columns = (found.edge, found.row, found.line, *found.feature.T, *np.round(found.tip.T, 6))
    return search, set(zip(*(column.tolist() for column in columns), strict=True))


@pytest.mark.thinned(3)
@pytest.mark.parametrize("loop", [KITE, ARCH, SLOT], ids=["kite", "arch", "slot"])
@pytest.mark.parametrize("direction", ["-x", "+x", "-y"])
@pytest.mark.parametrize("margin", [0.0, 3.0])
def test_balls_and_bounds_agree_on_every_pair(
    loop: list[list[float]], direction: str, margin: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With rounding taken for as large as lengths are, everything is left to the balls."""
    search, found = searched(loop, direction, margin)
    with monkeypatch.context() as patched:
        patched.setattr(wall_contacts, "ROUNDING", 1e3)
        in_balls, also = searched(loop, direction, margin)
        # So are places, and contacts far beyond the ends of their faces are looked at, too.
        patched.setattr(wall_contacts, "ROUNDING", 1e-4)
        patched.setattr(wall_contacts, "LOOSE", 6.0)
        wider, once_more = searched(loop, direction, margin)
    assert in_balls.escalated == in_balls.examined == search.examined > 10
    assert found == also and len(found) == search.verified == in_balls.verified > 0
    assert found == once_more and wider.examined >= search.examined
    assert search.escalated < search.examined / 3 and search.undecided == in_balls.undecided == []


@pytest.mark.parametrize("loop", [KITE, ARCH, SLOT], ids=["kite", "arch", "slot"])
@pytest.mark.parametrize("direction", ["+x", "-y"])
def test_pairs_that_cannot_oppose_each_other_need_no_look(loop: list[list[float]], direction: str) -> None:
    """A search that explains looks at all pairs: it finds the same, with the same pairs left to balls."""
    problem = Problem.from_query(
        Query(Workpiece.from_loops("part", [loop]), Fence(2, 0.5, wall_offset=4, directions=[direction]))
    )
    quick, whole = WallSearch(problem), WallSearch(problem, explains=True)
    for edge in quick.edges:
        one, other = (
            WallFixtures.concatenate(list(search.iterate_fixtures(edge))) for search in (quick, whole)
        )
        for name in ("row", "line", "locator", "tip", "feature", "null", "push"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("examined", "verified", "escalated", "undecided"):
        assert getattr(quick, name) == getattr(whole, name)
    assert quick.verified > 20


def test_a_row_that_just_grazes_an_arc_is_decided_in_balls() -> None:
    """A row at the very top of the arch, 40 high with the peg: a contact whose normal is upright presses nothing."""
    part = Workpiece.from_loops("arch", [ARCH])
    fence = Fence((10, 42 - 4), 2, wall_offset=4, directions=["-x", "-y"])
    for way in fence.ways:
        search = WallSearch(
            Problem.from_query(Query(part, fence.with_fields({"directions": way.directions})))
        )
        tops = [
            p
            for e in search.edges
            for found in search.iterate_fixtures(e)
            for p in found.locator.tolist()
            if e == 0
        ]
        assert all(abs(v - 42.0) > 1e-9 for _, v in tops)
        assert not search.undecided
        laid, standing = lay_part_on_wall(search.problem, 0), search.problem.standing
        places = search.find_contacts_on_rows(0, laid, standing, search.list_row_heights(laid, standing))
        top = places.point[:, 1] > 41.9
        assert top.any() and (np.abs(places.normal[top, 0]) < 1e-12).all() and (places.reach < 1e-6).all()


def test_a_line_that_misses_an_arc_has_no_contact() -> None:
    """What the search would never ask."""
    part = Workpiece.from_loops("arch", [ARCH])
    problem = Problem.from_query(Query(part, Fence(10, 2, wall_offset=5, directions=["-x"])))
    arc = int(np.flatnonzero(problem.rows[:, 0] != 0.0)[0])
    far = WallCandidate(edge=0, row=9, line=1, is_upright=False, features=(arc, arc), branches=(-1.0, 1.0))
    assert is_pressing(far, problem, problem.toolkit.carriers[0], (-1.0, 0.0)) is False


def test_sides_are_numbered_through_all_loops() -> None:
    """Each is given by the vertices at its ends; those of a hole come after those of the outside."""
    part = Workpiece.from_loops("part", [KITE, [[20, 15, 0], [20, 25, 0], [30, 25, 0]]])
    ends = [find_drawn_segment(part, number) for number in range(7)]
    loops = [[tuple(vertex) for vertex in loop.tolist()] for loop in part.loops]
    assert ends == [
        (one, other) for loop in loops for one, other in zip(loop, loop[1:] + loop[:1], strict=True)
    ]
    with pytest.raises(IndexError):
        find_drawn_segment(part, 7)
