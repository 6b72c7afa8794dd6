"""The number of sets that a symmetric part's rotations make of fixtures: of the search, of the verification, and as trying
each rotation on each fixture counts them."""

from __future__ import annotations

from collections import Counter
from functools import cache
from itertools import product

import pytest
from attrs import evolve

from symmetric_parts import Symmetric, sets_of, symmetric_parts
from workhold import Fence, OpeningVise, Plate, Query, Result, Vise, Workpiece, answer
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import compute_centroid_of_segments, find_rotations_onto_itself
from workhold.verification import verify
from workhold.verification.repeats import PartRotations

PARTS = symmetric_parts()
PLATE = Plate(pitch=(20, 24), peg_radius=3, clamp_radius=4, travel=(6, 40), columns=3, rows=3)
PAIRS = evolve(PLATE, pitch=20, columns=4, clamps=2, directions=None)
FENCE = Fence(pitch=20, peg_radius=3, clamp_radius=4, travel=(6, 40), wall_offset=10)
TOOLKITS: dict[str, Toolkit] = {
    "vise": Vise(pitch=20, columns=2, peg_radius=3, rows=3),
    "opening vise": OpeningVise(pitch=(10, 12), columns=2, peg_radius=2, rows=5),
    "flat": Vise(pitch=20, columns=1, peg_radius=3, rows=4, flat=(2.0, 1.5)),
    "plate": PLATE,
    "plate, all directions": evolve(PLATE, pitch=(20, 20), directions=("-x", "+x", "-y", "+y")),
    "fence": FENCE,
    "two clamps": PAIRS,
    "two clamps opposed": evolve(PAIRS, directions=[("-x", "+x"), ("-x", "-y")]),
    "fence, two clamps": evolve(FENCE, columns=4, rows=3, clamps=2, directions=None),
}
CASES = [
    (name, kind, listing)
    for name, (kind, toolkit) in product(PARTS, TOOLKITS.items())
    for listing in (("best", "all") if toolkit.travel_count > 1 else (None,))
    # Two clamps about half circles have very many double roots.
    if not (name == "slot" and toolkit.travel_count > 1)
]
# Every third one here, in which every part and every toolkit is met; all by ``make prove``.
SOME = [
    case
    for number, part in enumerate(PARTS)
    for case in [case for case in CASES if case[0] == part][number % 3 :: 3]
]


@cache
def full(name: str, kind: str, listing: str | None) -> Result:
    """All fixtures of a part in a toolkit."""
    return answer(Query(PARTS[name].part, TOOLKITS[kind], listing=listing))


def counted(result: Result, case: Symmetric) -> dict[str, int]:
    """How many sets the fixtures of a result form, by type."""
    fixtures = list(result)
    sets = Counter(fixtures[first].type for first in set(sets_of(fixtures, case, result.query)))
    return {kind: sets[kind] for kind in result.distinct}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "kind", "listing"),
    [case if case in SOME else pytest.param(*case, marks=pytest.mark.prove) for case in CASES],
)
def test_search_verification_and_trying_each_rotation_count_alike(
    name: str, kind: str, listing: str | None
) -> None:
    """So it is of all fixtures and of the best; of these sets are counted where no others were found, else of all."""
    case = PARTS[name]
    result = full(name, kind, listing)
    assert result.found == result.counts and result.distinct == counted(result, case)
    for one in (
        result,
        *(answer(evolve(result.query, best=best)) for best in {1, len(result) // 2} if best > 0),
    ):
        outcome = verify(one)
        assert (outcome.proven, outcome.faults) == (len(one), ())
        assert one.distinct == (counted(one, case) if one.found == one.counts else result.distinct)


@pytest.mark.thorough
def test_every_kind_and_symmetry_is_met() -> None:
    """Of each toolkit some part above has fixtures, and of each part but the disc some toolkit."""
    held = [(name, kind) for name, kind, listing in SOME if len(full(name, kind, listing))]
    assert {name for name, _ in held} == set(PARTS) - {"disc"} and {kind for _, kind in held} == set(TOOLKITS)


@pytest.mark.thorough
@pytest.mark.parametrize(("kind", "best"), [("fence", None), ("fence", 20), ("vise", 80)])
def test_another_number_of_sets_is_a_fault(kind: str, best: int | None) -> None:
    """Those that are found but not listed may each make a set or none, and no set has more than there are rotations."""
    result = full("box", kind, None)
    if best is not None:
        query, table = evolve(result.query, best=best), result.table.take(slice(best))
        result = evolve(result, query=query, table=table)
    name = result.toolkit.types[0]
    sets, found = counted(result, PARTS["box"])[name], result.found[name]
    least, most = max(sets, found // 2), sets + found - result.counts[name]
    assert (best is None) == (least == most) and (kind == "vise") == (2 * sets > found)
    for distinct in (least - 1, least, most, most + 1):
        faults = verify(evolve(result, distinct={**result.distinct, name: distinct})).faults
        assert (faults == ()) == (least <= distinct <= most)
        assert all(fault.startswith(f"distinct says {distinct} fixtures of type {name}") for fault in faults)


@pytest.mark.parametrize("name", PARTS)
def test_rotations_are_those_that_the_part_was_made_with(name: str) -> None:
    """Found by the search and by the verification, apart from each other, with the point that they keep."""
    case = PARTS[name]
    faces = [face.segment for face in case.part.faces]
    turning, rotations = PartRotations.from_workpiece(case.part), find_rotations_onto_itself(faces)
    assert turning.is_certain and turning.order == len(rotations) == case.order
    assert turning.angles == pytest.approx([rotation.angle for rotation in rotations[1:]])
    for point in (turning.center, compute_centroid_of_segments(faces)):
        assert complex(*point) == pytest.approx(case.kept, abs=1e-9)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("off", "order", "is_certain"), [(1e-7, 2, True), (1.5e-6, 2, False), (2e-5, 1, True)]
)
def test_a_symmetry_that_a_drawing_nearly_has_is_no_fault_either_way(
    off: float, order: int, is_certain: bool
) -> None:
    """A corner that is off by a thousandth of a micrometre may be meant or not, so nothing is said of the sets."""
    part = Workpiece.from_loops("box", [[(0, 0, 0), (50 + off, 0, 0), (60, 30, 0), (10, 30, 0)]])
    turning = PartRotations.from_workpiece(part)
    assert (turning.order, turning.is_certain) == (order, is_certain)
    result = answer(Query(part, TOOLKITS["vise"]))
    counts = ({**result.distinct, "I": result.found["I"] - fewer} for fewer in (1, 0))
    judged = [verify(evolve(result, distinct=distinct)).faults for distinct in counts]
    assert [faults == () for faults in judged] == [not is_certain, order == 1 or not is_certain]
