"""A candidate's box is made smaller by the gap rule and by parallel lines, and no contact is lost by it."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, inf, pi, sin
from random import Random

import pytest
from attrs import evolve
from flint import ctx

from cad_parts import cad_part
from workhold import design
from workhold.files.toolkit_file import load_toolkit
from workhold.kernels.base.tables import Limits
from workhold.proof.ball_contacts import CandidateBox, narrow_box
from workhold.proof.interval_newton import PRECISIONS, BoxOutcome, find_solutions, narrow_to_contacts

GAP = 25.0
LIMITS = Limits(GAP, 0.0, 45.0, 2.0, 1.0, 0.0, 0.0)
TIGHT = 1e-9


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    """Balls of the first precision: products of two doubles are exact in it."""
    with ctx.workprec(PRECISIONS[0]):
        yield


def line(x: float, y: float, angle: float, half: float = 40.0) -> list[float]:
    """A line's row: its middle, its direction, and half of its length."""
    return [0.0, x, y, cos(angle), sin(angle), half, 0.0, 1.0, 0.0, 0.0, TIGHT, TIGHT]


def far_box(
    features: list[list[float]], offsets: list[tuple[float, float]], standing: int = 2
) -> CandidateBox:
    """A box as long as jaws open, and its turn known to a thousandth of a degree."""
    return CandidateBox(
        features, offsets, standing, (pi + 4e-6, 45.0, 0.0, 25.0), (1e-5, 300.0, 300.0, 500.0)
    )


ROW = [(0.0, 0.0), (25.0, -25.0), (0.0, -25.0), (25.0, 25.0)]


def features(angle: float = 0.0) -> list[list[float]]:
    """Four lines: the second and third contact touch one line, the others are at angles to it and to each other."""
    same = line(0.0, 25.0, angle)
    return [line(40.0, 0.0, 1.0), same, same, line(-40.0, 0.0, -1.3)]


def test_the_gap_rule_bounds_the_separation() -> None:
    """The least separation keeps the nearest pegs of both jaws the gap apart: the first moving one stands 25 mm back."""
    found = narrow_box(far_box(features(), ROW), LIMITS)
    assert found is not None
    low = found.middle[3] - found.reach[3]
    assert low == pytest.approx(25.0 + GAP, abs=1e-5) and low < 25.0 + GAP
    assert (
        found.middle[3] + found.reach[3] == pytest.approx(525.0, abs=1e-3)
        and found.middle[3] + found.reach[3] >= 525.0
    )


def test_two_pegs_in_one_row_on_one_line_leave_one_angle() -> None:
    """Beyond the gap two pegs of one row touch one line at its own angle alone, whatever the separation."""
    found = narrow_box(far_box(features(), ROW), LIMITS)
    assert found is not None
    assert abs(found.middle[0] - pi) < 1e-15 and found.reach[0] < 1e-15


def test_the_other_unknowns_stay() -> None:
    """Where the part is remains as it was, and so does what a box is of."""
    box = far_box(features(), ROW)
    found = narrow_box(box, LIMITS)
    assert found is not None
    assert found.middle[1:3] == box.middle[1:3] and found.reach[1:3] == box.reach[1:3]
    assert evolve(found, middle=box.middle, reach=box.reach) == box


def test_a_box_without_gap_or_parallel_lines_stays_as_it_is() -> None:
    """Nothing is known of it."""
    apart = [line(0.0, 25.0, k) for k in (0.0, 1.0, 2.0, 2.5)]
    box = far_box(apart, ROW)
    assert narrow_box(box, LIMITS._replace(gap=-inf)) is box


def test_a_box_that_breaks_the_gap_rule_or_meets_no_angle_is_empty() -> None:
    """Separations that are too small everywhere; and a turn at which one line is not met twice."""
    box = far_box(features(), ROW)
    near = evolve(box, middle=(*box.middle[:3], 20.0), reach=(*box.reach[:3], 29.0))
    assert narrow_box(near, LIMITS) is None
    assert narrow_box(evolve(near, reach=(*box.reach[:3], 30.1)), LIMITS) is not None
    turned = evolve(box, middle=(pi + 1e-4, *box.middle[1:]))
    assert narrow_box(turned, LIMITS) is None
    assert narrow_box(turned, LIMITS._replace(gap=-inf)) is not None


@pytest.mark.parametrize("seed", range(40))
def test_no_contact_is_lost(seed: int) -> None:
    """Boxes about a placed part whose pegs touch parallel lines keep the true psi and separation."""
    random = Random(seed)
    psi, x, y, separation = (
        random.uniform(-pi, pi),
        random.uniform(-9, 9),
        random.uniform(-9, 9),
        random.uniform(60, 90),
    )
    angle = random.uniform(-pi, pi)
    offsets = [
        (0.0, 0.0),
        (25.0, random.choice([0.0, 25.0])),
        (random.choice([0.0, 25.0]), -25.0),
        (0.0, 50.0),
    ]
    turns = random.sample([0.0, 0.0, pi, 1.0], 4)
    rows = []
    for k, (dx, dy) in enumerate(offsets):
        along = dx + (separation if k >= 2 else 0.0)
        center = x + cos(psi) * along - sin(psi) * dy, y + sin(psi) * along + cos(psi) * dy
        # Two lines of one direction, one the other way around, and an arc that begins as they do, or a line
        # at an angle, all through the peg's centre.
        rows.append(line(*center, angle))
        if turns[k] == pi:
            rows[k][3:5] = [-rows[k][3], -rows[k][4]]
        if turns[k] == 1.0 and seed % 2:
            rows[k][0], rows[k][6] = 1.0, 30.0
        elif turns[k] == 1.0:
            rows[k] = line(*center, angle + 1.0)
        # What a double leaves of the middle is given beside it.
        rest = random.uniform(-1e-3, 1e-3)
        rows[k][1], rows[k][8] = rows[k][1] - rest, rest
    reach = 10.0 ** random.uniform(-9, -2)
    off = [random.uniform(-1, 1) for _ in range(4)]
    middle = (psi + 0.9 * reach * off[0], x, y, separation + 20.0 * off[3])
    box = CandidateBox(rows, offsets, 2, middle, (reach, 50.0, 50.0, 20.0))
    found = narrow_box(box, LIMITS._replace(gap=random.choice([-inf, 5.0])))
    assert found is not None
    # Places are rounded to doubles, which turns pegs 25 mm apart by so much.
    assert abs(found.middle[0] - psi) <= found.reach[0] + 1e-13
    assert abs(found.middle[3] - separation) <= found.reach[3] + 1e-12
    assert found.reach[0] <= box.reach[0] * (1 + 1e-5)


