"""What a drawing meets exactly is decided: every rule's edge stands a hair of 1e-9 mm off.

A part with sides of slope 3/4 between four pegs of radius 5, all in whole numbers: every contact is exact, and one thing at
a time is moved by parts of a hair.
"""

from __future__ import annotations

from math import atan2, tan

import attrs
import pytest

from fixture_sets import Judge, listed
from workhold import Fixture, Peg, Pose, Vise, Workpiece, design
from workhold.verification import Ruling, verify_fixture

Loop = list[list[float]]

VISE = Vise(pitch=20, columns=1, peg_radius=5)
# Pegs at (0, 0), (0, 20), (40, 0) and (40, 20) push with equal forces at a slope of 4/3; their feet are (3, 4), (3, 16),
# (37, 4) and (37, 16).
UPPER: Loop = [[41, 7, 0], [41, 13, 0], [29, 22, 0], [11, 22, 0], [-1, 13, 0], [-1, 7, 0]]
PLAIN: Loop = [[11, -2, 0], [29, -2, 0], *UPPER]


def part(loop: Loop) -> Workpiece:
    """A part; its last segments are those from (-1, 13) and from (-1, 7)."""
    return Workpiece.from_loops("part", [loop])


def fixture(count: int, first: int | None = None) -> Fixture:
    """The fixture on a part of ``count`` vertices; its first peg is on face ``first`` instead of the last one."""
    faces = (count - 1 if first is None else first, count - 3, count - 7, count - 5)
    places = (
        ("left", 0, 0.0, 0.0),
        ("left", 1, 0.0, 20.0),
        ("right", 0, 40.0, 0.0),
        ("right", 1, 40.0, 20.0),
    )
    pegs = [Peg(jaw, 0, row, x, y, face, 5 / 6) for (jaw, row, x, y), face in zip(places, faces, strict=True)]  # type: ignore[arg-type]
    return Fixture("I", tuple(pegs), Pose(0.0, 0.0, 0.0), 40.0, {"closure_margin": 0.25})  # type: ignore[arg-type]


def ruling(loop: Loop, first: int | None = None, vise: Vise = VISE) -> Ruling:
    """The ruling on the fixture."""
    return verify_fixture(fixture(len(loop), first), part(loop), vise)


def is_listed(loop: Loop) -> bool:
    """Whether the search lists the fixture, on whatever faces."""
    workpiece = part(loop)
    result = design(workpiece, VISE, types=("I",))
    return (
        any(
            abs(f.pose.theta_deg) < 1e-6 and abs(f.pose.x) + abs(f.pose.y) + abs(f.jaw_separation - 40) < 1e-6
            for f in result
            if [peg.row for peg in f.pegs] == [0, 1, 0, 1]
        )
        and Judge(workpiece, VISE).check(listed(result)[0])[0] == []
    )


def along(far: float) -> list[float]:
    """The point of the first peg's face a length in mm below its foot."""
    return [3 + 0.8 * far, 4 - 0.6 * far]


def cornered(far: float) -> Loop:
    """The first peg's face ends at a convex corner, ``far`` mm past the foot."""
    return [[*along(far), 0], [29, -2, 0], *UPPER]


def rounded(far: float) -> Loop:
    """The first peg's face ends at a joint with an arc tangent to it, ``far`` mm past the foot."""
    x, y = along(far)
    half_sweep = atan2(-2 - y, 29 - x) - atan2(-3, 4)
    return [[x, y, tan(half_sweep / 2)], [29, -2, 0], *UPPER]


def wedged(far: float) -> Loop:
    """The peg comes to touch a level face as well where its own face is trimmed, ``far`` mm past the foot."""
    level = -5 - 0.6 * far
    return [
        [(25 - 4 * level) / 3, level, 0],
        [-20, level, 0],
        [-20, -15, 0],
        [29, -15, 0],
        [29, -2, 0],
        *UPPER,
    ]


def slotted(wide: float) -> Loop:
    """The peg is in a slot, ``wide`` mm wider than itself."""
    x, y = -0.6 * wide, -0.8 * wide
    slot = [[11, -2, 0], [5 + x, -10 + y, 0], [-11 + x, 2 + y, 0], [-14, -2, 0], [2, -14, 0], [29, -14, 0]]
    return [*slot, [29, -2, 0], *UPPER]


