"""What must not change the fixtures: moving, turning, mirroring, renumbering, swapping the jaws, scaling, threads."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixture_sets import Judge, assert_same, listed, mirrored, turned
from strategies import outlines
from workhold import Vise, Workpiece, design

EXAMPLES = 5
# Few holes: what must not change shows on a hundred fixtures as on ten thousand.
pitches = st.sampled_from([12.0, 16.0, 20.0])
columns = st.integers(1, 2)
offsets = st.sampled_from([0.0, 0.0, 0.5, 0.3])


def vise_for(pitch: float, columns: int, offset: float) -> Vise:
    """A vise with pegs of a quarter pitch and an offset given in parts of the pitch."""
    return Vise(pitch=pitch, columns=columns, peg_radius=pitch / 4, row_offset=offset * pitch)


def moved(workpiece: Workpiece, change: Callable[[np.ndarray], np.ndarray], flip: bool = False) -> Workpiece:
    """The part with its vertices' places changed; ``flip`` when the change mirrors."""
    loops = []
    for loop in workpiece.loops:
        points = change(np.array(loop[:, :2]))
        loops.append(np.column_stack([points, -loop[:, 2] if flip else loop[:, 2]]))
    return Workpiece.from_loops(workpiece.name, loops)


@pytest.mark.thorough
@settings(max_examples=EXAMPLES)
@given(
    outlines(), pitches, columns, offsets, st.floats(-3.0, 3.0), st.floats(-500, 500), st.floats(-500, 500)
)
def test_turning_and_moving_the_part(
    workpiece: Workpiece, pitch: float, count: int, offset: float, angle: float, x: float, y: float
) -> None:
    """A part redrawn turned by an angle and moved has the same fixtures, in poses turned back by that angle."""
    vise = vise_for(pitch, count, offset)
    turn = np.array([[cos(angle), sin(angle)], [-sin(angle), cos(angle)]])
    redrawn = moved(workpiece, lambda points: points @ turn + [x, y])
    expected = turned(listed(design(workpiece, vise)), angle)
    # The expected poses are named in the redrawn part's frame: q' = R(angle) q + (x, y).
    for fixture in expected:
        theta = np.radians(fixture["pose"]["theta_deg"])
        fixture["pose"] = fixture["pose"] | {
            "x": fixture["pose"]["x"] - cos(theta) * x + sin(theta) * y,
            "y": fixture["pose"]["y"] - sin(theta) * x - cos(theta) * y,
        }
    assert_same(listed(design(redrawn, vise)), expected, Judge(redrawn, vise))


@pytest.mark.thorough
@settings(max_examples=EXAMPLES)
@given(outlines(), pitches, columns, offsets)
def test_mirroring_part_and_vise(workpiece: Workpiece, pitch: float, count: int, offset: float) -> None:
    """A part and a vise mirrored at the x axis have the mirrored fixtures."""
    redrawn = moved(workpiece, lambda points: points * [1.0, -1.0], flip=True)
    starts = np.cumsum([0] + [len(loop) for loop in workpiece.loops])

    def face(segment: int) -> int:
        # Turning a loop back to run the right way round keeps its first vertex and reverses its segments.
        loop = int(np.searchsorted(starts, segment, side="right")) - 1
        return int(starts[loop] + len(workpiece.loops[loop]) - 1 - (segment - starts[loop]))

    there = design(redrawn, vise_for(pitch, count, -offset))
    here = mirrored(listed(design(workpiece, vise_for(pitch, count, offset))), face)
    assert_same(listed(there), here, Judge(redrawn, there.toolkit))


@pytest.mark.thorough
@settings(max_examples=EXAMPLES)
@given(outlines(), pitches, columns, st.integers(1, 7))
def test_renumbering_the_segments(workpiece: Workpiece, pitch: float, count: int, shift: int) -> None:
    """Beginning the outer loop at another vertex renumbers the faces and changes nothing else."""
    outer = len(workpiece.loops[0])
    shift %= outer
    loops = [np.roll(workpiece.loops[0], -shift, axis=0), *workpiece.loops[1:]]
    redrawn = Workpiece.from_loops(workpiece.name, loops)
    vise = vise_for(pitch, count, 0.0)
    here = turned(listed(design(workpiece, vise)), 0.0, lambda k: (k - shift) % outer if k < outer else k)
    assert_same(listed(design(redrawn, vise)), here, Judge(redrawn, vise))


