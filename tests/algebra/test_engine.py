"""The paper's algebra lists the same fixtures as the chord-curve search."""

from __future__ import annotations

import json
from math import cos, pi, sin, sqrt, tan
from pathlib import Path
from random import Random
from threading import Event

import pytest

from fixture_sets import Judge, assert_same, listed, vise_of
from strategies import star, straightened
from workhold import Query, Result, Vise, Workpiece, design
from workhold.algebra import find_fixtures_by_algebra

COMPLETE = Path(__file__).parent.parent / "data" / "complete"
QUARTER = tan(pi / 8)


def assert_engines_agree(workpiece: Workpiece, vise: Vise) -> int:
    """Both engines list the same fixtures, nothing is left undecided; how many fixtures that is."""
    ours = find_fixtures_by_algebra(Query(workpiece, vise))
    assert_search_agrees(ours)
    return len(ours)


def assert_search_agrees(ours: Result) -> None:
    """The search lists the fixtures of the algebra, which left nothing undecided."""
    assert ours.complete
    assert ours.statistics["undecided"] == 0
    theirs = design(ours.workpiece, ours.toolkit)
    assert_same(listed(ours), listed(theirs), Judge(ours.workpiece, ours.toolkit))


def rounded(width: float, height: float, radius: float, angle: float) -> Workpiece:
    """A rounded rectangle, its fillets' centres ``width`` and ``height`` apart, turned by an angle in radians."""
    w, h, r, q = width / 2, height / 2, radius, QUARTER
    loop = [(-w, -h - r, 0), (w, -h - r, q), (w + r, -h, 0), (w + r, h, q)]
    loop += [(w, h + r, 0), (-w, h + r, q), (-w - r, h, 0), (-w - r, -h, q)]
    turned = [[cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y, b] for x, y, b in loop]
    return Workpiece.from_loops("rounded", [turned])


@pytest.mark.thorough
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("triangle_20_2", marks=pytest.mark.prove),
        pytest.param("oblongPart_10_1", marks=pytest.mark.prove),
        "opening_saddle_9_2_gap5",
    ],
)
def test_complete_sets(name: str) -> None:
    """The engine lists what an independent method found, apart from marginal fixtures."""
    truth = json.loads((COMPLETE / f"{name}.json").read_text())
    workpiece = Workpiece.from_loops(name, truth["workpiece"]["loops"])
    vise = vise_of(truth)
    judge = Judge(workpiece, vise)
    ours = find_fixtures_by_algebra(Query(workpiece, vise))
    have = [judge.identity(fixture) for fixture in listed(ours)]
    for fixture in truth["fixtures"]:
        key, theta, _ = judge.identity(
            fixture | {"pose": {"theta_deg": fixture["theta_deg"], "x": 0.0, "y": 0.0}}
        )
        near = [t for k, t, _ in have if k == key and abs((theta - t + 3) % (2 * pi) - 3) < 1e-5]
        assert len(near) == 1 or fixture["marginal"]
    assert_search_agrees(ours)
    assert len(ours) > 0


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_parts(seed: int) -> None:
    """Parts of three and four faces, lines and arcs, jaws with rows at different heights."""
    part = straightened(star(Random(seed), 3 + seed % 2, True))
    assert part is not None
    assert (
        assert_engines_agree(
            part, Vise(pitch=24.0, columns=1 + seed % 2, peg_radius=2.0, row_offset=1.7 * seed)
        )
        > 0
    )


@pytest.mark.thorough
@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_equal_arcs_one_step_apart_and_parallel_lines(angle: float) -> None:
    """Fillets whose centres are lattice steps apart slide: that orientation is found apart from the resultants."""
    assert (
        assert_engines_agree(rounded(20.0, 20.0, 6.0, angle), Vise(pitch=10.0, columns=2, peg_radius=2.0)) > 0
    )


@pytest.mark.thorough
@pytest.mark.parametrize("miss", [1e-3, 1e-6])
def test_nearly_equal_steps(miss: float) -> None:
    """Centres almost a step apart crowd up to eight roots together; ball arithmetic takes them apart."""
    assert (
        assert_engines_agree(
            rounded(20.0 + miss, 20.0, 6.0, 0.0), Vise(pitch=10.0, columns=1, peg_radius=2.0)
        )
        > 0
    )


