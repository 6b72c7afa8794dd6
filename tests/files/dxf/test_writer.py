"""The set-up as DXF, read back with ezdxf: exact, clean, on its layers."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable
from math import atan, atan2, cos, hypot, pi, radians, sin

import ezdxf
import pytest
from attrs import evolve
from drawing_examples import PART_AREA, diamond, example, hole_area
from ezdxf import options
from ezdxf.document import Drawing
from plate_examples import WAYS, on_plate

from workhold import Fixture, Vise, Workpiece
from workhold.files.dxf.writer import list_layer_colours, make_plates_dxf, make_setup_dxf
from workhold.model.dowels import Bolts, list_jaw_plates, place_plates_in_drawing

Held = tuple[Fixture, Workpiece, Vise]


def reread(held: Held) -> Drawing:
    """What ezdxf makes of the bytes."""
    return ezdxf.read(io.TextIOWrapper(io.BytesIO(make_setup_dxf(*held)), encoding="utf-8"))


def distance_to_part(document: Drawing, x: float, y: float) -> float:
    """Smallest distance from a point to the lines, arcs and circles on the layer PART, in closed form."""
    distances = []
    for entity in document.modelspace().query('*[layer=="PART"]'):
        for piece in entity.virtual_entities() if entity.dxftype() == "LWPOLYLINE" else [entity]:
            if piece.dxftype() == "LINE":
                (x0, y0, _), (x1, y1, _) = piece.dxf.start, piece.dxf.end
                share = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / ((x1 - x0) ** 2 + (y1 - y0) ** 2)
                share = max(0.0, min(1.0, share))
                distances.append(hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y))
                continue
            cx, cy, _ = piece.dxf.center
            radius, away = piece.dxf.radius, hypot(x - cx, y - cy)
            ends = []
            if piece.dxftype() == "ARC":
                first, last = radians(piece.dxf.start_angle), radians(piece.dxf.end_angle)
                turn = (atan2(y - cy, x - cx) - first) % (2 * pi)
                if turn > (last - first) % (2 * pi):
                    ends = [hypot(cx + radius * cos(a) - x, cy + radius * sin(a) - y) for a in (first, last)]
            distances.append(min(ends) if ends else abs(away - radius))
    return min(distances)


@pytest.mark.parametrize(
    ("body", "clearance", "radius"), [(None, 1.0, 4.0), (5.0, 2.5, 7.5), (None, 0.0, 3.0)]
)
def test_the_cutter_keeps_off_the_pegs(body: float | None, clearance: float, radius: float) -> None:
    """About each peg there is a circle on KEEP_OUT, the clearance larger than the peg's thickest part."""
    fixture, part, vise = diamond()
    text = make_setup_dxf(
        fixture, part, evolve(vise, body_radius=body or vise.peg_radius), clearance=clearance
    )
    circles = (
        ezdxf.read(io.TextIOWrapper(io.BytesIO(text), encoding="utf-8"))
        .modelspace()
        .query('*[layer=="KEEP_OUT"]')
    )
    found = sorted((c.dxf.center.x, c.dxf.center.y, c.dxf.radius) for c in circles)
    expected = sorted((peg.x, peg.y, radius) for peg in fixture.pegs)
    assert sum(found, ()) == pytest.approx(sum(expected, ()))


@pytest.mark.parametrize("size", [0.01, 1.0, 40.0])
@pytest.mark.parametrize("rounded", [False, True])
def test_pegs_touch_the_part(size: float, rounded: bool) -> None:
    """From the centre of every peg to the nearest edge of the part it is the peg radius, to 1e-6 mm."""
    held = diamond(size, rounded)
    document = reread(held)
    pegs = list(document.modelspace().query('CIRCLE[layer=="PEGS"]'))
    assert len(pegs) == 4
    for peg in pegs:
        x, y, _ = peg.dxf.center
        assert peg.dxf.radius == held[2].peg_radius
        assert abs(distance_to_part(document, x, y) - peg.dxf.radius) < 1e-6


@pytest.mark.parametrize("made", [example, diamond])
def test_audit_finds_nothing(made: Callable[[], Held]) -> None:
    """The file is clean, in millimetres, and every entity is on a layer that was made for it."""
    held = made()
    document = reread(held)
    auditor = document.audit()
    assert not auditor.has_errors and not auditor.has_fixes
    assert document.header["$INSUNITS"] == 4
    used = {entity.dxf.layer for entity in document.modelspace()}
    assert used == {*list_layer_colours(held[2])}
    assert all(name in document.layers for name in used)


