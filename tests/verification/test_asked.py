"""A result is held to what it says was asked for: restrictions, figures of quality, order."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from math import cos, hypot, radians, sin
from typing import Any

import attrs
import numpy as np
import pytest

from workhold import Load, Restrictions, Result, Vise, circle_zone, design, load
from workhold.listing.ranking import find_usual_errors, make_table_keys
from workhold.model.first_choice import list_ranking_figures
from workhold.model.quality import FIGURES, fill_figure_rows
from workhold.verification import Verification, verify

Verify = Callable[[Callable[[dict[str, Any]], object]], Verification]


@pytest.fixture(scope="module")
def limited() -> Result:
    """The best fixtures of a search with everything that can be asked for."""
    vise = Vise(pitch=8, columns=2, peg_radius=3, body_radius=3.5, blocked=["R-B"])
    asked = Restrictions(avoid=(3,), zones=(circle_zone(40.0, 30.0, 4.0),), angles=((-80.0, 60.0),))
    return design(load("widget"), vise, restrictions=asked, loads=[Load(((10.0, 5.0),), 100.0)], best=10)


def test_what_a_search_lists_keeps_what_was_asked(limited: Result) -> None:
    """Nothing is refuted."""
    outcome = verify(limited)
    assert (outcome.proven, outcome.refuted, outcome.faults) == (len(limited), 0, ())


@pytest.mark.parametrize(
    ("restrictions", "words"),
    [
        (lambda r: Restrictions(avoid=(r[0].pegs[2].face,)), "which is to be avoided"),
        (
            lambda r: Restrictions(zones=(circle_zone(*r.workpiece.center, 500.0),)),
            "stands over a keep-out zone",
        ),
        (
            lambda r: Restrictions(angles=((r[0].pose.theta_deg + 0.01, r[0].pose.theta_deg + 1),)),
            "outside the angles",
        ),
    ],
)
def test_a_restriction_that_is_broken_refutes(limited: Result, restrictions: Any, words: str) -> None:
    """The first fixture was found under other restrictions."""
    outcome = verify(
        attrs.evolve(limited, query=attrs.evolve(limited.query, restrictions=restrictions(limited)))
    )
    assert any(item.index == 0 and words in item.reason for item in outcome.unproven)


def test_blocked_holes_and_bodies_are_looked_at(limited: Result) -> None:
    """A vise with a hole blocked that a peg stands in, and one with bodies as wide as the part."""
    hole = limited[0].pegs[3].hole

    def verified_in(**changes: Any) -> Verification:
        vise = attrs.evolve(limited.toolkit, **changes)
        return verify(attrs.evolve(limited, query=attrs.evolve(limited.query, toolkit=vise)))

    outcome = verified_in(blocked=[hole])
    assert any(f"stands in {hole}, which is blocked" in item.reason for item in outcome.unproven)
    outcome = verified_in(body_radius=200.0, blocked=[])
    assert any("overlap" in item.reason or "stands over" in item.reason for item in outcome.unproven)
    # They may touch, and not be wider by the least that counts.
    free = attrs.evolve(limited.query, restrictions=Restrictions())
    nearest = min(hypot(a.x - b.x, a.y - b.y) for a, b in combinations(limited[0].pegs, 2))
    for radius, words in ((nearest / 2 - 1e-5, ""), (nearest / 2 + 1e-5, "overlap")):
        vise = attrs.evolve(limited.toolkit, body_radius=radius, blocked=[])
        outcome = verify(attrs.evolve(limited, query=attrs.evolve(free, toolkit=vise)))
        found = [item.reason for item in outcome.unproven if item.index == 0]
        assert len(found) == bool(words) and all(words in reason for reason in found)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("number", range(len(FIGURES)))
def test_a_wrong_figure_refutes(limited: Result, number: int) -> None:
    """Each figure of quality is derived again."""
    quality = fill_figure_rows(limited.table.quality).copy()
    # A figure that such fixtures do not have is wrong whatever it is.
    quality[4, number] = np.nan_to_num(quality[4, number]) + 1e-6 * max(
        np.nan_to_num(quality[4, number]), 1.0
    )
    outcome = verify(attrs.evolve(limited, table=attrs.evolve(limited.table, quality=quality)))
    assert [item.index for item in outcome.unproven] == [4]
    assert FIGURES[number].words in outcome.unproven[0].reason


def test_a_wrong_order_is_a_fault(limited: Result) -> None:
    """The last before the first."""
    outcome = verify(attrs.evolve(limited, table=limited.table.take(slice(None, None, -1))))
    assert any("is better than the one before it" in fault for fault in outcome.faults)


@pytest.mark.parametrize(
    ("gap", "stands_over"), [(2.9, True), (3.2, True), (3.49, True), (3.51, False), (4.0, False)]
)
def test_keep_out_zones_are_for_the_bodies_of_pegs(limited: Result, gap: float, stands_over: bool) -> None:
    """Bodies of radius 3.5 on pegs of radius 3: a round zone whose rim is between 3 and 3.5 mm from a peg's centre lies
    under its body, though not under the peg."""
    fixture = limited[0]
    theta = radians(fixture.pose.theta_deg)
    turn = complex(cos(theta), sin(theta))
    places = [complex(peg.x - fixture.pose.x, peg.y - fixture.pose.y) / turn for peg in fixture.pegs]
    # Away from the part, and so from the other pegs, which stand around it.
    way = (places[0] - complex(*limited.workpiece.center)) / abs(
        places[0] - complex(*limited.workpiece.center)
    )
    center = places[0] + (gap + 0.5) * way
    zone = circle_zone(center.real, center.imag, 0.5)
    outcome = verify(
        attrs.evolve(limited, query=attrs.evolve(limited.query, restrictions=Restrictions(zones=(zone,))))
    )
    told = any(
        item.index == 0 and "peg 1 stands over a keep-out zone" in item.reason for item in outcome.unproven
    )
    assert told == stands_over


@pytest.mark.parametrize("place", range(9))
def test_two_neighbours_that_change_places(limited: Result, place: int) -> None:
    """It is a fault, unless they count as equal by all that they are ranked by."""
    order = np.arange(len(limited))
    order[[place, place + 1]] = place + 1, place
    query = limited.query
    keys = make_table_keys(limited.table, query, find_usual_errors(query))
    equal = np.array_equal(*np.round(keys.make_order_numbers(keys.least_error)[order[place:][:2]], 9))
    outcome = verify(attrs.evolve(limited, table=limited.table.take(order)))
    assert (outcome.faults == ()) == equal
    assert outcome.proven == len(limited)


def test_other_keys_to_rank_by_are_a_fault(limited: Result) -> None:
    """What is first by one figure is not by another."""
    for ranking in (
        ("closure_margin",),
        ("end_distance", "location_error"),
        tuple(reversed(list_ranking_figures(limited.query.rank_by))),
    ):
        outcome = verify(attrs.evolve(limited, query=attrs.evolve(limited.query, rank_by=ranking)))
        assert len(outcome.faults) == 1, ranking
        assert ", ".join(ranking) in outcome.faults[0]
