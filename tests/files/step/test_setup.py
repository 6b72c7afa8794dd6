"""A set-up written as a STEP assembly and read again: bodies, names, volumes, and pegs that touch the part."""

from __future__ import annotations

import re
from cmath import exp
from io import BytesIO
from math import acos, atan, pi, radians, sin, sqrt, tan
from pathlib import Path
from typing import Any

import attrs
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_VERTEX
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from plate_examples import WAYS, on_plate

from files.step_bodies import named_bodies
from workhold import Fixture, Peg, Pose, Vise, Workpiece, design
from workhold.errors import InputError
from workhold.files.step.solids import Solid, read_solids
from workhold.files.step.writer import make_setup_step, write_setup_step
from workhold.model.setup import choose_part_zero

VISE = Vise(pitch=(10, 12), columns=2, peg_radius=3, row_offset=2.5)
# A part about pegs in L-A1 and L-A3 (on a side and on a quarter circle), R-B1 and R-B3, as it lies in the vise; with a
# notch of radius 6.25.
LYING = [
    [(3, -5, 0), (20, -5, -0.5), (30, -5, 0), (67, -5, 0), (67, 35, 0), (11, 32, tan(pi / 8)), (3, 24, 0)],
    [(45, 15, -1), (35, 15, -1)],
]
NOTCH = 4 * atan(0.5)
LYING_AREA = 64 * 40 - 8 * 11 - 56 * 3 / 2 + 16 * pi - 25 * pi - 6.25**2 / 2 * (NOTCH - sin(NOTCH))


def part(pose: Pose, name: str = "part") -> Workpiece:
    """The part in its own coordinates."""
    turn = exp(-1j * radians(pose.theta_deg))
    loops = [
        [(turn * (complex(x, y) - complex(pose.x, pose.y)), bulge) for x, y, bulge in loop] for loop in LYING
    ]
    return Workpiece.from_loops(name, [[(z.real, z.imag, bulge) for z, bulge in loop] for loop in loops])


def fixture(pose: Pose, jaw_separation: float = 50.0) -> Fixture:
    """The four pegs about the part."""
    holes = [("left", 0, 0), ("left", 0, 2), ("right", 1, 0), ("right", 1, 2)]
    pegs = []
    for jaw, column, row in holes:
        x, y = VISE.carriers[jaw == "right"].compute_hole_center(column, row, jaw_separation)
        pegs.append(Peg("right" if jaw == "right" else "left", column, row, x, y, 0, 0.5))
    return Fixture("I", (pegs[0], pegs[1], pegs[2], pegs[3]), pose, jaw_separation, {})


POSES = [Pose(0.0, 0.0, 0.0), Pose(123.4, 31.7, -8.9)]


def bodies(pose: Pose) -> dict[str, list[Solid]]:
    """The solids of a set-up as read again: the part, pegs and plates, told apart by where they lie in z."""
    kinds: dict[str, list[Solid]] = {"part": [], "peg": [], "plate": []}
    for solid in read_solids(
        make_setup_step(fixture(pose), part(pose), VISE, thickness=12, plate_thickness=8)
    ):
        low, high = round(solid.low[2], 9), round(solid.high[2], 9)
        kinds[{(0, 12): "part", (-8, 12): "peg", (-8, 0): "plate"}[low, high]].append(solid)
    return kinds


def distance(shape: Any, other: Any) -> float:
    """Distance of two shapes in mm."""
    return float(BRepExtrema_DistShapeShape(shape, other).Value())


@pytest.mark.parametrize("pose", POSES)
def test_every_peg_axis_is_one_radius_from_the_part(pose: Pose) -> None:
    """The distance from each peg's axis to the part is the peg radius to 1e-6 mm, so that pegs only touch it."""
    kinds = bodies(pose)
    assert [len(kinds[kind]) for kind in ("part", "peg", "plate")] == [1, 4, 2]
    for peg in fixture(pose).pegs:
        axis = BRepBuilderAPI_MakeEdge(gp_Pnt(peg.x, peg.y, 0), gp_Pnt(peg.x, peg.y, 12)).Edge()
        assert distance(axis, kinds["part"][0].shape) == pytest.approx(3, abs=1e-6)
    for peg_body in kinds["peg"]:
        assert distance(peg_body.shape, kinds["part"][0].shape) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("pose", POSES)
