"""A fixture as bodies in space: part, pegs, clamps, walls and plates as prisms with names and kinds.

STEP set-ups, GLB files and the view of the page are made from this one description. The frame is the
toolkit's in mm, z up; z = 0 is the plane on which the part lies, the top of the plates or of the supports.

Glossary
--------
body : a solid object, made of slabs that lie on one another.
slab : an upright prism between two heights, over a border with openings.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from math import asin, atan2, isfinite, pi

from attrs import evolve, frozen

from workhold.errors import InputError, make_printable, shorten_middle
from workhold.fixels.carrier import Carrier, make_hole_name
from workhold.fixels.pegs import make_peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import LoopShape, compute_signed_area, encloses
from workhold.geometry.segment import Arc, Box, Line, Point, Segment
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.shown import MOST_HOLES, ShownCarrier, ShownSetUp, find_shown
from workhold.model.workpiece import Workpiece

__all__ = [
    "COLOURS",
    "FILM",
    "SUPPORT_HEIGHT",
    "THICKNESS",
    "BodyKind",
    "BodySizes",
    "FixtureBody",
    "Slab",
    "list_fixture_bodies",
    "make_part_slabs",
]

Loop = tuple[Segment, ...]

# Of the part and of the plates, in mm, where nobody says.
THICKNESS = 10.0
# Of supports above the plates, in mm, where nobody says.
SUPPORT_HEIGHT = 10.0
LONGEST_NAME = 120
# A hole that would touch a side of its plate or another hole is made this much smaller, in mm, so that no
# body touches itself.
FILM = 1e-3


class BodyKind(StrEnum):
    """Kind of a body, which gives it its colour."""

    PART = "part"
    PEG = "peg"
    CLAMP = "clamp"
    PLATE = "plate"
    WALL = "wall"
    SUPPORT = "support"


# Red, green and blue from 0 to 1, as on a screen (sRGB).
COLOURS: dict[BodyKind, tuple[float, float, float]] = {
    BodyKind.PART: (0.36, 0.56, 0.82),
    BodyKind.PEG: (0.85, 0.55, 0.15),
    BodyKind.CLAMP: (0.75, 0.25, 0.22),
    BodyKind.PLATE: (0.72, 0.74, 0.76),
    BodyKind.WALL: (0.45, 0.48, 0.52),
    BodyKind.SUPPORT: (0.30, 0.62, 0.38),
}


@frozen
class Slab:
    """An upright prism.

    Parameters
    ----------
    outer : its border, counter-clockwise, in mm.
    holes : openings through it, clockwise.
    low, high : heights in mm.
    """

    outer: Loop
    holes: tuple[Loop, ...]
    low: float
    high: float


@frozen
class FixtureBody:
    """A body of a fixture.

    Parameters
    ----------
    name : such as "peg L-A1".
    kind : kind of body, which gives it its colour.
    slabs : from below upward.
    opens : unit vector along which the body moves away when the toolkit is opened; None for a fixed body.
    """

    name: str
    kind: BodyKind
    slabs: tuple[Slab, ...]
    opens: Point | None = None


@frozen
class BodySizes:
    """Heights of the bodies in mm, all of them known.

    Parameters
    ----------
    thickness : thickness of the part.
    plate_thickness : thickness of all plates.
    top : height of the pegs' upper ends above the plane on which the part lies.
    peg_length : length of the pegs.
    others : height of the upper ends of clamps and walls above the plane on which the part lies.
    is_assumed : whether the part's thickness is assumed because none was given.
    support_height : height of the part's lower side above the plates, on supports; 0 on the plates.
    """

    thickness: float
    plate_thickness: float
    top: float
    peg_length: float
    others: float
    is_assumed: bool
    support_height: float = 0.0

    @classmethod
    def from_workpiece(
        cls,
        workpiece: Workpiece,
        thickness: float | None = None,
        plate_thickness: float | None = None,
        peg_length: float | None = None,
        peg_height: float | None = None,
        support_height: float = 0.0,
    ) -> BodySizes:
        """Return the heights of all bodies in mm; each argument that is None gets its default.

        Defaults: the thickness is that of the part's solid, else :data:`THICKNESS`; the plates' is
        :data:`THICKNESS`. The peg height is the solid's ``peg_height``, at most the thickness; without a
        solid it is the thickness. The peg length reaches from there down to the lower side of the plate.

        Raises
        ------
        InputError
            For a length that is not positive, and supports of a negative height.
        """
        solid, assumed = workpiece.solid, False
        if thickness is None:
            assumed, thickness = solid is None, THICKNESS if solid is None else solid.height
        plate_thickness = THICKNESS if plate_thickness is None else plate_thickness
        usual = thickness if solid is None else min(solid.peg_height, thickness)
        top = usual if peg_height is None else peg_height
        length = top + support_height + plate_thickness if peg_length is None else peg_length
        for name, value in (
            ("thickness", thickness),
            ("plate thickness", plate_thickness),
            ("peg height", top),
            ("peg length", length),
        ):
            if not (isfinite(value) and value > 0):
                raise InputError(f"{name} {value} is not a positive length: give it in mm.")
        if not (isfinite(support_height) and support_height >= 0):
            raise InputError(f"support height {support_height} is not a length: give 0 or more, in mm.")
        return cls(thickness, plate_thickness, top, length, usual, assumed, support_height)

    @property
    def floor(self) -> float:
        """z of the plates' upper sides in mm:
        minus the support height, 0 where the part lies on the plates.
        """
        return 0.0 - self.support_height

    def find_height_range(self, carrier: Carrier) -> tuple[float, float]:
        """Return z in mm of the lower and the upper end of a clamp or a wall.

        They are the carrier's own ``heights``, else 0 and ``others``. A lower end at or below 0 is moved to
        the plates' upper sides.
        """
        low, high = carrier.heights or (0.0, self.others)
        return (low if low > 0.0 else self.floor), high


def list_fixture_bodies(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    sizes: BodySizes | None = None,
    more: Sequence[FixtureBody] = (),
) -> tuple[FixtureBody, ...]:
    """Return all bodies of a fixture: the part (for a raw block also the finished part inside), pegs, clamps
    each followed by its bolt, flat jaws, walls, plates, ``more``.

    Parameters
    ----------
    sizes : heights; those of :meth:`BodySizes.from_workpiece` if None.
    more : further bodies, such as supports under the part.

    Raises
    ------
    InputError
        For pegs of radius 0, which have no body.
    """
    radii = [carrier.peg_radius for carrier in toolkit.carriers if carrier.contact.is_placed]
    if min(radii, default=1.0) <= 0:
        raise InputError(
            f"pegs of radius 0 have no body to write or show: give the {toolkit.noun} a peg radius."
        )
    sizes = BodySizes.from_workpiece(workpiece) if sizes is None else sizes
    seen = find_shown(fixture, toolkit, workpiece)
    part = make_part_slabs(workpiece.apply_pose(fixture.pose), sizes.thickness)
    name = make_printable(shorten_middle(workpiece.name, LONGEST_NAME))
    return (
        FixtureBody(name if workpiece.finished is None else f"raw block of {name}", BodyKind.PART, part),
        *make_finished_bodies(fixture, workpiece, name),
        *make_peg_bodies(seen, sizes),
        *make_clamp_bodies(seen, sizes),
        *make_flat_jaw_bodies(seen, fixture, toolkit, sizes),
        *(
            FixtureBody(
                wall.carrier.noun,
                BodyKind.WALL,
                (Slab(make_rectangle(wall.bar), (), *sizes.find_height_range(wall.carrier)),),
            )
            for wall in seen.walls
        ),
        *(
            FixtureBody(
                each.carrier.title,
                BodyKind.PLATE,
                (make_drilled_plate(each, sizes.plate_thickness, sizes.floor),),
                find_opening_direction(each),
            )
            for each in seen.carriers
        ),
        *more,
    )


def make_finished_bodies(fixture: Fixture, workpiece: Workpiece, name: str) -> Iterator[FixtureBody]:
    """Yield the finished part inside a raw block; nothing without a raw block or for a fixture of no result."""
    query = None if fixture.listed is None else fixture.listed.result.query
    if workpiece.finished is None or query is None or query.raw is None or query.thickness is None:
        return
    raw, placed = query.raw, workpiece.finished.apply_pose(fixture.pose)
    inside = make_part_slabs(placed, query.thickness - raw.top - raw.bottom)
    slabs = (evolve(one, low=one.low + raw.bottom, high=one.high + raw.bottom) for one in inside)
    yield FixtureBody(name, BodyKind.SUPPORT, tuple(slabs))


def make_part_slabs(part: Workpiece, thickness: float) -> tuple[Slab, ...]:
    """Return one slab from z = 0 to the thickness (mm) for each outer loop of a part.

    A hole belongs to the smallest outer loop around it.
    """
    outer = [LoopShape.from_segments(loop) for loop in part.loop_segments[: part.pieces]]
    holes: list[list[Loop]] = [[] for _ in outer]
    for hole in part.hole_segments:
        shape = LoopShape.from_segments(hole)
        around = [k for k, one in enumerate(outer) if encloses(one, shape)]
        holes[min(around, key=lambda k: abs(compute_signed_area(outer[k].segments)))].append(hole)
    return tuple(
        Slab(one.segments, tuple(inside), 0.0, thickness) for one, inside in zip(outer, holes, strict=True)
    )


def find_opening_direction(carrier: ShownCarrier) -> Point | None:
    """Return the unit vector along which a carrier moves when the toolkit is opened; None if it does not
    clamp.
    """
    return None if carrier.clamping is None else reverse(carrier.clamping)


def reverse(direction: Point) -> Point:
    """Return the opposite direction, with 0.0 in place of -0.0."""
    return 0.0 - direction[0], 0.0 - direction[1]


def make_peg_bodies(seen: ShownSetUp, sizes: BodySizes) -> Iterator[FixtureBody]:
    """Yield one body for each peg of all carriers: inside the plate a full cylinder, above the plate the
    peg's outline, which has a flat if the peg has one.
    """
    for each in seen.carriers:
        carrier = each.carrier
        for peg in each.pegs:
            center = (peg.x, peg.y)
            outline = tuple(make_peg_outline(center, carrier.peg_radius, carrier.flat, peg.flat_deg))
            begin, top = carrier.heights or (0.0, sizes.top)
            # A peg that begins higher is shown from there: what carries it is its owner's to say.
            low = begin if begin > 0.0 else sizes.top - sizes.peg_length
            slabs = [Slab(outline, (), low, top)]
            if len(outline) > 1 and low < sizes.floor:
                foot = tuple(make_peg_outline(center, carrier.peg_radius))
                slabs = [Slab(foot, (), low, sizes.floor), Slab(outline, (), sizes.floor, top)]
            yield FixtureBody(
                f"{carrier.peg} {peg.hole}", BodyKind.PEG, tuple(slabs), find_opening_direction(each)
            )


def make_clamp_bodies(seen: ShownSetUp, sizes: BodySizes) -> Iterator[FixtureBody]:
    """Yield the clamps that are bolted to a plate, each followed by its bolt if the bolt's hole is known."""
    for clamp in seen.clamps:
        body = Slab(clamp.make_outline(), (), *sizes.find_height_range(clamp.carrier))
        yield FixtureBody(clamp.tip.hole, BodyKind.CLAMP, (body,), reverse(clamp.clamping))
        if clamp.hole is not None:
            round_part = tuple(make_peg_outline(clamp.hole, seen.carriers[0].carrier.peg_radius))
            place = make_hole_name(clamp.carrier.stands_on, clamp.tip.column, clamp.tip.row)
            bolt = Slab(round_part, (), sizes.floor - sizes.plate_thickness, sizes.floor)
            yield FixtureBody(f"bolt {place}", BodyKind.CLAMP, (bolt,))


