"""Outlines by height of mechanical parts and the fixtures on them, against Open CASCADE's sections and distances."""

from __future__ import annotations

from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.Interface import Interface_Static
from step_shapes import cut, cylinder, filleted, upright, write_step

from solid_examples import EXAMPLES, SolidExample, polygon
from solid_truth import border_faults, fixture_faults, off_region, section_faults, segments_of
from workhold import Fence, FlatJaw, Plate, Vise, Workpiece, design, load
from workhold.files.step.heights import StandingSolid, stand_solid
from workhold.files.step.library import turn_axis_up
from workhold.geometry.segment import make_segment_rows

QUICK = ("bearing housing", "rounded top", "casting", "dovetail")
KITS = (
    Vise(pitch=10, columns=2, peg_radius=3),
    Fence(pitch=20, peg_radius=3, wall_offset=10),
    Plate(pitch=15, peg_radius=3),
    Plate(pitch=20, peg_radius=3, clamp_radius=5, travel=(10, 40), directions=["-x"]),
    Plate(pitch=20, peg_radius=3, clamps=2, directions=[("-x", "-y")]),
    FlatJaw(pitch=20, peg_radius=3),
)
Loops = list[np.ndarray[Any, Any]]


def examples(quick: tuple[str, ...] = QUICK) -> list[Any]:
    """The solids by name, all but a few of them for ``make prove``."""
    return [
        pytest.param(one, id=one.name, marks=() if one.name in quick else pytest.mark.prove)
        for one in EXAMPLES
    ]


def outline(solid: StandingSolid, high: float) -> Loops:
    """Loops of U(-inf, high)."""
    return [
        np.array([(*piece.start, piece.bulge) for piece in loop]) for loop in solid.find_border(-np.inf, high)
    ]


@pytest.mark.parametrize("example", examples())
def test_sections_lie_in_the_outline_and_make_it(example: SolidExample) -> None:
    """At 200 heights the section lies in U, and over every border of U the solid stands or leans.

    A point of U that is not a section's would be enclosed by border over which nothing is.
    """
    solid = stand_solid(example.make())
    before: Loops = []
    for high in (*example.heights, solid.height):
        loops = outline(solid, high)
        assert section_faults(solid.shape, loops, high, 200) == []
        assert border_faults(solid.shape, loops, high, example.prismatic) == []
        # What lower pegs meet is met by higher ones.
        rows = make_segment_rows(segments_of(loops))
        for segment in segments_of(before):
            points = np.array(
                [segment.compute_point(share * segment.half_extent) for share in (-1.0, -0.3, 0.4)]
            )
            assert off_region(points, rows).max() <= 1e-6
        before = loops


@pytest.mark.parametrize("example", examples(("filleted foot", "extrusion", "casting")))
def test_pegs_touch_over_their_bands_and_enter_nowhere(example: SolidExample) -> None:
    """Of every kind of toolkit, the pegs, tips and walls of each fixture as bodies against the solid."""
    solid = stand_solid(example.make())
    for high in example.heights:
        part = load(solid.shape, name=example.name, peg_height=high)
        for toolkit in KITS:
            if not touchable(part, toolkit):
                continue
            for fixture in design(part, toolkit, best=4):
                assert list(fixture_faults(solid.shape, part, fixture, toolkit)) == []


def touchable(part: Workpiece, toolkit: Any) -> bool:
    """Whether some face with a band is not a hole: a small hole may be all that is left."""
    return any(part.solid.bands[face.number] for face in part.outer_faces)  # type: ignore[union-attr]


@pytest.mark.parametrize("example", examples())
def test_turned_over_twice(example: SolidExample) -> None:
    """Axis z, then -z twice, has the same outline and bands; the silhouette is the same from both sides, mirrored."""
    solid = stand_solid(example.make())
    twice = stand_solid(turn_axis_up(turn_axis_up(solid.shape, "-z"), "-z"))
    for high in example.heights:
        assert same_strips(solid.make_outline(high), twice.make_outline(high))
    over = stand_solid(turn_axis_up(solid.shape, "-z"))
    mirrored = [loop * np.array([-1.0, 1.0, 1.0]) for loop in outline(over, over.height)]
    rows = make_segment_rows(segments_of(outline(solid, solid.height)))
    points = np.concatenate([loop[:, :2] for loop in mirrored])
    # Corners of one are on the border of the other.
    assert np.abs(border_distance(points, rows)).max() <= 1e-6


def border_distance(points: Any, rows: Any) -> Any:
    """Distances of points (N, 2) from a border."""
    from workhold.kernels.base.distance import measure_outline_distances

    return measure_outline_distances(np.ascontiguousarray(points), rows)


def same_strips(one: Any, other: Any) -> bool:
    """Whether two outlines have the same segments with the same bands, wherever their loops begin."""
    return numbers_of(one) == pytest.approx(numbers_of(other), abs=1e-6)


def numbers_of(found: Any) -> list[float]:
    """Ends, bulges and bands of all segments in an order that depends on their places alone."""
    rows = [
        (
            *(round(value, 4) + 0.0 for value in (*strip.start, *strip.end)),
            strip.bulge,
            *(strip.band or (-1.0, -1.0)),
        )
        for loop in found.loops
        for strip in loop
    ]
    return [value for row in sorted(rows) for value in row]


