"""The usual order: the best K are the first K of all, ties included, and verification derives it anew."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

import pytest
from attrs import evolve
from test_random_restrictions import random_toolkit

import workhold
from cad_parts import cad_part
from strategies import random_outline
from workhold import FlatJaw, Plate, Query, Vise, answer
from workhold.fixels.toolkit import Toolkit
from workhold.listing import collector
from workhold.search import lattice_shares, shares

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


@pytest.mark.parametrize("kind", TOOLKITS)
@pytest.mark.parametrize("number", [0, pytest.param(3, marks=pytest.mark.prove), 5])
def test_the_best_are_the_first_of_all(kind: str, number: int) -> None:
    """Of parts as they come out of CAD, in every kind of toolkit."""
    assert_first(Query(cad_part(number), TOOLKITS[kind]), (1, 2, 7, 20))


@pytest.mark.parametrize(
    "seed", [1, 2, 3, 4, *(pytest.param(seed, marks=pytest.mark.prove) for seed in range(5, 120))]
)
def test_the_best_are_the_first_of_all_of_random_parts(seed: int) -> None:
    """Random outlines and toolkits, with few orientations in a share."""
    random = Random(seed)
    part, toolkit = random_outline(random, random.choice([3, 4, 5, 6])), random_toolkit(random)
    assert_first(Query(part, toolkit), (1, 5, 20))