def test_volumes_are_those_of_prisms(pose: Pose) -> None:
    """Part: its area times its height. Pegs: cylinders. Plates: a box with the holes of both columns, of five rows under the
    part on the left and of four on the right."""
    kinds = bodies(pose)
    assert kinds["part"][0].volume == pytest.approx(12 * LYING_AREA, rel=1e-9)
    assert [peg.volume for peg in kinds["peg"]] == pytest.approx([20 * pi * 9] * 4, rel=1e-9)
    assert [plate.volume for plate in kinds["plate"]] == pytest.approx(
        [8 * (20 * 12 * rows - 2 * rows * 9 * pi) for rows in (5, 4)], rel=1e-9
    )


@pytest.mark.parametrize("pose", POSES)
def test_pegs_stand_in_holes_of_the_plates(pose: Pose) -> None:
    """The wall of its hole is one radius around each peg's axis."""
    left, right = sorted(bodies(pose)["plate"], key=lambda plate: plate.low[0])
    for peg in fixture(pose).pegs:
        axis = BRepBuilderAPI_MakeEdge(gp_Pnt(peg.x, peg.y, -7), gp_Pnt(peg.x, peg.y, -1)).Edge()
        own = left if peg.carrier == "left" else right
        assert distance(axis, own.shape) == pytest.approx(3, abs=1e-9)


def test_bodies_are_named_by_what_they_are() -> None:
    """The part by its name, pegs by their holes, plates by their jaws; lengths are millimetres."""
    text = make_setup_step(fixture(POSES[1]), part(POSES[1], "Joe's bracket"), VISE).decode()
    names = re.findall(r"PRODUCT\('((?:[^']|'')*)'", text)
    pegs = ["peg L-A1", "peg L-A3", "peg R-B1", "peg R-B3"]
    assert names == [
        "Joe''s bracket set-up",
        "Joe''s bracket",
        *pegs,
        "left jaw",
        "right jaw",
        "part zero X0 Y0",
    ]
    assert "SI_UNIT(.MILLI.,.METRE.)" in text


@pytest.mark.parametrize("pose", POSES)
def test_part_zero_stands_where_it_was_asked_for(pose: Pose) -> None:
    """The three ends of its axes: the centre of the hole, a pitch along the part's x and half of one along its y."""
    zero = choose_part_zero(part(pose), "hole 1")
    reader = STEPControl_Reader()
    reader.ReadStream("zero.step", BytesIO(make_setup_step(fixture(pose), part(pose), VISE, zero=zero)))
    reader.TransferRoots()
    shape = reader.OneShape()
    loose, ends = TopExp_Explorer(shape, TopAbs_VERTEX, TopAbs_FACE), set()
    while loose.More():
        point = BRep_Tool.Pnt_s(TopoDS.Vertex(loose.Current()))
        ends.add((round(point.X(), 6), round(point.Y(), 6), round(point.Z(), 6)))
        loose.Next()
    along = exp(1j * radians(pose.theta_deg))
    places = [complex(40, 15), complex(40, 15) + 10 * along, complex(40, 15) + 5j * along]
    assert ends == {(round(z.real, 6), round(z.imag, 6), 0.0) for z in places}


def test_pegs_are_as_long_as_asked_for() -> None:
    """Pegs 15 mm long that stand 6 mm out of the plates."""
    solids = read_solids(
        make_setup_step(fixture(POSES[0]), part(POSES[0]), VISE, peg_length=15, peg_height=6)
    )
    heights = [(round(solid.low[2], 9), round(solid.high[2], 9)) for solid in solids]
    assert heights.count((-9.0, 6.0)) == 4


def test_the_same_set_up_gives_the_same_bytes(tmp_path: Path) -> None:
    """No date, and no numbers that count through the life of the process."""
    first, second = tmp_path / "first.step", tmp_path / "second.step"
    for path in (first, second):
        write_setup_step(fixture(POSES[1]), part(POSES[1]), VISE, path)
    assert first.read_bytes() == second.read_bytes()
    assert b"1970-01-01T00:00:00" in first.read_bytes()[:400]


def test_plates_of_a_nearly_closed_vise_do_not_overlap() -> None:
    """With a jaw separation below two radii the plates end inside their holes, and apart from each other."""
    solids = read_solids(make_setup_step(fixture(POSES[0], 4.0), part(POSES[0]), VISE))
    left, right = sorted((s for s in solids if s.high[2] < 1e-9), key=lambda plate: plate.low[0])
    assert left.high[0] < right.low[0]
    assert left.volume < 10 * (left.high[0] - left.low[0]) * (left.high[1] - left.low[1]) - 10 * pi * 9