@pytest.mark.parametrize("unit", ["INCH", "CM", "M", "FT"])
def test_units_of_the_file(tmp_path: Path, unit: str) -> None:
    """The same solid written in another unit has the same outline and bands in mm."""
    shape = next(one for one in EXAMPLES if one.name == "extrusion").make()
    own = load(write_step(tmp_path / "mm.step", shape), peg_height=20.0)
    try:
        assert Interface_Static.SetCVal_s("write.step.unit", unit)
        other = load(write_step(tmp_path / "other.step", shape), peg_height=20.0)
    finally:
        Interface_Static.SetCVal_s("write.step.unit", "MM")
    assert b"LENGTH_UNIT" in (tmp_path / "other.step").read_bytes()
    assert (tmp_path / "mm.step").read_bytes() != (tmp_path / "other.step").read_bytes()
    for one, two in zip(own.loops, other.loops, strict=True):
        assert one == pytest.approx(two, abs=1e-6)
    assert own.solid is not None and other.solid is not None
    for a, b in zip(own.solid.bands, other.solid.bands, strict=True):
        assert a == pytest.approx(b, abs=1e-6)


@pytest.mark.parametrize("toolkit", KITS, ids=lambda kit: f"{type(kit).__name__}{getattr(kit, 'clamps', '')}")
def test_list_of_a_prism_is_that_of_its_drawing(tmp_path: Path, toolkit: Any) -> None:
    """Pegs of any height list the same fixtures of a prism as its drawing has, with bands from 0 to p."""
    body = filleted(polygon([(0, 0), (70, 5), (62, 44), (20, 50)], 18), 4.0, upright)
    part = load(
        write_step(tmp_path / "prism.step", cut(body, cylinder(6, 40, (34, 24, -1)))), peg_height=12.0
    )
    drawn = Workpiece.from_loops(part.name, part.loops)
    assert part.solid is not None and all(band == pytest.approx((0, 12)) for band in part.solid.bands)
    own, other = design(part, toolkit), design(drawn, toolkit)
    assert own.found == other.found and len(own) > 0
    assert [one.pose for one in own] == [one.pose for one in other]


@pytest.mark.parametrize(
    "toolkit",
    [
        Vise(pitch=20, columns=1, peg_radius=4),
        Plate(pitch=20, peg_radius=3, columns=3, rows=3, directions=["-x", "-y"]),
        Fence(pitch=20, peg_radius=3, wall_offset=10, columns=4, rows=4),
    ],
    ids=lambda kit: type(kit).__name__,
)
def test_list_is_what_hand_made_rules_leave_of_the_outline(toolkit: Any) -> None:
    """Of all fixtures on the outline of a solid, those stay whose every contact is where a band is."""
    body = polygon([(0, 0), (72, 0), (60, 40), (10, 52)], 16)
    body = cut(body, along_box(24, 60, 30, (30, -10, 8)), along_box(20, 80, 30, (48, 20, 4)))
    part = load(body, name="part", peg_height=12.0, least_band=6.0)
    assert part.solid is not None
    own = design(part, toolkit)
    flat = design(Workpiece.from_loops("part", part.loops), toolkit)
    left = [one for one in flat if all(allowed(part, one, peg) for peg in one.pegs)]
    assert 0 < len(left) < len(flat)
    assert names(own) == names(left)


def along_box(*values: Any) -> Any:
    """A box, see ``step_shapes``."""
    from step_shapes import box

    return box(*values)


def allowed(part: Workpiece, fixture: Any, peg: Any) -> bool:
    """Whether the place that a peg touches has a band; at a corner on a wall, one of both faces."""
    assert part.solid is not None
    x, y = fixture.pose.inverse.apply(peg.x, peg.y)
    away = []
    for number, segment in enumerate(part.segments):
        place = min(max(segment.find_parameter((x, y)), -segment.half_extent), segment.half_extent)
        px, py = segment.compute_point(place)
        away.append((round(np.hypot(x - px, y - py), 6), number))
    nearest = [number for distance, number in away if distance == min(away)[0]]
    return any(part.solid.bands[number] is not None for number in nearest)


def names(fixtures: Any) -> set[tuple[Any, ...]]:
    """Holes of all fixtures with their poses, without faces: those of a line may have other numbers."""
    return {
        (
            *sorted(peg.hole for peg in one.pegs),
            round(one.pose.theta_deg, 5),
            round(one.pose.x, 4),
            round(one.pose.y, 4),
        )
        for one in fixtures
    }


def example_named(name: str) -> Any:
    """The shape of an example."""
    return next(one for one in EXAMPLES if one.name == name).make()


def test_band_jumps_where_an_opening_reaches_over_the_pegs() -> None:
    """Over a hole of radius 5 across the wall the band ends below it, and is half as long as the longest run."""
    strips = stand_solid(example_named("cross drilled")).make_outline(12.0).loops[0]
    wall = sorted((strip.start[1], strip.band) for strip in strips if strip.start[0] == strip.end[0] == 60.0)
    assert wall == [
        (0.0, pytest.approx((0.0, 12.0), abs=1e-9)),
        (pytest.approx(15.0), pytest.approx((0.0, 9.0 - 5.0 * sqrt(0.75)), abs=1e-9)),
        (pytest.approx(17.5), pytest.approx((0.0, 4.0), abs=1e-9)),
        (pytest.approx(22.5), pytest.approx((0.0, 9.0 - 5.0 * sqrt(0.75)), abs=1e-9)),
        (pytest.approx(25.0), pytest.approx((0.0, 12.0), abs=1e-9)),
    ]


def test_whole_circles_have_their_bands_wherever_they_begin() -> None:
    """Each bore of a bell crank is a wall over all heights of low pegs."""
    outline = stand_solid(example_named("bell crank")).make_outline(3.0)
    assert all(strip.band is not None for loop in outline.loops for strip in loop)
    assert len(outline.loops) == 6
