"""Random queries of all kinds, each with a restriction whose edge is at a fixture: what is left is what keeps to it.

The edge is a hair to one side of a fixture of the free search, or to the other, so that
an inexact rule loses it or lets it in.
"""

from __future__ import annotations

from math import cos, hypot, inf, pi, radians, sin
from random import Random
from typing import Any

import pytest

from strategies import random_outline
from workhold import (
    Fence,
    Fixture,
    FlatJaw,
    InputError,
    OpeningVise,
    Plate,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    circle_zone,
    design,
)
from workhold.fixels.toolkit import Toolkit

Key = tuple[object, ...]
# Of degrees or mm: more than rules are loosened by.
HAIR = 1e-4
RANKINGS = (
    None,
    ["closure-margin"],
    ["edge-distance", "tilt"],
    ["location-error"],
    ["end-distance", "penalty"],
)


def random_toolkit(random: Random) -> Toolkit:
    """A toolkit of any kind, with a pitch of a third of a part or more."""
    pitch = random.choice([10.0, 12.5, 16.0])
    kind = random.randrange(6)
    if kind == 0:
        return Vise(pitch, random.choice([1, 2]), 3.0)
    if kind == 1:
        return OpeningVise(pitch=pitch, columns=2, peg_radius=2.0)
    if kind == 2:
        return Plate(pitch, 3.0, columns=3, rows=3, clamp_radius=4.0, directions=["-x", "+y"])
    if kind == 3:
        return Plate(pitch, 3.0, columns=3, rows=3, clamp_radius=4.0, directions=[("-x", "-y")], clamps=2)
    if kind == 4:
        return Fence(pitch=pitch, peg_radius=3.0, wall_offset=6.0, clamp_radius=4.0)
    return FlatJaw(pitch=pitch, columns=2, peg_radius=3.0)


def key_of(fixture: Fixture) -> Key:
    """A fixture, whichever way round its toolkit is listed: faces and places of its pegs on the part."""
    pegs = [(peg.face, round(x, 3) + 0.0, round(y, 3) + 0.0) for peg, (x, y) in on_part(fixture)]
    return fixture.type, tuple(sorted(pegs))


def on_part(fixture: Fixture) -> list[tuple[Any, tuple[float, float]]]:
    """Pegs and clamps, and their centres in the frame of the part."""
    angle = radians(fixture.pose.theta_deg)
    c, s = cos(angle), sin(angle)
    moved = [(peg, peg.x - fixture.pose.x, peg.y - fixture.pose.y) for peg in fixture.pegs]
    return [(peg, (c * x + s * y, c * y - s * x)) for peg, x, y in moved]


def in_range(theta: float, low: float, high: float) -> bool:
    """Whether an angle in degrees lies in a range that is not a turn."""
    return (theta - low) % 360.0 <= high - low


def lies(fixture: Fixture, low: float, high: float) -> bool:
    """Whether a fixture lies in a range of angles: where both jaws may be swapped, as it is or half round."""
    theta = fixture.pose.theta_deg
    return in_range(theta, low, high) or (fixture.type == "I" and in_range(theta + 180.0, low, high))


def restricted(random: Random, free: Result) -> tuple[dict[str, object], list[bool]]:
    """A restriction with its edge at a fixture of the free search, and which of all fixtures keep to it."""
    fixtures, toolkit = list(free), free.toolkit
    at, side = random.choice(fixtures), random.choice([-HAIR, HAIR])
    kind = random.randrange(4)
    is_round = not isinstance(toolkit, Fence | FlatJaw)
    margin = max(at.quality["end_distance"] + side, 0.0)
    if kind == 0 and is_round and margin <= half_circumference(free):
        return {"contact_margin": margin}, [f.quality["end_distance"] >= margin for f in fixtures]
    if kind == 1 and is_round:
        random_peg, (x, y) = random.choice(on_part(at))
        away = random.uniform(4.0, 20.0)
        center = (x + away, y)
        size = away - radius_of(random_peg, toolkit) + side
        if size > 0.5:
            zones = (circle_zone(*center, size),)
            chosen = [
                all(
                    hypot(u - center[0], v - center[1]) >= size + radius_of(peg, toolkit)
                    for peg, (u, v) in on_part(f)
                )
                for f in fixtures
            ]
            return {"restrictions": Restrictions(zones=zones)}, chosen
    if kind == 2 and is_round:
        avoid = tuple(sorted({peg.face for peg in random.sample(list(at.pegs), 2)}))
        chosen = [not any(peg.face in avoid for peg in f.pegs) for f in fixtures]
        return {"restrictions": Restrictions(avoid=avoid)}, chosen
    low = at.pose.theta_deg + side
    high = low + random.uniform(1.0, 170.0)
    return {"restrictions": Restrictions(angles=((low, high),))}, [lies(f, low, high) for f in fixtures]


