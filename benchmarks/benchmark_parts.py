"""The workpieces of the benchmark set, each with the reason why it is there, its source and its licence.

Those of the paper, real outlines, parts of the workshop and parts that once brought out a fault are read; the families are
drawn here. Every family varies one thing that a program may get wrong. Lengths are in mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, radians, sin, tan
from pathlib import Path

from attrs import frozen

from shop_parts import PARTS, QUARTER, Loop, bearing_block, circle, flats, hexagon, lever, polygon, rectangle
from workhold.files.part.load import load
from workhold.model.workpiece import Workpiece

__all__ = ["BenchmarkPart", "benchmark_parts"]

OWN = "the project", "Apache-2.0"
OTHERS = {
    "motor-mount": "Opentrons/otone_hardware, models/1002_Motor_Mount_Plate.dxf",
    "channel": "CadQuery/cadquery, tests/testdata/MC 12x31.dxf",
    "v-slot": "CadQuery/cadquery, doc/vslot-2020_1.dxf",
}


@frozen
class BenchmarkPart:
    """A workpiece with where it is from and what it is to show."""

    workpiece: Workpiece
    family: str
    reason: str
    source: str = OWN[0]
    licence: str = OWN[1]


def regular(sides: int, radius: float, turned: float = 0.0) -> Loop:
    """A regular polygon about the origin."""
    angles = [turned + 2 * pi * k / sides for k in range(sides)]
    return polygon(*((radius * cos(a), radius * sin(a)) for a in angles))


def lobes(count: int, distance: float, radius: float) -> Loop:
    """Round bosses of one radius at the corners of a regular polygon, and their outer tangents."""
    out: Loop = []
    for k in range(count):
        x, y = distance * cos(2 * pi * k / count), distance * sin(2 * pi * k / count)
        for at, bulge in ((-pi / count, tan(pi / count / 2)), (pi / count, 0.0)):
            angle = 2 * pi * k / count + at
            out.append((x + radius * cos(angle), y + radius * sin(angle), bulge))
    return out


def star(points: int, outer: float, inner: float) -> Loop:
    """A star with as many points."""
    radii = [outer, inner] * points
    return polygon(*((r * cos(pi * k / points), r * sin(pi * k / points)) for k, r in enumerate(radii)))


def wedge(width: float, height: float, angle: float) -> Loop:
    """A block whose upper side leans by an angle in radians."""
    return polygon((0, 0), (width, 0), (width, height + width * tan(angle)), (0, height))


def cross(arm: float, width: float) -> Loop:
    """A plus sign."""
    a, w = arm, width / 2
    first = [(a, -w), (a, w), (w, w)]
    return polygon(*[p for k in range(4) for p in (turn(q, k) for q in first)])


def turn(point: tuple[float, float], quarters: int) -> tuple[float, float]:
    """A point after some quarter turns."""
    for _ in range(quarters):
        point = -point[1], point[0]
    return point


def reversed_loop(loop: Loop) -> Loop:
    """The same loop the other way round, as holes run."""
    n = len(loop)
    return [(loop[-k % n][0], loop[-k % n][1], -loop[(-k - 1) % n][2]) for k in range(n)]


def sector(inner: float, outer: float, half: float) -> Loop:
    """A piece of a ring about the origin, half its angle in degrees."""
    a, bulge = radians(half), tan(radians(half) / 2)
    low, high = (cos(a), -sin(a)), (cos(a), sin(a))
    return [
        (outer * low[0], outer * low[1], bulge),
        (outer * high[0], outer * high[1], 0.0),
        (inner * high[0], inner * high[1], -bulge),
        (inner * low[0], inner * low[1], 0.0),
    ]


BITTEN: Loop = [
    (0, 0, 0),
    (20, 0, -QUARTER),
    (30, 10, -QUARTER),
    (40, 0, 0),
    (64, 0, 0),
    (58, 40, 0),
    (6, 36, 0),
]
SNUG: Loop = [(0, 0, 0), (26, 0, -1.0), (32, 0, 0), (60, 0, 0), (56, 42, 0), (0, 36, 0)]
BLENDED: Loop = [
    (0, 0, 0),
    (50, 0, QUARTER),
    (60, 10, 0),
    (60, 20, -QUARTER),
    (66, 26, 0),
    (66, 44, 0),
    (0, 38, 0),
]
DISH: Loop = [(0, 0, 0), (60, 0, 0), (60, 34, -0.2), (0, 34, 0)]
SADDLE = polygon((0, 0), (16, 0), (22, 9), (36, 9), (42, 0), (60, 0), (47, 38), (9, 34))
KITE = polygon((0, 0), (56, 6), (48, 44), (10, 37))
HOUSE = polygon((0, 0), (60, 0), (60, 30), (30, 52), (0, 30))
L_PLATE = polygon((0, 0), (60, 0), (60, 22), (24, 22), (24, 58), (0, 58))
TEE = polygon((0, 0), (70, 0), (70, 18), (44, 18), (44, 52), (26, 52), (26, 18), (0, 18))
ZED = polygon((0, 0), (44, 0), (44, 24), (66, 24), (66, 44), (22, 44), (22, 20), (0, 20))
U_PART = polygon((0, 0), (64, 0), (64, 48), (46, 48), (46, 16), (18, 16), (18, 48), (0, 48))
NICKED = polygon((0, 0), (30, 0), (30, 5.5), (35.5, 5.5), (35.5, 0), (66, 0), (60, 40), (4, 38))
CHIPPED = polygon((0.01, 0), (60, 0), (60, 40), (0.02, 40), (0, 39.98), (0, 0.01))
SLOPED = polygon((0, 0), (60, 0), (60.00001, 40), (0, 40))
WINDOW = [(12.0, 14.0, 0.0), (16.0, 40.0, 0.0), (52.0, 42.0, -0.45), (50.0, 10.0, 0.0)]

# Name, loops, reason; by family.
FAMILIES: dict[str, tuple[tuple[str, list[Loop], str], ...]] = {
    "tangent joints": (
        ("stadium", [lever(44, 14, 14)], "sides meet two half circles tangentially: a contact at the joint is one"),
        ("lever-tangent", [lever(60, 22, 12)], "two bosses of different radius with their outer tangents"),
        ("rounded-square", [rectangle(54, 54, 12)], "four tangent corners, symmetric besides"),
        ("rounded-bar", [rectangle(80, 30, 15 - 1e-3)], "end sides only 0.002 mm long between tangent arcs"),
        ("blended", [BLENDED], "a convex arc, a line and a concave arc joined tangentially"),
        ("arch", [bearing_block(70, 12, 24, 30)], "a round top that leans tangentially on the corners of its foot"),
        ("dee", [[(-20, -15, 0.0), (20, -15, 0.0), (20, 15, 0.0), (-20, 15, 1.0)]], "a half circle between two sides"),
    ),
    "near-parallel sides": (
        ("wedge-1deg", [wedge(64, 36, radians(1))], "sides 1 degree off: poses run far along the wedge"),
        ("wedge-3e-3", [wedge(64, 36, 3e-3)], "sides 0.003 rad off: what a drawing with a draft has"),
        ("wedge-1e-5", [wedge(64, 36, 1e-5)], "sides 0.00001 rad off: parallel to the eye, not to the rule"),
        ("wedge-1e-10", [wedge(64, 36, 1e-10)], "sides 1e-10 rad off: parallel by the rule of 1e-9"),
        ("sloped", [SLOPED], "one side 0.00025 mm a metre off square: rounding of a drawing"),
        ("parallelogram", [polygon((0, 0), (60, 0), (72, 38), (12, 38))], "two pairs of parallel sides, not square"),
    ),
    "equal arcs": (
        ("bosses-at-pitch", [lever(40, 10, 10)], "equal arcs exactly two pitches of 20 apart: chords that slide"),
        ("bosses-near-pitch", [lever(40.000001, 10, 10)], "the same, 0.000001 mm off"),
        ("bosses-off-pitch", [lever(40.01, 10, 10)], "the same, 0.01 mm off: the distance a measuring machine sees"),
        ("three-lobes", [lobes(3, 22, 9)], "three equal arcs at the corners of a triangle"),
        ("four-lobes", [lobes(4, 24, 8)], "four equal arcs whose centres form a square"),
        ("two-bores", [rectangle(72, 40), circle(-20, 0, 20), circle(20, 0, 20)], "equal bores two pitches apart"),
        ("ring-piece", [sector(26, 44, 30)], "concentric arcs: of three contacts on them the normals meet in a point"),
        ("bitten", [BITTEN], "two equal concave arcs, one after the other"),
    ),
    "slivers": (
        ("strip", [rectangle(110, 2.5)], "a strip thinner than a peg"),
        ("needle", [polygon((0, 0), (90, 0), (90, 4))], "a triangle with an angle of 2.5 degrees"),
        ("nicked", [NICKED], "a nick half a millimetre too narrow for a peg of radius 3"),
        ("chipped", [CHIPPED], "corners broken by 0.01 and 0.02 mm: faces shorter than any contact"),
        ("dish", [DISH], "a shallow concave arc of a large radius"),
        ("snug", [SNUG], "a concave half circle of the pegs' own radius, which a peg fills"),
        ("spikes", [star(5, 38, 12)], "sharp points and deep notches"),
    ),
    "symmetric": (
        ("square", [rectangle(50, 50)], "four rotations, four mirrors; none with one clamp"),
        ("triangle", [regular(3, 34)], "three rotations: sets of three in every list"),
        ("pentagon", [regular(5, 32)], "five rotations, no two sides parallel"),
        ("hexagon-plain", [hexagon(52)], "six rotations, three pairs of parallel sides"),
        ("octagon", [regular(8, 30, pi / 8)], "eight rotations, sides in pairs square to each other"),
        ("six-lobes", [lobes(6, 24, 6)], "six rotations, arcs and lines"),
        ("plus", [cross(34, 22)], "four rotations with notches"),
        ("ess", [ZED], "half a turn and no mirror image"),
        ("window", [rectangle(70, 54), reversed_loop(rectangle(40, 26))], "pegs outside and in a hole"),
    ),
    "none in some kinds": (
        ("disc", [circle(0, 0, 50)], "one circle: no fixture in any toolkit, whatever the rounding pretends"),
        ("ring", [circle(0, 0, 60), circle(0, 0, 36)], "two concentric circles: the same"),
        ("bar", [rectangle(60, 34)], "a rectangle: none against a fence with one clamp, nor in a flat jaw"),
        ("el", [L_PLATE], "rectilinear, but not convex: some against a fence, on the edge across its notch"),
        ("crumb", [rectangle(7, 5)], "smaller than a pitch: too few holes near it"),
    ),
    "plain": (
        ("kite", [KITE], "four sides, no two parallel: the simplest part with many fixtures"),
        ("saddle", [SADDLE], "a notch, and hull edges over gaps"),
        ("house", [HOUSE], "a gable: two sloping sides"),
        ("tee-plate", [TEE], "rectilinear with two notches"),
        ("u", [U_PART], "a slot as wide as two pegs and more: pegs inside it"),
        ("flatted-round", [flats(52, 38)], "one circle with two flats"),
        ("frame", [polygon((0, 0), (70, 0), (70, 54), (0, 54)), WINDOW], "a hole without symmetry: opening from within"),
    ),
}  # fmt: skip
REASONS = {
    "thin4Handle": "the paper's; a thin plate with four bosses",
    "8Handle": "the paper's; eight bosses",
    "small4Handle": "the paper's; four bosses",
    "large4Handle": "the paper's; the same, larger against the pitch",
    "oblongPart": "the paper's; two half circles and two sides",
    "widget": "the paper's; lines, convex and concave arcs",
    "flange": "the paper's; a flange with round ends",
}
# Parts of the workshop that are in other families already.
SAME = ("rectangle", "oval-flange")
CAD_REASON = "drawn as CAD programs do; a part that once was slow, or had contacts that could not be decided"


def benchmark_parts(cad: Path | None = None) -> Iterator[BenchmarkPart]:
    """All workpieces of the set, family by family.

    Parameters
    ----------
    cad : a folder of further drawings, each of which is a workpiece of the family "from CAD".
    """
    for name, reason in REASONS.items():
        source = "A. S. Wallack and J. F. Canny 1996, as modelled by the project: its dimensions were never printed"
        yield BenchmarkPart(load(name), "the paper's", reason, source)
    for shop in PARTS:
        if shop.name in OTHERS:
            yield BenchmarkPart(named(shop.make(), shop.name), "real outlines", shop.words, OTHERS[shop.name])
        elif shop.name not in SAME:
            yield BenchmarkPart(named(shop.make(), shop.name), "from the workshop", shop.words)
    for family, several in FAMILIES.items():
        for name, loops, reason in several:
            yield BenchmarkPart(drawn(name, loops), family, reason)
    for path in sorted(cad.glob("*.dxf")) if cad else ():
        yield BenchmarkPart(named(load(path, unit="mm"), f"cad-{path.stem}"), "from CAD", CAD_REASON)


def drawn(name: str, loops: list[Loop]) -> Workpiece:
    """A workpiece of loops."""
    return Workpiece.from_loops(name, [[list(vertex) for vertex in loop] for loop in loops])


def named(workpiece: Workpiece, name: str) -> Workpiece:
    """The workpiece under another name."""
    return Workpiece.from_loops(name, [loop.tolist() for loop in workpiece.loops])
