"""Bounds that are met exactly, as whole numbers meet them: "at least" means at least, to within a hair.

Listed under a restriction is just what is listed without any and keeps it, told of each fixture by itself (``bounds``).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import asin, pi, sqrt, tan
from random import Random
from typing import Any

import pytest
from test_restrictions import identities

from bounds import WITHIN, avoids, clear_of_box, clear_of_circle, keeps_margin, lies_within
from workhold import (
    Fence,
    Fixture,
    InputError,
    OpeningVise,
    Plate,
    Query,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    answer,
    circle_zone,
    design,
    polygon_zone,
)
from workhold.algebra import find_fixtures_by_algebra
from workhold.verification import verify, verify_fixture

Loop = list[tuple[float, ...]]
Keeps = Callable[..., bool]
L: Loop = [(0, 0), (60, 0), (60, 20), (20, 20), (20, 50), (0, 50)]
SQUARE: Loop = [(0, 0), (100, 0), (100, 60), (0, 60)]
# Straight below, a half circle on the right: both joints are tangent.
ROUND: Loop = [(0, 0), (40, 0, 1), (40, 24), (0, 24)]
EAR: Loop = [(0, 0), (50, 0), (50, 14), (40, 14), (40, 24, 1), (20, 24), (20, 14), (0, 14)]
KITS: dict[str, Any] = {
    "vise": Vise(pitch=10, columns=2, peg_radius=3),
    "opening": OpeningVise(pitch=10, columns=2, peg_radius=3, min_gap=6),
    "plate": Plate(20, 3, columns=5, rows=4),
    "wide tip": Plate(20, 3, columns=4, rows=4, clamp_radius=5, directions=["-x"]),
    "fence": Fence(10, 3, wall_offset=10, columns=8, rows=6),
    "two clamps": Plate(20, 3, columns=4, rows=4, clamps=2),
    "two on a fence": Fence(10, 3, wall_offset=5, columns=8, rows=6, clamps=2),
}


def drawn(loop: Loop) -> Workpiece:
    """A part of one loop, whose bulges are 0 if not given."""
    return Workpiece.from_loops("part", [[(*vertex, 0.0)[:3] for vertex in loop]])


def asked(part: Workpiece, kit: Any, **limits: Any) -> Result:
    """Every fixture, of two clamps every pair."""
    listing = "all" if getattr(kit, "clamps", 1) == 2 else None
    return design(part, kit, listing=listing, **limits)


@cache
def everything(vertices: tuple[tuple[float, ...], ...], kit: str) -> Result:
    """Every fixture of a part without a restriction."""
    return asked(drawn(list(vertices)), KITS[kit])


def identity(fixture: Fixture) -> tuple[Any, ...]:
    """A fixture by its holes and pose, from the first peg; of a contact at a joint another face may be told."""
    first = fixture.pegs[0]
    holes = [(p.carrier, p.column - first.column, p.row - first.row) for p in fixture.pegs]
    x, y = fixture.pose.x - first.x, fixture.pose.y - first.y
    return (
        fixture.type,
        fixture.direction,
        *holes,
        *(round(v, 4) + 0.0 for v in (fixture.pose.theta_deg % 360, x, y)),
    )


def box_zone(box: tuple[float, float, float, float]) -> Restrictions:
    """A zone from (x0, y0) to (x1, y1)."""
    x0, y0, x1, y1 = box
    return Restrictions(zones=(polygon_zone([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]),))


def margin(size: float) -> tuple[dict[str, Any], Keeps]:
    """A contact margin, and who keeps it."""
    return {"contact_margin": size}, lambda f, r, w: keeps_margin(f, r, size, w)


def box(*corners: float) -> tuple[dict[str, Any], Keeps]:
    """A keep-out box, and who keeps clear of it."""
    return {"restrictions": box_zone(corners)}, lambda f, r, w: clear_of_box(f, r, corners, w)  # type: ignore[arg-type]


def circle(x: float, y: float, radius: float) -> tuple[dict[str, Any], Keeps]:
    """A keep-out circle, and who keeps clear of it."""
    zone = Restrictions(zones=(circle_zone(x, y, radius),))
    return {"restrictions": zone}, lambda f, r, w: clear_of_circle(f, r, (x, y, radius), w)


def angle(low: float, high: float) -> tuple[dict[str, Any], Keeps]:
    """A range of angles, and who lies in it."""
    return {"restrictions": Restrictions(angles=((low, high),))}, lambda f, r, w: lies_within(
        f, (low, high), w
    )


def avoid(*faces: int) -> tuple[dict[str, Any], Keeps]:
    """Faces to avoid, and who does."""
    return {"restrictions": Restrictions(avoid=faces)}, lambda f, r, w: avoids(f, r, faces, w)


def both(
    one: tuple[dict[str, Any], Keeps], other: tuple[dict[str, Any], Keeps]
) -> tuple[dict[str, Any], Keeps]:
    """Two restrictions at once."""
    return {**one[0], **other[0]}, lambda f, r, w: one[1](f, r, w) and other[1](f, r, w)


def assert_kept(vertices: Loop, kit: str, restriction: tuple[dict[str, Any], Keeps]) -> tuple[Result, int]:
    """What is listed under a restriction keeps it, and nothing that keeps it is lost; how many are at its edge."""
    limits, keeps = restriction
    full = everything(tuple(vertices), kit)
    chosen = [keeps(fixture, full, WITHIN) for fixture in full]
    try:
        result = asked(full.workpiece, KITS[kit], **limits)
    except InputError:
        assert not any(chosen)
        return full.take([]) if hasattr(full, "take") else full, 0
    assert result.proof is not None and result.proof.undecided == ()
    if full.toolkit.symmetries and result.query.restrictions.angles:
        # The half turn that swaps the jaws may be listed in its place.
        assert identities(result) == identities(full, chosen)
    else:
        kept = [identity(fixture) for fixture, is_kept in zip(full, chosen, strict=True) if is_kept]
        assert sorted(map(identity, result), key=str) == sorted(kept, key=str)
    return result, sum(chosen) - sum(keeps(fixture, full, -WITHIN) for fixture in full)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("loop", "kit", "restriction", "at_edge"),
    [
        (L, "vise", margin(1), True),
        (L, "vise", both(box(10, -20, 30, -3), margin(3)), True),
        (L, "vise", angle(0, 45), False),
        (EAR, "opening", margin(1), False),
        (L, "plate", margin(1), True),
        (L, "plate", both(box(23, 23, 40, 40), margin(1)), True),
        (L, "wide tip", margin(3), True),
        (L, "fence", both(box(10, -40, 30, -3), margin(1)), False),
        (ROUND, "two clamps", margin(3), True),
        (ROUND, "two clamps", both(box(-16, 10, -6, 24), margin(1)), True),
        (ROUND, "two clamps", angle(90, 180), True),
        (ROUND, "two clamps", avoid(0), True),
        # A tip stands at the middle of the circle.
        (ROUND, "two on a fence", circle(20, 27, 7), False),
    ],
)
def test_a_bound_that_is_met_is_kept(
    loop: Loop, kit: str, restriction: tuple[dict[str, Any], Keeps], at_edge: bool
) -> None:
    """In every kind of toolkit, with fixtures at the edge of the bound; and verification agrees."""
    result, count = assert_kept(loop, kit, restriction)
    assert (count > 0) == at_edge
    verdict = verify(result)
    assert (verdict.refuted, verdict.undecided, verdict.faults) == (0, 0, ())


def assert_proven(result: Result) -> None:
    """Verification proves each fixture and finds no fault."""
    verdict = verify(result)
    assert (verdict.unproven, verdict.faults) == ((), ())


def lollipop(short: float) -> Workpiece:
    """A disc of radius 17 on a stick with a foot, square to the plate with its top so far in mm above a row's tips."""
    turn, neck = tan((pi - asin(10 / 17)) / 2), -sqrt(17.0**2 - 10.0**2)
    low = -97.0 - short
    foot = [(-10.0, low, 0.0), (40.0, low, 0.0), (40.0, -90.0, 0.0), (10.0, -90.0, 0.0)]
    return Workpiece.from_loops("lollipop", [[*foot, (10.0, neck, turn), (-10.0, neck, 0.0)]])