def half_circumference(free: Result) -> float:
    """The least end distance in mm of a peg in a bore, which has no end: beyond it none but the figure is smaller."""
    radii = [hypot(x - u, y - v) / 2 for (x, y, _), (u, v, _) in filter(is_bore, free.workpiece.loops)]
    pegs = [carrier.peg_radius for carrier in free.toolkit.carriers]
    return min((pi * (radius - peg) for radius in radii for peg in pegs if radius > peg), default=inf)


def is_bore(loop: Any) -> bool:
    """Whether a loop is a circle of two halves."""
    return len(loop) == 2 and all(abs(bulge) == 1.0 for _, _, bulge in loop)


def radius_of(peg: Any, toolkit: Toolkit) -> float:
    """Of a peg or of the clamp's tip, in mm."""
    is_tip = isinstance(toolkit, Plate) and peg.carrier != "plate"
    return float(toolkit.clamp_radius if is_tip else toolkit.peg_radius)


def differences(seed: int) -> list[str]:
    """What is wrong with a random query: with what a restriction leaves, and with the best of that."""
    random = Random(seed)
    part, toolkit = random_outline(random, random.choice([3, 4, 5, 6])), random_toolkit(random)
    asked: dict[str, object] = {"threads": 1}
    if isinstance(toolkit, Plate) and toolkit.clamps == 2:
        asked["listing"] = "all"
    free = design(part, toolkit, **asked)  # type: ignore[arg-type]
    if not 0 < len(free) < MOST:
        return []
    limits, chosen = restricted(random, free)
    expected = sorted(key_of(f) for f, is_chosen in zip(free, chosen, strict=True) if is_chosen)
    ranking, most = random.choice(RANKINGS), random.choice([1, 5, 20])
    try:
        limited = design(part, toolkit, rank_by=ranking, **limits, **asked)  # type: ignore[arg-type]
        best = design(part, toolkit, rank_by=ranking, best=most, **limits, **asked)  # type: ignore[arg-type]
    except InputError:
        return [f"{seed}: nothing is left of {len(expected)}"] if expected else []
    found, out = sorted(map(key_of, limited)), list[str]()
    if found != expected:
        out.append(f"{seed}: {toolkit} {limits}: {set(expected) ^ set(found)}")
    for one, whole in zip(best.table.columns, limited.table.columns, strict=True):
        if one.tobytes() != whole[:most].tobytes():
            out.append(f"{seed}: the best {most} of {toolkit} by {ranking} are not the first")
            break
    return out


# Larger lists take long to go through.
MOST = 1500


@pytest.mark.thorough
@pytest.mark.parametrize("block", [0, *(pytest.param(k, marks=pytest.mark.prove) for k in range(1, 200))])
def test_restrictions_leave_what_keeps_to_them_and_the_best_are_the_first(block: int) -> None:
    assert [line for seed in range(50 * block, 50 * (block + 1)) for line in differences(seed)] == []


def test_no_margin_rules_a_bore_out() -> None:
    """A whole circle has no end: half its circumference is a figure that no rule asks for."""
    outline = [(0.0, 0.0, 0.0), (80.0, 0.0, 0.0), (80.0, 60.0, 0.0), (0.0, 60.0, 0.0)]
    bored = Workpiece.from_loops("bored", [outline, [(35.0, 33.0, 1.0), (45.0, 33.0, 1.0)]])
    plate = Plate(20.0, 3.0, clamp_radius=3.0, directions=["-x"])
    free, limited = (design(bored, plate, contact_margin=margin) for margin in (0.0, 7.0))
    in_bore = {key_of(f) for f in limited if any(peg.face == 4 for peg in f.pegs)}
    assert half_circumference(free) == pytest.approx(2 * pi)
    assert in_bore and in_bore < {key_of(f) for f in free}
    assert all(f.quality["end_distance"] == pytest.approx(2 * pi) for f in limited if key_of(f) in in_bore)