def test_part_keeps_its_area_and_its_arcs() -> None:
    """The notched plate's outline and hole enclose what they did before they were turned."""
    document = reread(example())
    areas = []
    for line in document.modelspace().query('LWPOLYLINE[layer=="PART"]'):
        area = 0.0
        for x0, y0, x1, y1, bulge in pieces(line.get_points("xyb")):
            chord = hypot(x1 - x0, y1 - y0)
            area += (x0 * y1 - x1 * y0) / 2
            if bulge:
                sweep = 4 * atan(bulge)
                radius = chord / (2 * sin(abs(sweep) / 2))
                area += radius**2 / 2 * (sweep - sin(sweep))
        areas.append(area)
    assert sorted(areas) == pytest.approx([-hole_area(), PART_AREA])


def pieces(points: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Start, end and bulge of each piece of a closed polyline."""
    return [(*a[:2], *b[:2], a[2]) for a, b in zip(points, points[1:] + points[:1], strict=True)]


def test_whole_circles_are_circles() -> None:
    """A round hole drawn as two halves is one CIRCLE at its place in the vise."""
    fixture, _, vise = diamond()
    loops = [[[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]], [[15, 20, 1], [25, 20, 1]]]
    document = reread((fixture, Workpiece.from_loops("square", loops), vise))
    (hole,) = document.modelspace().query('CIRCLE[layer=="PART"]')
    assert hole.dxf.radius == pytest.approx(5.0)
    left, right = fixture.pegs[0].x, fixture.pegs[2].x
    assert tuple(hole.dxf.center)[:2] == pytest.approx(((left + right) / 2, 10.0))


def test_holes_and_names_are_those_of_the_vise() -> None:
    """The used holes are where the pegs are, and the text at each names it."""
    fixture, workpiece, vise = example()
    space = reread((fixture, workpiece, vise)).modelspace()
    used = {
        tuple(round(v, 9) for v in hole.dxf.center)[:2] for hole in space.query('CIRCLE[layer=="HOLES_USED"]')
    }
    assert used == {(round(peg.x, 9), round(peg.y, 9)) for peg in fixture.pegs}
    named = {text.dxf.text: tuple(text.get_placement()[1])[:2] for text in space.query('TEXT[layer=="TEXT"]')}
    for peg in fixture.pegs:
        assert named[peg.hole] == pytest.approx((peg.x, peg.y))
    assert "S = 36 mm" in named and named["B"]
    for hole in space.query('CIRCLE[layer=="HOLES"]'):
        x, y, _ = hole.dxf.center
        assert (round(x, 9), round(y, 9)) not in used
        assert min(abs(x - wanted) for wanted in (0, 10, 46, 56)) < 1e-9 and y % 10 == pytest.approx(
            0, abs=1e-9
        )


def test_part_zero_is_at_the_pose() -> None:
    """The point on PART_ZERO is the translation of the pose, its longer line points along the part's x axis."""
    fixture, workpiece, vise = diamond()
    space = reread((fixture, workpiece, vise)).modelspace()
    (point,) = space.query('POINT[layer=="PART_ZERO"]')
    assert tuple(point.dxf.location)[:2] == pytest.approx((fixture.pose.x, fixture.pose.y))
    line = max(
        space.query('LINE[layer=="PART_ZERO"]'), key=lambda line: (line.dxf.end - line.dxf.start).magnitude
    )
    assert (line.dxf.end - line.dxf.start).angle_deg == pytest.approx(45.0)


def test_pegs_without_size_are_points() -> None:
    """The paper's point contacts leave POINTs."""
    fixture, workpiece, vise = example()
    space = reread((fixture, workpiece, evolve(vise, peg_radius=0.0, body_radius=0.0))).modelspace()
    assert len(space.query('POINT[layer=="PEGS"]')) == 4 and not space.query('CIRCLE[layer=="PEGS"]')


def test_bytes_are_the_same_every_time() -> None:
    """No time, no random numbers; and the option of ezdxf that sees to it is put back."""
    assert make_setup_dxf(*example()) == make_setup_dxf(*example())
    assert options.write_fixed_meta_data_for_testing is False


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("bolted", [True, False], ids=["bolted", "line"])
def test_locators_and_clamp_of_a_plate_touch_the_part(way: str, bolted: bool) -> None:
    """Each locator and the clamp's tip is its radius from the part, on layers of their own, and the clamp's body, a closed
    capsule, keeps off the part; the file is clean.
    """
    held = on_plate(way, bolted)
    document = reread(held)
    space = document.modelspace()
    auditor = document.audit()
    assert not auditor.has_errors and not auditor.has_fixes
    assert {entity.dxf.layer for entity in space} == set(list_layer_colours(held[2]))
    circles = [*space.query('CIRCLE[layer=="LOCATORS"]'), *space.query('CIRCLE[layer=="CLAMP"]')]
    assert [tuple(circle.dxf.center)[:2] for circle in circles] == [(peg.x, peg.y) for peg in held[0].pegs]
    for circle in circles:
        assert abs(distance_to_part(document, *tuple(circle.dxf.center)[:2]) - circle.dxf.radius) < 1e-6
    bodies = list(space.query('LWPOLYLINE[layer=="CLAMP"]'))
    assert len(bodies) == int(bolted) and all(body.closed for body in bodies)
    for body in bodies:
        corners = [(x, y) for x, y, _ in body.get_points("xyb")]
        assert min(distance_to_part(document, x, y) for x, y in corners) > 0
        assert [bulge for _, _, bulge in body.get_points("xyb")] == pytest.approx([0, 1, 0, 1])
    used = {
        tuple(round(v, 9) for v in hole.dxf.center)[:2] for hole in space.query('CIRCLE[layer=="HOLES_USED"]')
    }
    assert len(used) == 3 + bolted


@pytest.mark.thorough
def test_bytes_do_not_depend_on_the_process() -> None:
    """Two processes that order sets in different ways write the same file."""
    code = (
        "import hashlib, drawing_examples; from workhold.files.dxf.writer import make_setup_dxf; "
        "print(hashlib.sha256(make_setup_dxf(*drawing_examples.example())).hexdigest())"
    )
    said = set()
    for seed in ("4", "5"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
        said.add(done.stdout)
    assert len(said) == 1


# Drawings of jaw plates read back: every hole once, on its layer, at its place.
PLATES = list_jaw_plates(
    Vise(pitch=(10, 12), columns=3, peg_radius=3, rows=4),
    hole_diameter=6.01,
    bolts=Bolts(4.0, ((5.0, 6.0), (15.0, 30.0))),
)


def test_every_hole_is_drawn_at_its_place() -> None:
    """Circles of the diameters given, moved with their plate; the plates do not touch."""
    document = ezdxf.read(io.TextIOWrapper(io.BytesIO(make_plates_dxf(PLATES)), encoding="utf-8"))
    space = document.modelspace()
    assert document.header["$INSUNITS"] == 4
    for layer, diameter, places in (
        ("DOWEL_HOLES", 6.01, [[center for _, center in plate.holes] for plate in PLATES]),
        ("BOLT_HOLES", 4.0, [list(plate.bolts.places) if plate.bolts else [] for plate in PLATES]),
    ):
        circles = list(space.query(f'CIRCLE[layer=="{layer}"]'))
        assert {circle.dxf.radius for circle in circles} == {diameter / 2}
        found = sorted((round(c.dxf.center.x, 9), round(c.dxf.center.y, 9)) for c in circles)
        moved = [
            (x + right, y)
            for right, each in zip(place_plates_in_drawing(PLATES), places, strict=True)
            for x, y in each
        ]
        assert sum(found, ()) == pytest.approx(sum(sorted(moved), ()))
    outlines = list(space.query('LWPOLYLINE[layer=="PLATE"]'))
    assert [outline.closed for outline in outlines] == [True, True]
    extents = [[x for x, *_ in outline.get_points()] for outline in outlines]
    assert max(extents[0]) < min(extents[1])
    names = {text.dxf.text for text in space.query("TEXT")}
    assert {"L-A1", "R-C4"} <= names and "left jaw: 12 dowel holes %%c6.01 mm, 2 bolt holes %%c4 mm" in names


def test_the_same_plates_give_the_same_bytes() -> None:
    """No date and no random number."""
    assert make_plates_dxf(PLATES) == make_plates_dxf(PLATES)