@pytest.mark.thorough
@pytest.mark.parametrize(("short", "grazes"), [(9.604e-12, False), (1.0404e-11, True)])
def test_a_clamp_that_grazes_an_arc_is_none(short: float, grazes: bool) -> None:
    """A tip beside the top of the disc pushes with a share of sqrt(short / 10), 9.8e-7 and 1.02e-6: above 1e-6 it is one."""
    plate = Plate(20, 3, columns=4, rows=7, clamps=2, directions=[("-x", "-x")])
    result = design(lollipop(short), plate, listing="all", restrictions=Restrictions(angles=((0.0, 0.0),)))
    most = [
        max(abs(force) for pair in f.pair.reactions for force in pair) for f in result if f.pair is not None
    ]
    # A locator under the foot takes up the clamp's whole push, those beside it a couple that may be larger.
    assert len(most) > 20 and max(most) < 1e6
    assert (max(most) > 4e5) == grazes
    assert_proven(result)
    # The same holes and faces, with the disc a hair lower: verification refuses by itself what no search lists.
    if grazes:
        fixture = result[most.index(max(most))]
        ruling = verify_fixture(fixture, result.workpiece, plate)
        assert "does not push" not in ruling.reason
        ruling = verify_fixture(fixture, lollipop(9.604e-12), plate)
        assert ruling.verdict == "refuted" and "does not push the part: its share is 9.8" in ruling.reason


