"""GLB files of fixtures, read by the specification: named and coloured bodies in place, closed, of the right volume."""

from __future__ import annotations

from math import acos, pi, sqrt

import numpy as np
import pytest
import shapely
import shapely.affinity
from attrs import evolve

from body_examples import BLOCK, TOOLKITS, held
from glb_reading import ReadBody, fixture_glb, read_glb
from workhold import Vise
from workhold.errors import InputError
from workhold.files.glb import SAGITTA, make_bodies_glb
from workhold.geometry.segment import Arc, Line
from workhold.model.bodies import COLOURS, BodyKind, BodySizes, FixtureBody, Slab, list_fixture_bodies
from workhold.model.solid import SolidOutline

SIZES = BodySizes.from_workpiece(BLOCK, thickness=12, plate_thickness=8)


def bodies_of(name: str) -> list[ReadBody]:
    """The bodies of a toolkit's fixture, 12 mm high over plates of 8 mm."""
    return read_glb(fixture_glb(*held(name), SIZES))[1]


@pytest.mark.thorough
@pytest.mark.parametrize("name", TOOLKITS)
def test_bodies_are_closed_and_enclose_area_times_height(name: str) -> None:
    """Volumes are those of the prisms with their arcs, which chords shorten by no more than the sagitta all along them."""
    described = list_fixture_bodies(*held(name), SIZES)
    read = bodies_of(name)
    assert [body.name for body in read] == [body.name for body in described]
    for body, meant in zip(read, described, strict=True):
        body.assert_closed()
        assert body.kind == body.material == str(meant.kind)
        volume = slack = 0.0
        for slab in meant.slabs:
            loops = (slab.outer, *slab.holes)
            volume += (slab.high - slab.low) * sum(area(loop) for loop in loops)
            arcs = [one for loop in loops for one in loop if isinstance(one, Arc)]
            slack += (slab.high - slab.low) * SAGITTA * sum(arc.length for arc in arcs)
        assert abs(body.volume - volume) <= slack + 1e-5 * volume
        assert body.heights == pytest.approx((meant.slabs[0].low, meant.slabs[-1].high), abs=1e-5)


def area(loop: tuple) -> float:
    """Signed area of a loop: the polygon of its segments' ends, and what its arcs add."""
    total = 0.0
    for one in loop:
        (x, y), (u, v) = one.start, one.end
        total += (x * v - y * u) / 2
        if isinstance(one, Arc):
            turn = 2 * one.half_sweep
            total += one.sign * one.radius**2 * (turn - np.sin(turn)) / 2
    return total


@pytest.mark.thorough
@pytest.mark.parametrize("name", TOOLKITS)
def test_pegs_stand_where_the_fixture_says(name: str) -> None:
    """Every peg's axis is where its hole is, its vertices on its circle; it goes through its plate."""
    fixture, _, toolkit = held(name)
    read = {body.name: body for body in bodies_of(name)}
    placed = [carrier for carrier in toolkit.carriers if carrier.has_lattice]
    for carrier in placed:
        for peg in fixture.pegs:
            if peg.carrier != carrier.name:
                continue
            body = read[f"{carrier.peg} {peg.hole}"]
            assert body.heights == pytest.approx((-8, 12), abs=1e-5)
            far = np.hypot(*(body.positions[:, :2] - (peg.x, peg.y)).T)
            assert far.max() == pytest.approx(carrier.peg_radius, abs=1e-4)
            assert carrier.flat is not None or far.min() == pytest.approx(carrier.peg_radius, abs=1e-4)


def shadow(body: ReadBody) -> shapely.Geometry:
    """The upper side of a body in the plane."""
    top = body.heights[1]
    upper = [body.positions[t, :2] for t in body.triangles if (body.positions[t, 2] > top - 1e-6).all()]
    return shapely.union_all([shapely.Polygon(corners) for corners in upper])


@pytest.mark.thorough
@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", TOOLKITS)
def test_pegs_and_clamps_touch_the_part_and_plates_stay_apart(name: str) -> None:
    """In the plane: what touches is as far off as its chords and the part's are from their arcs at most, and enters
    nothing; plates do not meet."""
    read = bodies_of(name)
    (part,) = [shadow(body) for body in read if body.kind == "part"]
    for body in read:
        if body.kind in {"peg", "clamp", "wall"} and not body.name.startswith("bolt"):
            assert shadow(body).distance(part) <= 2 * SAGITTA
            assert shadow(body).intersection(part).area < 0.2
    plates = [shadow(body) for body in read if body.kind == "plate"]
    assert len(plates) == 1 or plates[0].distance(plates[1]) > 0


@pytest.mark.thorough
@pytest.mark.parametrize("name", TOOLKITS)
def test_what_moves_says_where_to_when_opened(name: str) -> None:
    """Moved that way pegs and clamps enter nothing, and leave the part; moved the other way they enter it."""
    read = bodies_of(name)
    (part,) = [shadow(body) for body in read if body.kind == "part"]
    moving = [body for body in read if body.opens is not None]
    freed = entered = 0
    for body in moving:
        assert body.opens is not None and np.linalg.norm(body.opens) == pytest.approx(1)
        dx, dy, dz = 2 * np.array(body.opens)
        assert dz == 0
        if body.kind in {"peg", "clamp"}:
            opened, closed = (shapely.affinity.translate(shadow(body), k * dx, k * dy) for k in (1, -1))
            assert opened.intersection(part).area < 0.2
            freed += opened.distance(part) > 0.5
            entered += closed.intersection(part).area > 1
    assert freed > 0 and entered > 0