def make_flat_jaw_bodies(
    seen: ShownSetUp, fixture: Fixture, toolkit: Toolkit, sizes: BodySizes
) -> Iterator[FixtureBody]:
    """Yield fixed jaw, moving jaw, parallels, work stop (if any) and bed; nothing for a fixture without flat
    jaws.
    """
    jaws, hold = toolkit.flat_jaws, fixture.hold
    if seen.jaws is None or jaws is None or not isinstance(hold, JawHold):
        return
    low = 0.0 - hold.parallels
    top = sizes.top if jaws.height is None else jaws.compute_top(hold.parallels)
    around = seen.jaws.fixed.unite(seen.jaws.moving)
    bed = Slab(make_rectangle(around), (), low - sizes.plate_thickness, low)
    yield FixtureBody("fixed jaw", BodyKind.WALL, (Slab(make_rectangle(seen.jaws.fixed), (), low, top),))
    yield FixtureBody(
        "moving jaw", BodyKind.WALL, (Slab(make_rectangle(seen.jaws.moving), (), low, top),), (0.0, 1.0)
    )
    for number, box in enumerate(seen.jaws.parallels, 1):
        yield FixtureBody(f"parallel {number}", BodyKind.WALL, (Slab(make_rectangle(box), (), low, 0.0),))
    if seen.jaws.stop is not None:
        stop = Slab(make_rectangle(seen.jaws.stop), (), 0.0, min(top, sizes.thickness))
        yield FixtureBody("work stop", BodyKind.CLAMP, (stop,))
    yield FixtureBody("bed of the vise", BodyKind.PLATE, (bed,))


