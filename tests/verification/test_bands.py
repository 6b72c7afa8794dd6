"""Bands of pegs against the solid: what the faces give passes, and every other height is a fault of one peg."""

from __future__ import annotations

from typing import Any

import pytest
from attrs import evolve

import workhold
from own_heights import BASE, HEIGHT, STEM, stepped
from workhold import Fixture, Plate, Query, Result, Vise
from workhold.model.support_request import SupportRequest
from workhold.verification.supports import find_band_faults

# A band for each side of the base, no two alike.
BANDS = [(float(k), 5.0 + k) for k in range(len(BASE))]


@pytest.fixture(scope="module")
def result() -> Result:
    """Fixtures of a part whose sides are touched at heights of their own, one of them higher than the part is thick."""
    part = stepped({})
    assert part.solid is not None
    return workhold.design(evolve(part, solid=evolve(part.solid, bands=BANDS)), Vise(10, 4, 3))


def faults(query: Query, fixture: Fixture, bands: Any, thickness: float = HEIGHT) -> list[str]:
    """What is wrong with some bands."""
    request = evolve(SupportRequest.from_workpiece(query.workpiece, thickness), bands=bands)
    return list(find_band_faults(query, fixture, request))


def spanned(fixture: Fixture, most: float = HEIGHT) -> list[tuple[float, float]]:
    """From the lowest to the highest point of the faces that each peg touches, but no higher than the part is."""
    faces = [[BANDS[k] for k in (peg.face, peg.beside) if k is not None] for peg in fixture.pegs]
    return [(min(min(a for a, _ in own), most), min(max(b for _, b in own), most)) for own in faces]


@pytest.mark.thorough
def test_the_bands_of_the_faces_pass(result: Result) -> None:
    """Of a peg on one face and of one in a corner, which may press over both; of a thin part up to its top."""
    first = result[0]
    corner = evolve(first, pegs=[evolve(peg, beside=(peg.face + 1) % len(BANDS)) for peg in first.pegs])
    for fixture in (corner, *list(result)[:20]):
        assert faults(result.query, fixture, spanned(fixture)) == []
        assert faults(result.query, fixture, spanned(fixture, 6.0), 6.0) == []
        assert faults(result.query, fixture, None) == []


@pytest.mark.parametrize("end", [0, 1])
@pytest.mark.parametrize("off", [-1e-5, 1e-5, 0.5])
def test_any_other_height_is_a_fault_of_its_peg(result: Result, end: int, off: float) -> None:
    """Either end, by little or much; the sentence has the face, what is written, and what the solid has."""
    fixture, bands = result[0], spanned(result[0])
    for k, peg in enumerate(fixture.pegs):
        low, high = (value + (off if one == end else 0.0) for one, value in enumerate(bands[k]))
        if not 0.0 <= low <= high <= HEIGHT:
            continue
        (fault,) = faults(result.query, fixture, [*bands[:k], (low, high), *bands[k + 1 :]])
        assert fault.startswith(f"a peg on face {peg.face} has the band {low:g} to {high:g}")
        assert fault.endswith(f"of the solid is {bands[k][0]:g} to {bands[k][1]:g}")


def test_a_carrier_with_heights_of_its_own_has_the_band_of_what_it_meets() -> None:
    """The clamp's face is numbered on, and its band is that of its outline, not of the pegs'."""
    toolkit = Plate(20, 3, clamp_radius=5, clamp_heights=(12, 20))
    result = workhold.design(stepped({"clamp": ((12.0, 20.0), STEM)}), toolkit)
    fixture = result[0]
    assert fixture.pegs[-1].face >= len(BASE)
    right = [(0.0, 8.0)] * 3 + [(12.0, 20.0)]
    assert faults(result.query, fixture, right) == []
    (fault,) = faults(result.query, fixture, [(0.0, 8.0)] * 4)
    assert "has the band 0 to 8, and that of the solid is 12 to 20" in fault


def test_a_part_of_a_drawing_has_no_bands_to_hold_to() -> None:
    """Nobody knows them."""
    result = workhold.design(workhold.Workpiece.from_loops("part", [BASE]), Vise(10, 4, 3))
    assert faults(result.query, result[0], [(0.0, 1.0)] * 4) == []
