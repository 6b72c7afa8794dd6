"""Parts as they come out of CAD on the toolkits that people own: no fault, nothing undecided, and every word verified.

Their coincidences (concentric arcs, equal radii, a pitch that equals a dimension, symmetry) are what random outlines lack.
"""

from __future__ import annotations

from math import atan2, pi, sqrt, tan
from random import Random
from typing import Any

import pytest
from test_fence import seen as seen_on_fence

from cad_parts import SHAPES, cad_part
from fixture_sets import Judge, assert_same, listed
from slow_fence import slow_fence
from slow_plate import seen, slow_plate
from workhold import Fence, Plate, Query, Result, Vise, Workpiece, design, verify
from workhold.algebra import find_fixtures_by_algebra
from workhold.files.toolkit_file import list_preset_names, load_toolkit

PRESETS = list_preset_names()
# Fixtures listed of each part.
BEST = 20
# No peg carries more than this many times the clamping force: what would is a clamp that grazes.
MOST_FORCE = 1e6


def forces(result: Result) -> list[float]:
    """All contact forces per unit of a clamp's force."""
    out = []
    for fixture in result:
        out += [peg.force for peg in fixture.pegs]
        if fixture.pair is not None:
            out += [force for pair in fixture.pair.reactions for force in pair]
    return out


def assert_sound(part: Workpiece, preset: str) -> None:
    """A part on a preset: everything is decided, no force is absurd, and the result stands before its verification."""
    result = design(part, load_toolkit(preset).toolkit, best=BEST)
    assert result.complete
    # Set-ups between flat jaws are finitely many, and each is tried: there is nothing to prove about the others.
    assert (result.proof is None) == (result.toolkit.flat_jaws is not None)
    if result.proof is not None:
        assert result.proof.undecided == (), (part.name, preset)
    assert all(abs(force) <= MOST_FORCE for force in forces(result)), (part.name, preset)
    outcome = verify(result)
    assert (outcome.proven, outcome.undecided, outcome.refuted) == (len(result), 0, 0), (part.name, preset)
    assert outcome.faults == (), (part.name, preset)


# Each shape once, each with another preset.
@pytest.mark.thinned(10)
@pytest.mark.parametrize("seed", range(len(SHAPES)))
def test_every_shape_is_held_without_fault_or_doubt(seed: int) -> None:
    assert_sound(cad_part(seed), PRESETS[seed % len(PRESETS)])


@pytest.mark.prove
@pytest.mark.parametrize("seed", range(220))
def test_hundreds_of_parts_on_every_preset(seed: int) -> None:
    for preset in PRESETS:
        assert_sound(cad_part(seed), preset)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("seed", "pitch"),
    [(6, 22.0), *(pytest.param(seed, 25.0, marks=pytest.mark.prove) for seed in (4, 5, 10, 17, 22, 24))],
)
def test_vises_agree_with_the_algebra(seed: int, pitch: float) -> None:
    """The other engine shares no solver, and lists the same."""
    part, vise = cad_part(seed), Vise(pitch, 1, 3)
    ours, theirs = design(part, vise), find_fixtures_by_algebra(Query(part, vise))
    assert len(ours) > 3
    assert_same(listed(ours), listed(theirs), Judge(part, vise))


ONE: dict[str, Any] = {"directions": ["-x", "-y"]}
TWO: dict[str, Any] = {"directions": [("-x", "-y")], "clamps": 2}
LONG = ((seed, 40.0, 3, fields) for seed in (4, 5, 6, 7, 16) for fields in (ONE, TWO))


@pytest.mark.thorough
@pytest.mark.sampled(12)
@pytest.mark.parametrize(
    ("seed", "pitch", "columns", "fields"), [(6, 30.0, 2, ONE), (6, 30.0, 2, TWO), *LONG]
)
def test_plates_agree_with_a_slow_search(
    seed: int, pitch: float, columns: int, fields: dict[str, Any]
) -> None:
    """One clamp and two, tips alone: the same fixtures to the last one."""
    part = cad_part(seed)
    plate = Plate(pitch, 3, columns=columns, rows=2, clamp_radius=5, **fields)
    result = design(part, plate, **({"listing": "all"} if plate.clamps == 2 else {}))
    assert len(seen(result)) == len(result) > 0
    assert seen(result) == slow_plate(part, plate)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "seed", [7, *(pytest.param(seed, marks=pytest.mark.prove) for seed in (1, 2, 4, 5, 6, 8, 9, 10))]
)
def test_fences_agree_with_a_slow_search(seed: int) -> None:
    """A row that grazes a bore (7) presses as the drawing has it, not as an arc's centre was rounded."""
    part, fence = cad_part(seed), Fence(pitch=20, peg_radius=3, wall_offset=11, clamp_radius=5, rows=4)
    result = design(part, fence)
    assert len(result) > 0
    assert seen_on_fence(result) == slow_fence(part, fence)
    assert verify(result).proven == len(result)


def test_pegs_in_two_bores_nearly_as_far_apart_as_the_holes_are_decided() -> None:
    """Two pegs 64.76 mm apart in bores 64 mm apart move far in a narrow range, where slopes are hardly bounded."""
    link = Workpiece.from_loops("link", SHAPES["link"](Random(67)))
    vise = Vise((12.7, 12.7), 4, 3.175, min_gap=12.7, body_radius=3.175)
    result = design(link, vise, best=1)
    assert result.proof is not None and result.proof.undecided == ()


def rod(digits: int) -> Workpiece:
    """A rod of 140 mm with equal round ends about bores, its coordinates and bulges written to so many digits."""
    radius, half, bore, length = 25.0, 10.5, 12.5, 140.0
    joint = sqrt(radius**2 - half**2)
    bulge = round(tan((pi - atan2(half, joint)) / 2), digits)
    joint = round(joint, digits)
    outside = [
        (joint, -half, 0),
        (length - joint, -half, bulge),
        (length - joint, half, 0),
        (joint, half, bulge),
    ]
    bores = [[(x + bore, 0, -1), (x - bore, 0, -1)] for x in (0.0, length)]
    return Workpiece.from_loops("rod", [outside, *bores])


# The ends are then 7e-11 to 1e-9 mm from as far apart as seven holes of 20 mm.
@pytest.mark.thorough
@pytest.mark.parametrize("digits", [9, 10, 11])
def test_three_locators_on_ends_nearly_as_far_apart_as_holes_have_sharp_places(digits: int) -> None:
    """The third locator says where the part lies, which the two on both ends hardly do: there were 10,000 boxes of
    some mm, on which the proof spent minutes."""
    result = design(rod(digits), Plate.preset("clamp-plate-20mm"))
    assert result.proof is not None and result.proof.undecided == ()
    assert result.proof.escalated < 100
    assert result.counts == {"clamp": 38600}


@pytest.mark.thorough
def test_flat_boxes_of_turn_and_place_are_contracted_as_they_are() -> None:
    """The orientation is known to 1e-11, the place to some mm: a frame that mixes both never gets small."""
    result = design(rod(11), Vise(pitch=20, columns=2, peg_radius=3))
    assert result.proof is not None and result.proof.undecided == ()
    assert sum(result.counts.values()) == 7144