@pytest.mark.thorough
def test_the_same_fixture_gives_the_same_bytes() -> None:
    """No date and no order by chance; and it names its maker early, by which files of workhold are known."""
    first = fixture_glb(*held("plate"))
    assert fixture_glb(*held("plate")) == first
    assert b'"generator":"workhold"' in first[:200]


def test_colours_are_those_of_the_kinds() -> None:
    """glTF's factors are linear light; a screen's values come out again."""
    document, _ = read_glb(fixture_glb(*held("fence")))
    for one in document["materials"]:
        factor = one["pbrMetallicRoughness"]["baseColorFactor"]
        shown = [1.055 * value ** (1 / 2.4) - 0.055 for value in factor[:3]]
        assert shown == pytest.approx(COLOURS[one["name"]], abs=1e-4) and factor[3] == 1


def test_a_part_of_a_solid_has_its_heights() -> None:
    """The part is as high as its solid, pegs and fence as the peg height; options say otherwise."""
    fixture, part, toolkit = held("fence")
    solid = SolidOutline("z", 25.0, 6.0, 0.5, 1.0, [(0.0, 6.0)] * sum(map(len, part.loop_segments)))
    high = evolve(part, solid=solid)
    read = {body.kind: body for body in read_glb(fixture_glb(fixture, high, toolkit))[1][:2]}
    assert read["part"].heights == pytest.approx((0, 25), abs=1e-5)
    assert read["peg"].heights == pytest.approx((-10, 6), abs=1e-5)
    heights = {body.kind: body.slabs[-1].high for body in list_fixture_bodies(fixture, high, toolkit)}
    assert heights["wall"] == 6.0
    assert not BodySizes.from_workpiece(high).is_assumed and BodySizes.from_workpiece(part).is_assumed
    assert BodySizes.from_workpiece(high, thickness=5.0).top == 5.0
    assert BodySizes.from_workpiece(high, peg_height=9.0).top == 9.0


def test_plates_that_nearly_meet_have_notches() -> None:
    """A jaw whose last column is nearer to the other jaw than its radius: notches in its side, of the exact area."""
    fixture, part, _ = held("vise")
    vise = Vise((10, 9), 3, 2.5)
    near = evolve(fixture, travel=4.0)
    plates = [body for body in list_fixture_bodies(near, part, vise, SIZES) if body.kind == "plate"]
    away = 0.48 * 4.0
    lost = 2.5**2 * (pi - acos(away / 2.5)) + away * sqrt(2.5**2 - away**2)
    for body in plates:
        (slab,) = body.slabs
        notches = sum(isinstance(one, Arc) for one in slab.outer)
        assert notches > 2
        box = np.array([one.start for one in slab.outer])
        whole = float(np.prod(box.max(axis=0) - box.min(axis=0)))
        assert area(slab.outer) == pytest.approx(whole - notches * lost, rel=1e-9)
    for body in read_glb(fixture_glb(near, part, vise, SIZES))[1]:
        body.assert_closed()


@pytest.mark.parametrize("separation", [None, 2.5 / 0.48], ids=["each other", "a side"])
def test_holes_that_would_touch_are_a_little_smaller(separation: float | None) -> None:
    """Holes half a pitch in radius, and holes that reach just to the side of their plate, leave a film all around."""
    fixture, part, toolkit = held("touching holes" if separation is None else "vise")
    fixture = fixture if separation is None else evolve(fixture, travel=separation)
    for body in list_fixture_bodies(fixture, part, toolkit, SIZES):
        if body.kind != "plate":
            continue
        (slab,) = body.slabs
        assert not any(isinstance(one, Arc) for one in slab.outer)
        corners = np.array([one.start for one in slab.outer])
        circles = [one for loop in slab.holes for one in loop]
        places = np.array([circle.center for circle in circles])
        radii = np.array([circle.radius for circle in circles])
        room = np.minimum(places - corners.min(axis=0), corners.max(axis=0) - places).min(axis=1)
        assert (room > radii + 1e-4).all()
        apart = np.linalg.norm(places[:, None] - places, axis=2) + 1e3 * np.eye(len(places))
        assert (apart > radii[:, None] + radii + 1e-4).all()


def test_sides_that_vanish_in_single_precision_are_left_out() -> None:
    """A side of a hundredth of a micrometre, in the middle of a loop and at its end, leaves no edge of no length."""
    corners = [(0.0, 0.0), (9.0, 0.0), (9.0, 1e-5), (9.0, 7.0), (1e-5, 1e-5)]
    loop = tuple(Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True))
    body = FixtureBody("wedge", BodyKind.WALL, (Slab(loop, (), 0.0, 2.0),))
    (read,) = read_glb(make_bodies_glb([body], "wedge"))[1]
    read.assert_closed()
    assert read.volume == pytest.approx(63.0, rel=1e-4) and len(read.triangles) == 2 + 6


def test_pegs_without_a_radius_are_refused() -> None:
    """They have no body."""
    fixture, part, toolkit = held("vise")
    with pytest.raises(InputError, match="pegs of radius 0 have no body"):
        fixture_glb(fixture, part, evolve(toolkit, peg_radius=0.0))
