"""Values as users of Python give them: one for several, arrays, shapely; the rest is refused with the value."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import workhold
from workhold import InputError, Load, Plate, Query, Restrictions, Tolerance, Vise, Workpiece
from workhold.model.support_request import SpatialLoad, SupportRequest

PART = workhold.load("widget")
VISE = Vise(pitch=8, columns=1, peg_radius=3)
CORNERS = [(0, 0), (60, 0), (60, 40), (0, 40)]


def test_one_value_stands_where_several_can() -> None:
    """And arrays where lists can."""
    one = Load(points=(30, 20), force=np.float32(5), directions=30)
    assert one == Load(points=[(30, 20)], force=5, directions=(30, 30))
    assert Load(points=np.array(CORNERS), force=1).points == tuple(
        map(tuple, np.array(CORNERS, float).tolist())
    )
    assert Restrictions(angles=(-10, 10), avoid=3) == Restrictions(angles=[(-10, 10)], avoid=[3])
    assert Query(PART, VISE, loads=one).loads == (one,)
    assert len(workhold.design(PART, VISE, best=1)[0].load_cases(one)) == 1
    zone = workhold.circle_zone(1, 2, 3)
    assert Restrictions(zones=zone) == Restrictions(zones=[zone])
    assert Restrictions(avoid=np.array([4, 1])).avoid == (1, 4)
    assert SpatialLoad(points=(1, 2), axial=np.array([3.0, 2.0])).axial == (2.0, 3.0)
    assert Query(PART, VISE, contact_margin=np.float32(0.5), best=np.int64(3)).best == 3


def test_an_array_is_a_part() -> None:
    """Of corners, in mm or in the unit that is said."""
    part = workhold.load(np.array(CORNERS), name="plate")
    assert part.is_alike(Workpiece.from_points("plate", CORNERS)) and part.name == "plate"
    assert workhold.load(CORNERS, unit="inch").bounds == pytest.approx((0, 0, 1524, 1016))
    assert workhold.load([*CORNERS, CORNERS[0]]).is_alike(part)


@pytest.mark.skipif(importlib.util.find_spec("shapely") is None, reason="needs shapely")
def test_polygons_are_zones() -> None:
    """Several of them, too; one with a hole is refused."""
    import shapely

    box = shapely.box(0, 0, 10, 5)
    assert Restrictions(zones=box).zones == (workhold.polygon_zone([(10, 0), (10, 5), (0, 5), (0, 0)]),)
    assert len(Restrictions(zones=shapely.MultiPolygon([box, shapely.box(20, 0, 30, 5)])).zones) == 2
    with pytest.raises(InputError, match="a keep-out zone has no holes"):
        Restrictions(zones=box.difference(shapely.box(1, 1, 2, 2)))
    with pytest.raises(InputError, match=r"a keep-out zone cannot be <POINT \(0 0\)>"):
        Restrictions(zones=[shapely.Point(0, 0)])


REFUSED: list[tuple[Callable[[], Any], str]] = [
    (lambda: Load(points=30, force=1), "a point of a load cannot be 30"),
    (lambda: Load(points="30,20", force=1), "a point of a load cannot be '30,20'"),
    (lambda: Load(points=[("30", 20)], force=1), "a number of a point of a load cannot be '30'"),
    (lambda: Load(points=[(1, 2, 3)], force=1), r"a point of a load cannot be \(1, 2, 3\)"),
    (lambda: Load(points=(1, 2), force="100"), "force cannot be '100'"),
    (lambda: Load(points=(1, 2), force=1, directions="30"), "a direction cannot be '30'"),
    (lambda: Load(points=(1, 2), force=1, directions=(1, 2, 3)), r"directions cannot be \(1, 2, 3\)"),
    (lambda: Load(moment=None), "moment cannot be None"),
    (lambda: SpatialLoad(points=(1, 2), axial="9"), "cannot be '9'"),
    (lambda: SpatialLoad(tilt=3), "two numbers cannot be 3"),
    (lambda: Restrictions(avoid="3"), "the number of a face cannot be '3'"),
    (lambda: Restrictions(avoid=[3.5]), "the number of a face cannot be 3.5"),
    (lambda: Restrictions(angles=5), "a range of angles cannot be 5"),
    (lambda: Restrictions(angles=("a", "b")), "a range of angles cannot be 'a'"),
    (lambda: Restrictions(zones=5), "a keep-out zone cannot be 5"),
    (lambda: workhold.circle_zone("1", 2, 3), "a number of a keep-out circle cannot be '1'"),
    (lambda: workhold.polygon_zone([1, 2, 3]), "a corner of a keep-out zone cannot be 1"),
    (lambda: Vise(pitch="20", columns=2, peg_radius=3), "pitch cannot be '20'"),
    (lambda: Vise(pitch=(20, "20"), columns=2, peg_radius=3), "pitch cannot be '20'"),
    (lambda: Vise(pitch=20, columns="2", peg_radius=3), "columns cannot be '2'"),
    (lambda: Vise(pitch=20, columns=2, peg_radius="3"), "peg radius cannot be '3'"),
    (lambda: Vise(pitch=20, columns=2, peg_radius=3, min_gap="9"), "min gap cannot be '9'"),
    (lambda: Plate(pitch=20, peg_radius=3, travel=("1", 30)), "cannot be '1'"),
    (lambda: Vise.preset("plate-20mm", columns="2"), "columns cannot be '2'"),
    (lambda: Tolerance("0.01"), "peg cannot be '0.01'"),
    (lambda: Query(PART, VISE, contact_margin="0.5"), "contact margin cannot be '0.5'"),
    (lambda: Query(PART, VISE, best="3"), "best '3' is not a positive whole number"),
    (lambda: Query(PART, VISE, jaw_force="9"), "jaw force cannot be '9'"),
    (lambda: Query(PART, VISE, thickness="9"), "thickness cannot be '9'"),
    (lambda: SupportRequest("9", 4, 5), "thickness cannot be '9'"),
    (lambda: Workpiece.from_loops("a", [[["0", 0, 0], [6, 0, 0], [6, 4, 0]]]), "a coordinate cannot be '0'"),
    (lambda: Workpiece.from_points("a", [("0", 0), (6, 0), (6, 4)]), "a coordinate cannot be '0'"),
    (lambda: Workpiece.from_points("a", CORNERS, fit="1"), "the fit cannot be '1'"),
    (lambda: workhold.load("widget", layers=5), "layers cannot be 5"),
    (lambda: workhold.load("widget", fit="0.1"), "fit cannot be '0.1'"),
    (lambda: workhold.load(np.zeros((3, 3))), r"a corner of an outline cannot be \[0. 0. 0.\]"),
    (lambda: workhold.Pose(0, 0, 0).apply("a"), "points cannot be 'a'"),
    (
        lambda: workhold.design(PART, VISE, best=1)[0].save_sheet("a.pdf", thickness="12"),
        "thickness cannot be '12'",
    ),
    (lambda: workhold.load(3), "a part cannot be read from it"),
    (lambda: workhold.Program.read("a.nc", thickness="1"), "thickness cannot be '1'"),
    (lambda: workhold.Program.read("a.nc", thickness=1, zero=("1", 0)), "zero cannot be '1'"),
]


@pytest.mark.parametrize(("make", "words"), REFUSED)
def test_what_is_no_value_is_refused_and_quoted(make: Callable[[], Any], words: str) -> None:
    """At once, with what to give."""
    with pytest.raises(InputError, match=words) as refusal:
        make()
    assert ": give" in str(refusal.value) and "nan" not in str(refusal.value)