def make_rectangle(box: Box) -> Loop:
    """Return the four sides of a box, counter-clockwise, beginning with the lower one."""
    corners = [(box.x0, box.y0), (box.x1, box.y0), (box.x1, box.y1), (box.x0, box.y1)]
    return tuple(Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True))


def make_drilled_plate(carrier: ShownCarrier, thickness: float, top: float = 0.0) -> Slab:
    """Return a plate with its holes as a slab from z = ``top - thickness`` to ``top``, in mm.

    A hole that reaches over the border of the plate, as in the last columns of plates that nearly meet,
    becomes a round notch in the border.
    """
    box, radius = carrier.plate, carrier.carrier.peg_radius
    radius = min(radius, min(carrier.carrier.pitch) / 2 - FILM)
    holes: list[Loop] = []
    notches: dict[int, list[tuple[Point, float]]] = {side: [] for side in range(4)}
    for hole in carrier.list_holes(MOST_HOLES):
        x, y = hole.center
        room = (y - box.y0, box.x1 - x, box.y1 - y, x - box.x0)
        own = radius - 2 * FILM if any(abs(far - radius) < FILM for far in room) else radius
        side = min(range(4), key=lambda k: room[k])
        if room[side] > own:
            holes.append((Arc((x, y), own, 0.0, pi, -1.0),))
        else:
            notches[side].append(((x, y), own))
    return Slab(make_notched_loop(box, notches), tuple(holes), top - thickness, top)


