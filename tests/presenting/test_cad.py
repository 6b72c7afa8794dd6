"""Parts of build123d and CadQuery, and fixtures that become assemblies of theirs.

CadQuery asks for an older Open CASCADE than the extra ``step``, so a stand-in of three names takes its place.
"""

from __future__ import annotations

import re
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import workhold
from workhold.errors import InputError

VISE = workhold.Vise(pitch=10, columns=2, peg_radius=3)
FINE = workhold.Vise(pitch=7, columns=3, peg_radius=2)


def stepped() -> Any:
    """A block of 60 x 40 x 10 mm with a corner cut off and a lug, away from its model's origin."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeWedge
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    block = BRepPrimAPI_MakeBox(gp_Pnt(105.0, -57.0, 33.0), 60.0, 40.0, 10.0).Shape()
    lug = BRepPrimAPI_MakeBox(gp_Pnt(125.0, -42.0, 43.0), 12.0, 10.0, 8.0).Shape()
    corner = gp_Ax2(gp_Pnt(105.0, -57.0, 33.0), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0))
    cut = BRepPrimAPI_MakeWedge(corner, 12.0, 9.0, 10.0, 0.0).Shape()
    return BRepAlgoAPI_Cut(BRepAlgoAPI_Fuse(block, lug).Shape(), cut).Shape()


def first_choice(shape: Any, up: Any, vise: workhold.Vise = VISE) -> workhold.Fixture:
    """The best fixture of a shape with an axis up, with pegs of 6 mm."""
    part = workhold.from_build123d(shape, up=up, name="stepped", peg_height=6.0)
    return workhold.design(part, vise, best=1)[0]


def distance(one: Any, other: Any) -> float:
    """The distance of two shapes, and minus their common volume where they have one."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    inside = GProp_GProps()
    BRepGProp.VolumeProperties_s(BRepAlgoAPI_Common(one, other).Shape(), inside)
    if inside.Mass() > 1e-6:
        return -float(inside.Mass())
    return float(BRepExtrema_DistShapeShape(one, other).Value())


class CadQuery(ModuleType):
    """The three names of CadQuery that an assembly is made of."""

    class Assembly(list[SimpleNamespace]):
        """A list of what was added."""

        def __init__(self, name: str) -> None:
            self.name = name

        def add(self, shape: Any, name: str, color: tuple[float, ...]) -> None:
            self.append(SimpleNamespace(shape=shape, name=name, color=color))

    Shape = SimpleNamespace(cast=lambda shape: shape)

    @staticmethod
    def Color(*parts: float) -> tuple[float, ...]:
        return parts


@pytest.fixture
def cadquery(monkeypatch: pytest.MonkeyPatch) -> None:
    """The stand-in, in the place of CadQuery."""
    monkeypatch.setitem(sys.modules, "cadquery", CadQuery("cadquery"))


@pytest.mark.parametrize(
    ("up", "name"),
    [
        ("z", "z"),
        (" +Z", "z"),
        ("-y", "-y"),
        ((0, 0, -3), "-z"),
        (SimpleNamespace(direction=(1.0, 1e-12, 0.0)), "x"),
        (SimpleNamespace(z_dir=(0.0, 0.0, -1.0)), "-z"),
        (SimpleNamespace(zDir=SimpleNamespace(toTuple=lambda: (0.0, -1.0, 0.0))), "-y"),
    ],
)
def test_an_axis_is_named_by_what_people_have(up: Any, name: str) -> None:
    from workhold.presenting.assembly import find_axis_name

    assert find_axis_name(up) == name


@pytest.mark.parametrize(
    ("up", "words"),
    [((1, 1, 0), r"along none of x, y and z"), ((0, 0, 0), "along none"), (3, "int is not a direction")],
)
def test_a_direction_along_no_axis_is_refused(up: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        workhold.from_build123d(None, up=up)


@pytest.mark.thorough
@pytest.mark.parametrize(("up", "vise"), [("z", VISE), ((0, -1, 0), VISE), ("-x", FINE), ("-z", FINE)])
def test_bodies_stand_about_the_part_where_it_lies(up: Any, vise: workhold.Vise, cadquery: None) -> None:
    """Each peg touches the part's own solid and enters nothing, and the plates lie under it."""
    shape = stepped()
    first = first_choice(shape, up, vise)
    bodies = first.to_cadquery(around=shape)
    assert bodies.name == "stepped fixture 1"
    part, *others = bodies
    assert part.name == "stepped" and distance(part.shape, shape) == pytest.approx(-24_420.0)
    assert [one.name for one in others[:4]] == [f"peg {peg.hole}" for peg in first.pegs]
    assert [distance(part.shape, one.shape) for one in others] == pytest.approx([0.0] * len(others), abs=1e-6)


@pytest.mark.thorough
def test_supports_stand_under_the_part(cadquery: None) -> None:
    shape = stepped()
    first = first_choice(shape, "z", FINE)
    found = first.supports(best=1, pad_radius=2)
    bodies = {one.name: one.shape for one in first.to_cadquery(around=shape, supports=found)}
    pads = [name for name in bodies if name.startswith("support")]
    assert len(pads) == 3
    for name in pads:
        assert distance(bodies["stepped"], bodies[name]) == pytest.approx(0.0, abs=1e-6)
    assert distance(bodies["stepped"], bodies["left jaw"]) == pytest.approx(10.0)


@pytest.mark.thorough
def test_without_its_solid_the_part_is_a_prism_in_the_frame_of_the_toolkit(cadquery: None) -> None:
    first = first_choice(stepped(), "z")
    part, *others = first.to_cadquery()
    assert [distance(part.shape, one.shape) for one in others] == pytest.approx([0.0] * len(others), abs=1e-6)
    assert part.color == (0.36, 0.56, 0.82, 1.0)


@pytest.mark.thorough
def test_another_part_is_refused(cadquery: None) -> None:
    """Of another size, of several solids, or one that was drawn and not modelled."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    first = first_choice(stepped(), "z")
    with pytest.raises(InputError, match=r"around is another part than stepped"):
        first.to_cadquery(around=BRepPrimAPI_MakeBox(60.0, 40.0, 10.0).Shape())
    with pytest.raises(InputError, match="0 solids"):
        first.to_cadquery(around=object())
    wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    drawn = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2), best=1)[0]
    with pytest.raises(InputError, match="not read from a solid"):
        drawn.to_cadquery(around=stepped())


def test_a_library_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cadquery", None)
    with pytest.raises(InputError, match=re.escape("pip install 'cadquery>=2.5'")):
        first_choice(stepped(), "z").to_cadquery()


@pytest.mark.thorough
def test_build123d_has_an_assembly_with_names_and_colours() -> None:
    build123d = pytest.importorskip("build123d", reason="the extra 'build123d' is not installed")
    part = build123d.Pos(5, -7, 33) * (build123d.Box(60, 40, 10) - build123d.Cylinder(6, 10))
    workpiece = workhold.from_build123d(part, up=build123d.Axis.Z, name="drilled")
    first = workhold.design(workpiece, VISE, best=1)[0]
    made = first.to_build123d(around=part)
    assert made.label == "drilled fixture 1"
    assert [child.label for child in made.children] == [
        "drilled",
        *(f"peg {peg.hole}" for peg in first.pegs),
        "left jaw",
        "right jaw",
    ]
    assert made.children[0].volume == pytest.approx(part.volume)
    assert tuple(made.children[1].color)[:3] == pytest.approx((0.85, 0.55, 0.15), abs=1e-6)
    for child in made.children[1:]:
        assert part.distance_to(child) == pytest.approx(0.0, abs=1e-6)