def bound_placed_part(
    random: Random, reach: float
) -> tuple[CandidateBox, tuple[float, float, float, float], Limits]:
    """A box about three standing pegs and a moving one on lines and arcs, the place at which all touch, and limits
    by which the moving one pushes there."""
    psi, x, y, separation = (random.uniform(-end, end) for end in (pi, 9.0, 9.0, 40.0))
    offsets = [(0.0, 0.0), (120.0, 440.0), (720.0, 20.0), (40.0, 100.0)]
    rows, normal = [], 0.0
    for k, (dx, dy) in enumerate(offsets):
        along = dx + (separation if k == 3 else 0.0)
        center = x + cos(psi) * along - sin(psi) * dy, y + sin(psi) * along + cos(psi) * dy
        normal = random.uniform(-pi, pi)
        if random.random() < 0.5:
            rows.append(line(*center, normal + pi / 2))
        else:
            radius = random.uniform(4.0, 60.0)
            middle = center[0] - radius * cos(normal), center[1] - radius * sin(normal)
            rows.append([1.0, *middle, cos(normal), sin(normal), 1.5, radius, 1.0, 0.0, 0.0, TIGHT, TIGHT])
    true = (psi, x, y, separation)
    reaches = (reach, 400.0 * reach, 400.0 * reach, 900.0 * reach)
    middle = tuple(one + 0.9 * off * random.uniform(-1, 1) for one, off in zip(true, reaches, strict=True))
    asked = LIMITS._replace(gap=-inf, pairing=1.0, clamping=1.0 if cos(normal - psi) > 0.0 else -1.0)
    return CandidateBox(rows, offsets, 3, middle, reaches), true, asked  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(60))
def test_standing_pegs_lose_no_contact(seed: int) -> None:
    """The place at which three locators and a clamp touch stays in the box, which mostly shrinks to it."""
    random = Random(seed)
    box, true, asked = bound_placed_part(random, 10.0 ** random.uniform(-7, -2.5))
    found = narrow_to_contacts(box, asked)
    assert found is not None
    for one, middle, reach in zip(true, found.middle, found.reach, strict=True):
        assert abs(one - middle) <= reach + 1e-11


@pytest.mark.thorough
def test_standing_pegs_make_most_boxes_small() -> None:
    """A simple place of three locators is found to the last digits, whatever is known of the clamp."""
    small = 0
    for seed in range(60):
        random = Random(seed)
        box, true, asked = bound_placed_part(random, 1e-4)
        away = evolve(box, middle=(*box.middle[:3], true[3]), reach=(*box.reach[:3], 30.0))
        found = narrow_to_contacts(away, asked)
        assert found is not None
        small += max(found.reach[:3]) < 1e-9
    assert small >= 50


@pytest.mark.parametrize(("end", "row"), [((497.0, 297.0), -600.0), ((-497.0, 297.0), -600.0)])
def test_a_clamp_that_grazes_a_corner_beside_three_locators_is_decided(
    end: tuple[float, float], row: float
) -> None:
    """Three locators fix a large plate, one where a face goes over into a round corner; the clamp slides along
    another corner and never pushes."""
    rest = [0.0, 0.0, 1e-9, 1e-9]
    way = 0.5**0.5
    rows = [
        [0.0, 0.0, -303.0, 1.0, 0.0, 497.0, 0.0, 1.0, *rest],
        [0.0, -103.0, 0.0, 0.0, -1.0, 190.0, 0.0, 1.0, *rest],
        [1.0, 497.0, -297.0, way, -way, pi / 4, 6.0, 1.0, *rest],
        [1.0, *end, way * (1 if end[0] > 0 else -1), way, pi / 4, 8.0, 1.0, *rest],
    ]
    offsets = [(0.0, 0.0), (-120.0, -440.0), (-720.0, 0.0), (0.0, row)]
    middle = (pi, -223.0, -303.0, -720.0 if end[0] > 0 else 274.0)
    box = CandidateBox(rows, offsets, 3, middle, (6.65e-4, 21.8, 21.8, 45.0))
    assert find_solutions(box, LIMITS._replace(gap=-inf)) == BoxOutcome((), "")


def test_an_end_of_a_slot_whose_arc_and_line_are_tangent_is_decided() -> None:
    """Three pegs about a round end and one on the line that its arc goes over into: any separation touches."""
    result = design(cad_part(215), load_toolkit("plate-25mm").toolkit, best=1)
    assert result.proof is not None and result.proof.undecided == ()