@pytest.mark.thorough
@settings(max_examples=EXAMPLES)
@given(outlines(), pitches, columns, offsets)
def test_swapping_the_jaws(workpiece: Workpiece, pitch: float, count: int, offset: float) -> None:
    """Turned half way round, with left and right swapped, each Type I fixture is again a fixture in the list.

    The half turn maps the lattice of the vise onto itself, whatever the row offset, so it is enough that the set of a
    part redrawn half a turn round, in which every left peg meets what a right peg met, is the same set.
    """
    vise = vise_for(pitch, count, offset)
    redrawn = moved(workpiece, lambda points: -points)
    here = listed(design(workpiece, vise))
    assert_same(listed(design(redrawn, vise)), turned(here, pi), Judge(redrawn, vise))
    for fixture in here[:: len(here) // 20 + 1]:
        if fixture["type"] == "I":
            swapped = fixture | {
                "pegs": [
                    peg
                    | {
                        "jaw": "left" if peg["jaw"] == "right" else "right",
                        "x": -peg["x"],
                        "y": -peg["y"],
                        "column": count - 1 - peg["column"],
                        "row": -peg["row"],
                    }
                    for peg in fixture["pegs"]
                ],
                "pose": {
                    "theta_deg": fixture["pose"]["theta_deg"] + 180.0,
                    "x": -fixture["pose"]["x"],
                    "y": -fixture["pose"]["y"],
                },
            }
            assert Judge(workpiece, vise).check(swapped)[0] == []


@pytest.mark.thorough
@settings(max_examples=EXAMPLES)
@given(outlines(), pitches, columns, st.sampled_from([0.01, 0.1, 25.4, 100.0]))
def test_scaling_part_pitch_and_peg_together(
    workpiece: Workpiece, pitch: float, count: int, scale: float
) -> None:
    """Scaling part, pitch and peg scales lengths; holes, faces, orientations and closure margins stay."""
    vise = vise_for(pitch, count, 0.0)
    larger = Vise(pitch=pitch * scale, columns=count, peg_radius=vise.peg_radius * scale)
    redrawn = moved(workpiece, lambda points: points * scale)
    here, there = design(workpiece, vise), design(redrawn, larger)
    scaled = [
        fixture
        | {
            "pegs": [peg | {"x": peg["x"] / scale, "y": peg["y"] / scale} for peg in fixture["pegs"]],
            "pose": fixture["pose"] | {"x": fixture["pose"]["x"] / scale, "y": fixture["pose"]["y"] / scale},
            "jaw_separation": fixture["jaw_separation"] / scale,
        }
        for fixture in listed(there)
    ]
    assert_same(scaled, listed(here), Judge(workpiece, vise))
    if len(here) == len(there) > 0:
        margins = [np.sort(r.table.null_vector.min(axis=1)) for r in (here, there)]
        assert np.allclose(*margins, atol=1e-6)


@pytest.mark.thorough
@settings(max_examples=4)
@given(outlines(), pitches)
def test_every_listed_fixture_passes_the_independent_checker(workpiece: Workpiece, pitch: float) -> None:
    """No listed fixture has a fault, whatever the part."""
    vise = vise_for(pitch, 3, 0.25)
    judge = Judge(workpiece, vise)
    fixtures = listed(design(workpiece, vise))
    for fixture in fixtures[:: len(fixtures) // 100 + 1]:
        assert judge.check(fixture)[0] == []


@pytest.mark.parametrize("name", ["widget", "small4Handle"])
def test_number_of_threads_changes_nothing(name: str) -> None:
    """Any number of threads gives the same arrays, bit for bit."""
    from workhold import load

    vise = Vise(pitch=10, columns=3, peg_radius=3)
    one, three = (design(load(name), vise, threads=threads).table for threads in (1, 3))
    for field in (
        "arrangement",
        "column",
        "row",
        "face",
        "theta",
        "position",
        "jaw_separation",
        "null_vector",
    ):
        assert np.array_equal(getattr(one, field), getattr(three, field))
