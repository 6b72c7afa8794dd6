"""Twenty parts as they come to a workshop, with the vise that each would be held in, for the bench of first choices.

Sizes are those of catalogues where there are any: motor plates by NEMA ICS 16 (bolt circles and bosses of frames 17, 23 and
34), the others drawn as such parts are. Lengths are in mm, or in inches where the part is.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, cos, hypot, pi, sin, sqrt, tan
from pathlib import Path

from attrs import frozen

from workhold.files.part.load import load
from workhold.fixels.vise import Vise
from workhold.model.requirements import Restrictions
from workhold.model.workpiece import Workpiece
from workhold.units import INCH, MILLIMETRE, Unit

__all__ = ["PARTS", "ShopPart"]

DRAWINGS = Path(__file__).parents[1] / "tests" / "data" / "drawings"
EXAMPLES = Path(__file__).parents[1] / "examples"
Vertex = tuple[float, float, float]
Loop = list[Vertex]
QUARTER = tan(pi / 8)


@frozen
class ShopPart:
    """A part and how it is to be held.

    Parameters
    ----------
    name, words : what it is called, and what it is.
    make : gives the part.
    vise : to hold it in.
    avoid : faces that will be machined.
    unit : of its drawing.
    """

    name: str
    words: str
    make: Callable[[], Workpiece]
    vise: Vise
    avoid: tuple[int, ...] = ()
    unit: Unit = MILLIMETRE

    @property
    def restrictions(self) -> Restrictions:
        """What is ruled out."""
        return Restrictions(avoid=self.avoid)


def polygon(*points: tuple[float, float]) -> Loop:
    """Straight sides between points."""
    return [(x, y, 0.0) for x, y in points]


def rectangle(width: float, height: float, radius: float = 0.0, at: tuple[float, float] = (0.0, 0.0)) -> Loop:
    """A rectangle about a point, its corners rounded."""
    a, b = width / 2, height / 2
    x, y = at
    if radius == 0:
        return polygon((x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b))
    return [
        *((x - a + radius, y - b, 0.0), (x + a - radius, y - b, QUARTER)),
        *((x + a, y - b + radius, 0.0), (x + a, y + b - radius, QUARTER)),
        *((x + a - radius, y + b, 0.0), (x - a + radius, y + b, QUARTER)),
        *((x - a, y + b - radius, 0.0), (x - a, y - b + radius, QUARTER)),
    ]


def chamfered(width: float, height: float, cut: float) -> Loop:
    """A rectangle about the origin, its corners cut."""
    a, b = width / 2, height / 2
    corners = (
        (-a + cut, -b),
        (a - cut, -b),
        (a, -b + cut),
        (a, b - cut),
        (a - cut, b),
        (-a + cut, b),
        (-a, b - cut),
    )
    return polygon(*corners, (-a, -b + cut))


def circle(x: float, y: float, diameter: float) -> Loop:
    """A round hole."""
    r = diameter / 2
    return [(x - r, y, 1.0), (x + r, y, 1.0)]


def slot(x: float, y: float, length: float, width: float) -> Loop:
    """A slot along x about a point, with round ends; its length is between their centres."""
    a, r = length / 2, width / 2
    return [(x - a, y - r, 0.0), (x + a, y - r, 1.0), (x + a, y + r, 0.0), (x - a, y + r, 1.0)]


def four(distance: float, diameter: float) -> list[Loop]:
    """Four bolt holes in a square."""
    h = distance / 2
    return [circle(x, y, diameter) for x, y in ((-h, -h), (h, -h), (h, h), (-h, h))]


def part(name: str, *loops: Loop, unit: Unit = MILLIMETRE) -> Callable[[], Workpiece]:
    """A part of loops in a unit."""
    return lambda: Workpiece.from_loops(
        name, [[[unit.to_mm(x), unit.to_mm(y), bulge] for x, y, bulge in loop] for loop in loops]
    )


def lever(length: float, large: float, small: float) -> Loop:
    """Two round bosses and their outer tangents."""
    lean = (large - small) / length
    rise = sqrt(1 - lean * lean)
    # From the lower tangent point of the large boss along the lower tangent, round the small one and back.
    half = atan2(rise, lean)
    return [
        (large * lean, -large * rise, 0.0),
        (length + small * lean, -small * rise, tan(half / 2)),
        (length + small * lean, small * rise, 0.0),
        (large * lean, large * rise, tan((pi - half) / 2)),
    ]


def flats(diameter: float, across: float) -> Loop:
    """A round with two flats along x."""
    r, h = diameter / 2, across / 2
    w = sqrt(r * r - h * h)
    bulge = tan(atan2(h, w) / 2)
    return [(-w, -h, 0.0), (w, -h, bulge), (w, h, 0.0), (-w, h, bulge)]


def hexagon(across: float) -> Loop:
    """A regular hexagon, two of its sides along x."""
    r = across / sqrt(3)
    return polygon(*((r * cos(k * pi / 3), r * sin(k * pi / 3)) for k in range(6)))


def bearing_block(width: float, foot: float, radius: float, height: float) -> Loop:
    """A foot with a round top that leans tangentially on its corners."""
    x, y = width / 2, foot
    far = hypot(x, height - y)
    # The tangent from the corner (x, y) to the circle about (0, height).
    angle = atan2(y - height, x) + atan2(sqrt(far * far - radius * radius), radius)
    tx, ty = radius * cos(angle), height + radius * sin(angle)
    return [
        (-x, 0.0, 0.0),
        (x, 0.0, 0.0),
        (x, y, 0.0),
        (tx, ty, tan((pi - 2 * angle) / 4)),
        (-tx, ty, 0.0),
        (-x, y, 0.0),
    ]


def drawing(name: str, folder: Path = DRAWINGS, unit: str | None = None) -> Callable[[], Workpiece]:
    """A part from a file; the unit is for drawings that give none."""
    return lambda: load(folder / name, unit=unit)


FINE = Vise(pitch=10, columns=4, peg_radius=3)
PLATE = Vise(pitch=20, columns=3, peg_radius=3)
TABLE = Vise(pitch=50, columns=3, peg_radius=8)
SMALL = Vise(pitch=5, columns=4, peg_radius=1.5)
HALF_INCH = Vise(pitch=12.7, columns=4, peg_radius=3.175)

L_BRACKET = [
    *((0, 0, 0), (100, 0, 0), (100, 20, 0), (28, 20, -QUARTER), (20, 28, 0), (20, 80, 0), (0, 80, 0)),
]
CLEVIS: Loop = [
    *(
        (0, -20, 0.0),
        (60, -20, 0.0),
        (60, -8, 0.0),
        (28, -8, -1.0),
        (28, 8, 0.0),
        (60, 8, 0.0),
        (60, 20, 0.0),
        (0, 20, 1.0),
    ),
]
HINGE = polygon(
    *(
        (0, 0),
        (80, 0),
        (80, 40),
        (64, 40),
        (64, 52),
        (48, 52),
        (48, 40),
        (32, 40),
        (32, 52),
        (16, 52),
        (16, 40),
        (0, 40),
    )
)

PARTS = (
    ShopPart("bracket", "lever plate of the examples", drawing("bracket.dxf", EXAMPLES), Vise(10, 2, 3)),
    ShopPart("rectangle", "plain bar 60 x 40", part("rectangle", rectangle(60, 40)), FINE),
    ShopPart(
        "nema-17",
        "motor plate",
        part("nema-17", chamfered(42.3, 42.3, 4), circle(0, 0, 22), *four(31, 3.2)),
        FINE,
    ),
    ShopPart(
        "nema-23",
        "motor plate, drawn in inches",
        part("nema-23", rectangle(2.25, 2.25, 0.19), circle(0, 0, 1.5), *four(1.856, 0.2), unit=INCH),
        HALF_INCH,
        unit=INCH,
    ),
    ShopPart(
        "nema-34",
        "motor plate in inches, one side to be milled",
        part("nema-34", rectangle(3.4, 3.4, 0.25), circle(0, 0, 2.875), *four(2.74, 0.26), unit=INCH),
        HALF_INCH,
        avoid=(4,),
        unit=INCH,
    ),
    ShopPart(
        "motor-mount",
        "mount of a lab robot (Opentrons, Apache-2.0)",
        drawing("motor_mount_plate.dxf", unit="mm"),
        PLATE,
    ),
    ShopPart(
        "channel",
        "steel channel in section, 12 inches deep (CadQuery, Apache-2.0)",
        drawing("mc_12x31.dxf"),
        TABLE,
    ),
    ShopPart("v-slot", "2020 profile (CadQuery, Apache-2.0)", drawing("vslot_2020.dxf"), SMALL),
    ShopPart(
        "l-bracket",
        "angle bracket",
        part("l-bracket", L_BRACKET, circle(60, 10, 8), circle(10, 50, 8)),
        PLATE,
    ),
    ShopPart(
        "gusset",
        "gusset plate with a cut corner",
        part("gusset", polygon((0, 0), (120, 0), (120, 15), (15, 80), (0, 80))),
        PLATE,
    ),
    ShopPart("hinge", "hinge leaf", part("hinge", HINGE, circle(20, 20, 6), circle(60, 20, 6)), FINE),
    ShopPart("clevis", "fork", part("clevis", CLEVIS, circle(6, 0, 10)), FINE),
    ShopPart(
        "lever",
        "lever with two bosses",
        part("lever", lever(90, 22, 12), circle(0, 0, 20), circle(90, 0, 10)),
        FINE,
    ),
    ShopPart(
        "cover",
        "cover plate with slots, one long side to be milled",
        part("cover", rectangle(120, 90, 10), slot(0, 25, 60, 8), slot(0, -25, 60, 8), *four(70, 6)),
        PLATE,
        avoid=(4,),
    ),
    ShopPart(
        "flat-flange",
        "round flange with two flats",
        part("flat-flange", flats(80, 64), circle(0, 0, 30)),
        FINE,
    ),
    ShopPart("oval-flange", "oval flange", (lambda: load("flange")), Vise(10, 2, 3)),
    ShopPart(
        "hexagon", "hexagon, 55 across flats, bored", part("hexagon", hexagon(55), circle(0, 0, 24)), FINE
    ),
    ShopPart(
        "tee",
        "tee bracket in inches",
        part(
            "tee",
            polygon(
                (0, 0), (4, 0), (4, 0.75), (2.375, 0.75), (2.375, 3), (1.625, 3), (1.625, 0.75), (0, 0.75)
            ),
            unit=INCH,
        ),
        HALF_INCH,
        unit=INCH,
    ),
    ShopPart(
        "dovetail",
        "slide blank, ends at 60 degrees",
        part("dovetail", polygon((0, 0), (100, 0), (80, 34.6), (20, 34.6))),
        FINE,
    ),
    ShopPart(
        "bearing-block",
        "bearing block",
        part("bearing-block", bearing_block(90, 14, 26, 42), circle(0, 42, 32)),
        FINE,
    ),
)