def bumps(width: float, smaller: float, tilt: float) -> Workpiece:
    """Two fillets of radius 6, their centres ``width`` apart, one ``smaller``; two lines ``tilt`` off being parallel."""
    radius = 6.0 - smaller
    loop = [
        [-6, 0, QUARTER],
        [0, -6, 0],
        [width - radius, 0, QUARTER],
        [width, -radius, 0],
        [38, 3, 0],
        [31, 27, 0],
    ]
    return Workpiece.from_loops("bumps", [[*loop, [-6, 27 + 37 * tilt, 0]]])


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("misfit", "smaller"),
    [
        (1e-12, 0.0),
        (-2e-8, 0.0),
        (1e-6, 0.0),
        *(
            pytest.param(*one, marks=pytest.mark.prove)
            for one in ((0.0, 2e-8), (0.0, 1e-10), (3e-9, 0.0), (1e-7, 1e-7))
        ),
    ],
)
def test_pairs_that_nearly_slide(misfit: float, smaller: float) -> None:
    """Between a pair that slides and one that clearly does not nothing is lost: not by what is divided out of a resultant,
    nor by how far roots crowd together. The lines are out of parallel by as much as the arcs are out of step."""
    part = bumps(20.0 + misfit, smaller, max(abs(misfit), smaller) / 10.0)
    assert assert_engines_agree(part, Vise(pitch=10.0, columns=2, peg_radius=2.0)) > 0


@pytest.mark.thorough
def test_three_equal_arcs_that_all_slide() -> None:
    """Three left pegs on three equal arcs, each pair of centres one step apart."""
    radius, half = 20.0 / sqrt(3.0), pi / 3
    loop = []
    for k in range(3):
        for side in (-1, 1):
            direction = 2 * k * half + side * half
            x = radius * cos(2 * k * half) + 7.0 * cos(direction)
            y = radius * sin(2 * k * half) + 7.0 * sin(direction)
            loop.append([x, y, tan(half / 2) if side < 0 else 0.0])
    part = Workpiece.from_loops("three", [loop])
    assert assert_engines_agree(part, Vise(pitch=(10.0, 10.0 * sqrt(3.0)), columns=3, peg_radius=2.0)) > 0


@pytest.mark.thorough
def test_concentric_arcs_and_a_whole_circle() -> None:
    """Three normals through one point never close: a disc has no fixture, a disc with a flat has."""
    vise = Vise(pitch=10.0, columns=2, peg_radius=2.0)
    assert (
        len(find_fixtures_by_algebra(Query(Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]]), vise)))
        == 0
    )
    assert assert_engines_agree(Workpiece.from_loops("half", [[[-20, 0, 0], [20, 0, 1]]]), vise) > 0


@pytest.mark.thorough
def test_options() -> None:
    """One type alone, a margin at the ends, and a cancelled search."""
    part, vise = rounded(30.0, 20.0, 6.0, 0.2), Vise(pitch=10.0, columns=2, peg_radius=2.0)
    ours = find_fixtures_by_algebra(Query(part, vise, "II", contact_margin=1.0))
    theirs = design(part, vise, types=("II",), contact_margin=1.0)
    assert ours.counts == theirs.counts
    cancel = Event()
    cancel.set()
    assert not find_fixtures_by_algebra(Query(part, vise), cancel=cancel).complete


@pytest.mark.thorough
def test_double_contacts_are_no_fixtures() -> None:
    """Two pegs exactly as far apart as the tips of a pill touch it doubly: their lines of action are one, nothing closes."""
    pill = Workpiece.from_loops("pill", [[[0, -8, 0], [30, -8, 1], [30, 8, 0], [0, 8, 1]]])
    ours = find_fixtures_by_algebra(Query(pill, Vise(pitch=10.0, columns=2, peg_radius=2.0), "II"))
    assert ours.counts == {"I": 0, "II": 44}