def make_notched_loop(box: Box, notches: dict[int, list[tuple[Point, float]]]) -> Loop:
    """Return the border of a box, counter-clockwise from its lower side, with round notches cut by discs.

    ``notches[k]`` lists the centres and radii, in mm, of the discs over side k: 0 lower, 1 right, 2 upper, 3
    left. The discs are disjoint and their centres lie within the box.
    """
    border: list[Segment] = []
    for number, side in enumerate(make_rectangle(box)):
        assert isinstance(side, Line)
        (tx, ty), (sx, sy) = side.tangent, side.start
        at = side.start
        cut = sorted(
            ((x - sx) * tx + (y - sy) * ty, (y - sy) * tx - (x - sx) * ty, radius, (x, y))
            for (x, y), radius in notches[number]
        )
        for along, away, radius, center in cut:
            half = (radius**2 - away**2) ** 0.5
            begin, end = ((sx + (along + k) * tx, sy + (along + k) * ty) for k in (-half, half))
            # The disc reaches over the side by less than its half: what is left inside is the larger arc.
            arc = Arc(center, radius, *compute_inner_arc(side, away / radius), -1.0)
            border += [Line(at, begin), arc]
            at = end
        border.append(Line(at, side.end))
    return tuple(border)


def compute_inner_arc(side: Line, share: float) -> tuple[float, float]:
    """Return (angle of the middle, half the sweep), in radians, of the arc of a circle that lies left of a
    line.

    Parameters
    ----------
    share : distance of the disc's centre from the line divided by its radius, from 0 to 1.

    Examples
    --------
    >>> compute_inner_arc(Line((0, 0), (1, 0)), 0.0) == (pi / 2, pi / 2)
    True
    """
    nx, ny = -side.tangent[1], side.tangent[0]
    return atan2(ny, nx), pi / 2 + asin(share)