@pytest.mark.parametrize(
    ("radius", "options", "said"),
    [
        (0.0, {}, "pegs of radius 0 have no body"),
        (3.0, {"thickness": 0.0}, "thickness 0.0 is not a positive length"),
        (3.0, {"peg_length": -1.0}, "peg length -1.0 is not a positive length"),
        (3.0, {"plate_thickness": float("nan")}, "plate thickness nan is not a positive length"),
    ],
)
def test_what_has_no_body_is_refused(radius: float, options: dict[str, float], said: str) -> None:
    """Points for pegs, and bodies of no thickness."""
    with pytest.raises(InputError, match=said):
        make_setup_step(fixture(POSES[0]), part(POSES[0]), attrs.evolve(VISE, peg_radius=radius), **options)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("bolted", [True, False], ids=["bolted", "line"])
def test_a_plate_has_its_locators_and_its_clamp(way: str, bolted: bool) -> None:
    """One plate, three dowels through it, the clamp's body on it, which touches the part and enters nothing, its bolt."""
    fixture, workpiece, plate = on_plate(way, bolted)
    text = make_setup_step(fixture, workpiece, plate, thickness=12, plate_thickness=8)
    named = re.findall(r"PRODUCT\('((?:[^']|'')*)'", text.decode())
    dowels = [f"locator {peg.hole}" for peg in fixture.pegs[:3]]
    tip = fixture.pegs[3]
    bolt = [f"bolt {tip.hole.removeprefix('clamp ')}"] if bolted else []
    assert named == ["rectangle set-up", "rectangle", *dowels, tip.hole, *bolt, "plate", "part zero X0 Y0"]
    solids = read_solids(text)
    heights = [(round(solid.low[2], 6), round(solid.high[2], 6)) for solid in solids]
    assert sorted(heights) == [*[(-8, 0)] * (1 + bolted), *[(-8, 12)] * 3, (0, 12), (0, 12)]
    body, part = sorted((one for one in solids if round(one.low[2], 6) == 0), key=lambda solid: solid.volume)
    length = abs(fixture.travel) if bolted else 0.0
    assert body.volume == pytest.approx(12 * (pi * 25 + 10 * length), rel=1e-9)
    assert distance(body.shape, part.shape) == pytest.approx(0, abs=1e-6)
    axis = BRepBuilderAPI_MakeEdge(gp_Pnt(tip.x, tip.y, 0), gp_Pnt(tip.x, tip.y, 12)).Edge()
    assert distance(axis, part.shape) == pytest.approx(5, abs=1e-6)
    for peg in fixture.pegs[:3]:
        axis = BRepBuilderAPI_MakeEdge(gp_Pnt(peg.x, peg.y, 0), gp_Pnt(peg.x, peg.y, 12)).Edge()
        assert distance(axis, part.shape) == pytest.approx(5, abs=1e-6)
        assert distance(axis, body.shape) > 5


def test_pegs_with_flats_are_round_in_their_holes_and_flat_on_the_part() -> None:
    """Their volumes are those of cylinders, less a segment of a circle above the plate; each touches the part."""
    vise = Vise((9, 8), 2, 2.5, flat=1.5)
    block = Workpiece.from_loops("block", [[[0, 0, 0], [40, 6, 0], [34, 36, 0], [-4, 30, 0]]])
    held = design(block, vise, best=1)[0]
    assert all(peg.flat_deg is not None for peg in held.pegs)
    solids = read_solids(make_setup_step(held, block, vise, thickness=10, plate_thickness=7))
    pegs = [solid for solid in solids if (round(solid.low[2], 6), round(solid.high[2], 6)) == (-7, 10)]
    (lying,) = [solid for solid in solids if (round(solid.low[2], 6), round(solid.high[2], 6)) == (0, 10)]
    cut = 2.5**2 * acos(1.5 / 2.5) - 1.5 * sqrt(2.5**2 - 1.5**2)
    assert [peg.volume for peg in pegs] == pytest.approx([17 * pi * 2.5**2 - 10 * cut] * 4, rel=1e-7)
    for peg in pegs:
        assert distance(peg.shape, lying.shape) == pytest.approx(0, abs=1e-6)
    for peg in held.pegs:
        axis = BRepBuilderAPI_MakeEdge(gp_Pnt(peg.x, peg.y, 0), gp_Pnt(peg.x, peg.y, 10)).Edge()
        assert distance(axis, lying.shape) == pytest.approx(1.5, abs=1e-6)


def test_bodies_have_the_colours_of_their_kinds() -> None:
    """Read again by the library: each solid has its kind's colour, as on a screen."""
    seen = [kind for _, kind, _ in named_bodies(make_setup_step(fixture(POSES[1]), part(POSES[1]), VISE))]
    assert seen == ["part", *["peg"] * 4, *["plate"] * 2]