def whole_part(random: Random) -> Loop:
    """A rectangle, L, T or D of whole numbers."""
    w, h = random.randrange(40, 76, 2), random.randrange(30, 56, 2)
    a, b = random.randrange(10, w - 20, 2), random.randrange(10, h - 12, 2)
    return random.choice(
        [
            [(0, 0), (w, 0), (w, h), (0, h)],
            [(0, 0), (w, 0), (w, b), (a, b), (a, h), (0, h)],
            [(0, 0), (w, 0), (w, b), (a + 14, b), (a + 14, h), (a, h), (a, b), (0, b)],
            [(0, 0), (w, 0, 1), (w, h), (0, h)],
        ]
    )


@pytest.mark.prove
@pytest.mark.parametrize(
    "kit", ["vise", "opening", "plate", "wide tip", "fence", "two clamps", "two on a fence"]
)
@pytest.mark.parametrize("seed", range(8))
def test_parts_of_whole_numbers_under_every_restriction(seed: int, kit: str) -> None:
    """As above, for eight restrictions each."""
    random = Random(seed)
    loop = whole_part(random)
    x, y, size = random.randrange(0, 40, 2), random.randrange(-20, 40, 2), random.randrange(4, 20)
    for restriction in (
        margin(1),
        margin(random.randrange(2, 8)),
        box(x, y, x + size, y + size),
        both(box(x, y, x + size, y + size), margin(random.randrange(1, 5))),
        circle(x, y, size),
        angle(0, 90),
        angle(90, 270),
        avoid(random.randrange(4)),
    ):
        assert_kept(loop, kit, restriction)


@pytest.mark.thorough
def test_the_algebra_takes_the_same_bounds() -> None:
    """A margin that is met exactly, in the second engine."""
    query = Query(drawn(L), Vise(pitch=20, columns=2, peg_radius=3), contact_margin=1.0)
    fast, slow = answer(query), find_fixtures_by_algebra(query)
    assert len(fast) > 0 and identities(fast) == identities(slow)


@pytest.mark.thorough
@pytest.mark.parametrize("kit", ["vise", "plate"])
def test_a_margin_counts_at_the_far_end_of_what_a_zone_leaves(kit: str) -> None:
    """A zone leaves a millimetre of a side at its corner: no contact there is a millimetre inside, however near the cut."""
    loop: Loop = [(0, 0), (60, 0), (60, 34), (0, 34)]
    result, _ = assert_kept(loop, kit, both(box(4, 32, 11, 39), margin(1)))
    assert len(result) > 0
    if kit == "vise":
        assert identities(find_fixtures_by_algebra(result.query)) == identities(result)