def test_the_fixture_holds() -> None:
    assert ruling(PLAIN).verdict == "proven"
    assert is_listed(PLAIN)


@pytest.mark.parametrize(
    ("short", "verdict"), [(0.0, "proven"), (5e-10, "proven"), (2e-9, "refuted"), (1e-3, "refuted")]
)
def test_gaps(short: float, verdict: str) -> None:
    """A gap met exactly is met; one short by more than a hair is not."""
    assert ruling(PLAIN, vise=attrs.evolve(VISE, min_gap=40 + short)).verdict == verdict
    assert ruling(PLAIN, vise=attrs.evolve(VISE, max_opening=40 - short)).verdict == verdict


@pytest.mark.parametrize(
    ("far", "verdict"), [(0.0, "refuted"), (5e-10, "refuted"), (2e-9, "proven"), (-2e-9, "refuted")]
)
def test_a_corner(far: float, verdict: str) -> None:
    """The contact must be more than a hair inside."""
    outcome = ruling(cornered(far))
    assert outcome.verdict == verdict
    assert outcome.bits == 128
    assert verdict == "proven" or "peg 1 " in outcome.reason
    assert is_listed(cornered(far)) == (verdict == "proven")


@pytest.mark.parametrize(
    ("far", "verdict"), [(0.0, "proven"), (-5e-10, "proven"), (-2e-9, "refuted"), (2e-9, "proven")]
)
def test_a_tangent_joint(far: float, verdict: str) -> None:
    """The contact may be up to a hair past the end; then the peg is on the other face as well."""
    loop = rounded(far)
    assert ruling(loop).verdict == verdict
    assert ruling(loop, first=0).verdict == ("proven" if far < 1e-9 else "refuted")
    assert is_listed(loop)


@pytest.mark.parametrize(
    ("far", "verdict"), [(0.0, "refuted"), (5e-10, "refuted"), (2e-9, "proven"), (-2e-9, "refuted")]
)
def test_a_wedge(far: float, verdict: str) -> None:
    """A peg that touches two faces at once is at the end of a trimmed feature: it must be more than a hair from there."""
    outcome = ruling(wedged(far))
    assert outcome.verdict == verdict
    assert verdict == "proven" or "segment 0" in outcome.reason
    assert is_listed(wedged(far)) == (verdict == "proven")


@pytest.mark.parametrize(
    ("wide", "verdict"), [(0.0, "proven"), (-5e-10, "proven"), (-2e-9, "refuted"), (1e-3, "proven")]
)
def test_a_slot_as_wide_as_the_peg(wide: float, verdict: str) -> None:
    """The peg may enter a face that runs alongside its own by a hair."""
    assert ruling(slotted(wide)).verdict == verdict
    assert is_listed(slotted(wide)) == (verdict == "proven")


@pytest.mark.parametrize(
    ("margin", "verdict"), [(3.0, "proven"), (3.0 - 2e-9, "proven"), (3.0 + 2e-9, "refuted")]
)
def test_margins_to_corners_and_to_wedges(margin: float, verdict: str) -> None:
    """Exactly the margin from such an end is far enough: at least means at least."""
    for loop in (cornered(3.0), wedged(3.0)):
        outcome = verify_fixture(fixture(len(loop)), part(loop), VISE, margin)
        assert outcome.verdict == verdict
        assert verdict == "proven" or "nearer than 3 mm to the end of its feature" in outcome.reason


@pytest.mark.parametrize(
    ("margin", "verdict"), [(3.0, "proven"), (3.0 + 5e-10, "proven"), (3.0 + 2e-9, "refuted")]
)
def test_margins_to_tangent_joints(margin: float, verdict: str) -> None:
    """Exactly the margin from a tangent joint is far enough."""
    loop = rounded(3.0)
    assert verify_fixture(fixture(len(loop)), part(loop), VISE, margin).verdict == verdict


def test_a_margin_in_a_slot_as_wide_as_the_peg() -> None:
    """The peg touches both walls as far as they go; beyond, the nearest point of a wall is its end."""
    loop = slotted(0.0)
    assert verify_fixture(fixture(len(loop)), part(loop), VISE, 3.0).verdict == "proven"
    assert verify_fixture(fixture(len(loop)), part(loop), VISE, 4.9).verdict == "proven"
    assert verify_fixture(fixture(len(loop)), part(loop), VISE, 5.1).verdict == "refuted"
