"""Requirements of a fixture besides holding the part: loads, restrictions and tolerances.

A load is what a cutter, a drill or a hand does to the workpiece while it is held. Ruled out are faces not to
touch, places where no peg may stand, and angles the part may not lie at. A tolerance says how far pegs and
faces may be off.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import hypot, isfinite
from typing import Any

import numpy as np
from attrs import evolve, field, frozen
from attrs.converters import optional
from numpy.typing import ArrayLike, NDArray

from workhold.asking.search import RestrictionQuestion
from workhold.conventions import ANGLE_SLACK
from workhold.errors import InputError, quote_value
from workhold.geometry.loop import (
    LoopShape,
    check_vertices,
    compute_signed_area,
    make_loop_segments,
    refuse_self_crossing,
    reverse_vertices,
)
from workhold.geometry.segment import Box, Segment
from workhold.limits import convert_real, name_fields_in_errors, refuse_long, refuse_strong
from workhold.model.dowels import DowelFit

__all__ = [
    "ANY_DIRECTION",
    "Load",
    "Restrictions",
    "Tolerance",
    "Zone",
    "lie_in_angle_ranges",
    "circle_zone",
    "describe_far_loads",
    "polygon_zone",
]

ANY_DIRECTION = (0.0, 360.0)


def to_number_pairs(values: Any, name: str, remedy: str) -> tuple[tuple[float, float], ...]:
    """Return pairs of floats from several pairs, an array (N, 2),
    or one pair by itself; raise InputError for anything else.

    In the message, ``name`` is what one pair is called, and ``remedy`` says what to give.
    """
    given = list(values) if isinstance(values, Iterable) and not isinstance(values, str | bytes) else None
    if given is not None and len(given) == 2 and not any(isinstance(one, Iterable) for one in given):
        given = [given]
    if given is None:
        raise InputError(f"{name} cannot be {quote_value(values)}: {remedy}.")
    pairs = []
    for one in given:
        numbers = tuple(one) if isinstance(one, Iterable) and not isinstance(one, str | bytes) else ()
        if len(numbers) != 2:
            raise InputError(f"{name} cannot be {quote_value(one)}: {remedy}.")
        pairs.append(
            (convert_real(numbers[0], f"a number of {name}"), convert_real(numbers[1], f"a number of {name}"))
        )
    return tuple(pairs)


def to_points(points: Any) -> tuple[tuple[float, float], ...]:
    """Return points (x, y) in mm of a load, from one point or several; raise InputError for anything else."""
    return to_number_pairs(
        points, "a point of a load", "give x and y in mm, such as (30, 20), or several such points"
    )


def to_direction_range(directions: Any) -> tuple[float, float]:
    """Return directions as (low, high) in degrees, counter-clockwise from low to high.

    0 <= low < 360 and low <= high <= low + 360; a whole turn is (0, 360), and one number is that direction
    alone. Raises InputError for a range of more than 360 degrees and for what is not a number or pair.
    """
    if isinstance(directions, str | bytes) or not isinstance(directions, Iterable):
        directions = (convert_real(directions, "a direction"),) * 2
    values = tuple(convert_real(value, "a direction") for value in directions)
    if len(values) != 2:
        raise InputError(
            f"directions cannot be {quote_value(directions)}: give one in degrees, or the two ends of a range."
        )
    low, high = values
    if 0.0 <= low < 360.0 and low <= high <= low + 360.0:
        return ANY_DIRECTION if high - low == 360.0 else (low, high)
    if not (isfinite(low) and isfinite(high) and abs(high - low) <= 360.0):
        raise InputError(
            f"direction {low:g}..{high:g} is not a range of at most 360 degrees: give two angles, or any for "
            "all of them."
        )
    if abs(high - low) == 360.0:
        return ANY_DIRECTION
    # The rest of a tiny negative angle rounds up to the whole turn.
    start = low % 360.0 % 360.0
    return start, start + (high - low) % 360.0


@frozen(field_transformer=name_fields_in_errors)
class Load:
    """A force and a moment that act ON the workpiece; pegs must push back.

    The force acts at the worst of the points and in the worst of the directions; the moment acts together
    with it. A cutter that runs along a polyline is a load with several points: no place between two points is
    worse than the worse of the two.

    Parameters
    ----------
    points : where the force may act, (x, y) in mm in the part's coordinates, an array (N, 2), or one such
        point; may be empty when there is no force.
    force : its size in N, 0 or more.
    directions : directions in which the force may point, in degrees counter-clockwise from the part's x axis:
        one number, or a range (low, high); (0, 360) is any direction.
    moment : in N mm, positive counter-clockwise.
    name : the user's name of it.
    upward : force along z in N, up positive, that acts together with force and moment; pegs do not feel it.
    height : how high above the part's lower side the forces act, in mm; None is the top of the part.

    Raises
    ------
    InputError
        For numbers that are not finite or too large, a negative force, a force without a point, and a
        load that does nothing.

    Examples
    --------
    >>> from workhold.model.requirements import Load
    >>> Load(points=[(10, 5)], force=200, directions=(-30, 30)).directions
    (330.0, 390.0)
    """

    points: tuple[tuple[float, float], ...] = field(default=(), converter=to_points)
    force: float = field(default=0.0, converter=convert_real)
    directions: tuple[float, float] = field(default=ANY_DIRECTION, converter=to_direction_range)
    moment: float = field(default=0.0, converter=convert_real)
    name: str = ""
    upward: float = field(default=0.0, converter=convert_real)
    height: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        if not all(map(isfinite, (self.upward, self.height or 0.0))):
            raise InputError("a load's force along z, and its height, are numbers: give N and mm.")
        refuse_strong("force along z", self.upward)
        refuse_long("a load's height", self.height or 0.0)
        if not isfinite(self.force) or self.force < 0:
            raise InputError(
                f"force {self.force:g} cannot be used: give its size in N, 0 or more, and its direction "
                "by itself."
            )
        if not isfinite(self.moment):
            raise InputError(
                f"moment {self.moment:g} is not a number: give it in N mm, positive counter-clockwise."
            )
        refuse_strong("force", self.force)
        refuse_strong("moment", self.moment, "N mm")
        for x, y in self.points:
            if not isfinite(hypot(x, y)):
                raise InputError(
                    f"the point ({x:g}, {y:g}) of a load is not a place: give finite coordinates in mm."
                )
            refuse_long("a load's point", max(x, y, key=abs))
        if (self.force > 0 or self.upward) and not self.points:
            raise InputError(
                f"a force of {self.force or abs(self.upward):g} N needs the point it acts at: give at=X,Y or path=X,Y;X,Y."
            )
        if self.force == 0 and self.moment == 0 and self.upward == 0:
            raise InputError(
                "a load with neither force nor moment does nothing: give force=... or moment=...."
            )


def describe_far_loads(loads: Sequence[Load], part: Box) -> list[str]:
    """Return a sentence for each load that acts farther from
    a part's bounding box than the diagonal of that box.

    Examples
    --------
    >>> describe_far_loads([Load(points=[(9, 0)], force=1), Load(points=[(900, 0)], force=1)], Box(0, 0, 30, 40))
    ['Load 2 acts at (900, 0), 870 mm from the part: is its place in mm of the drawing?']
    """
    remarks, size = [], hypot(part.x1 - part.x0, part.y1 - part.y0)
    for number, load in enumerate(loads, 1):
        away = [
            (hypot(max(part.x0 - x, x - part.x1, 0.0), max(part.y0 - y, y - part.y1, 0.0)), x, y)
            for x, y in load.points
        ]
        far, x, y = max(away, default=(0.0, 0.0, 0.0))
        if far > size:
            called = f"Load {number}" + (f", {load.name}," if load.name else "")
            remarks.append(
                f"{called} acts at ({x:g}, {y:g}), {far:.0f} mm from the part: is its place in mm of the drawing?"
            )
    return remarks


Angles = tuple[float, float]


@frozen
class Zone:
    """A keep-out zone: no part of a peg's body may stand over it.

    Parameters
    ----------
    loop : (N, 3) read-only vertices x, y (mm, in the part's frame) and bulge, counter-clockwise.
    """

    loop: NDArray[np.float64] = field(eq=lambda loop: loop.tolist(), hash=False)

    def __attrs_post_init__(self) -> None:
        self.loop.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # So that the array is read-only again on the other side.
        return Zone, (self.loop,)

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Boundary in mm, in the part's frame, with the zone on its left."""
        return tuple(make_loop_segments(self.loop))


def circle_zone(x: float, y: float, radius: float) -> Zone:
    """Return a round zone.

    Parameters
    ----------
    x, y : of its centre, in the part's frame, in mm.
    radius : in mm.

    Raises
    ------
    InputError
        For a radius that is not positive, and numbers that are not finite.
    """
    x, y, radius = (convert_real(value, "a number of a keep-out circle") for value in (x, y, radius))
    if not (isfinite(x) and isfinite(y) and isfinite(radius) and radius > 0):
        raise InputError(
            f"a keep-out circle of radius {radius:g} at ({x:g}, {y:g}) is not a circle: give a positive radius."
        )
    return make_zone([[x - radius, y, 1.0], [x + radius, y, 1.0]])


def polygon_zone(points: ArrayLike) -> Zone:
    """Return a zone with straight sides between corners (x, y) in mm,
    in the part's frame: an array (N, 2), either way round.

    Raises
    ------
    InputError
        For fewer than three points and for a boundary that crosses itself.
    """
    corners = to_number_pairs(points, "a corner of a keep-out zone", "give x and y in mm for every corner")
    if len(corners) < 3:
        raise InputError(f"a keep-out polygon has {len(corners)} corners: give three or more.")
    return make_zone([[x, y, 0.0] for x, y in corners])


def make_zone(vertices: Sequence[Sequence[float]]) -> Zone:
    """Return the zone inside one closed loop of (x, y, bulge) vertices in mm, given either way round.

    Raises
    ------
    InputError
        For a boundary that crosses itself, and numbers that are not finite.
    """

    def place(k: int) -> str:
        """Return a name for side k for messages."""
        return f"keep-out zone: side {k}"

    checked = check_vertices(vertices, "keep-out zone", place)
    shape = LoopShape.from_segments(make_loop_segments(checked))
    refuse_self_crossing(shape, place)
    if compute_signed_area(shape.segments) < 0:
        checked = reverse_vertices(checked)
    return Zone(checked)


def to_angle_pairs(ranges: Any) -> tuple[Angles, ...]:
    """Return ranges of angles in degrees as pairs, from one range or several;
    raise InputError for anything else.
    """
    return to_number_pairs(ranges, "a range of angles", "give its two ends in degrees, such as (-10, 10)")


def make_zones(zones: Any) -> tuple[Zone, ...]:
    """Return zones as a tuple, from one or several zones or polygons of shapely."""
    several = isinstance(zones, Iterable) and not isinstance(zones, str | bytes)
    return tuple(zone for one in (zones if several else [zones]) for zone in find_zones(one))


def find_zones(zone: Any) -> Iterator[Zone]:
    """Yield the zones of one object:
    itself, or one for each polygon of a shapely geometry; raise InputError otherwise.
    """
    if isinstance(zone, Zone):
        yield zone
    elif hasattr(zone, "geoms"):
        for one in zone.geoms:
            yield from find_zones(one)
    elif hasattr(zone, "exterior"):
        if len(zone.interiors):
            raise InputError(
                "a keep-out zone has no holes, and this polygon has some: give its parts without."
            )
        yield polygon_zone(list(zone.exterior.coords)[:-1])
    else:
        raise InputError(
            f"a keep-out zone cannot be {quote_value(zone)}: give a circle_zone, a polygon_zone or a polygon of "
            "shapely."
        )


def to_face_numbers(numbers: Any) -> tuple[int, ...]:
    """Return numbers of faces, ascending, each once, from one number or several;
    raise InputError for what is not an integer.
    """
    several = isinstance(numbers, Iterable) and not isinstance(numbers, str | bytes)
    given = list(numbers) if several else [numbers]
    for one in given:
        number = convert_real(one, "the number of a face")
        if not number.is_integer():
            raise InputError(f"the number of a face cannot be {quote_value(one)}: give a whole number.")
    return tuple(sorted({int(one) for one in given}))


def lie_in_angle_ranges(degrees: Any, ranges: Sequence[Sequence[float]]) -> Any:
    """Return whether angles in degrees, an array (N,) or one number, lie in any of the ranges (from, to),
    ends included.

    Ranges count modulo 360. Without ranges the answer is True for all angles.
    """
    if not ranges:
        return np.ones(np.shape(degrees), np.bool_)
    # A limit that is met exactly is kept, however a machine rounds.
    inside = [(degrees - low + ANGLE_SLACK) % 360.0 <= high - low + 2 * ANGLE_SLACK for low, high in ranges]
    return np.any(inside, axis=0)


@frozen
class Restrictions(RestrictionQuestion):
    """Faces, places and angles that fixtures must avoid, and faces that they must touch.

    Parameters
    ----------
    avoid : numbers of faces that no peg may touch, or one number.
    zones : places in the part's frame where no peg may stand: :func:`circle_zone`, :func:`polygon_zone`, or
        polygons of shapely in mm.
    angles : ranges (from, to) of the part's angle in the vise, as ``Pose.theta_deg``, in degrees, ends
        included, or one such range; empty for any angle.
    touch : numbers of faces, or one number, each of which a peg, a clamp or a wall must touch.

    Raises
    ------
    InputError
        For an impossible range of angles, and a face that is both to be touched and to be avoided.

    Examples
    --------
    >>> Restrictions(avoid=3, angles=(-10, 10)).angles
    ((-10.0, 10.0),)
    """

    def __attrs_post_init__(self) -> None:
        for name, converted in (
            ("avoid", to_face_numbers(self.avoid)),
            ("zones", make_zones(self.zones)),
            ("angles", to_angle_pairs(self.angles)),
            ("touch", to_face_numbers(self.touch)),
        ):
            object.__setattr__(self, name, converted)
        for low, high in self.angles:
            if not (isfinite(low) and isfinite(high) and low <= high):
                raise InputError(
                    f"angles {low:g} to {high:g} are not a range in degrees: give the smaller first, such as "
                    "-10..10."
                )
        if both := sorted(set(self.avoid) & set(self.touch)):
            raise InputError(f"face {both[0]} is to be touched and to be avoided: leave one of these out.")

    def __bool__(self) -> bool:
        """Return whether anything is restricted or must be touched."""
        return bool(self.avoid or self.zones or self.angles or self.touch)


@frozen(field_transformer=name_fields_in_errors)
class Tolerance:
    """Largest errors along the normal of a contact, either way.

    Parameters
    ----------
    peg : how far the surface of a peg may be from where it should be, in mm.
    face : how far a face of the part may be from where it should be, in mm, departure included.
    fit : fit of the dowels that serve as pegs, from which ``peg`` follows; None where unknown.
    departure : how far the outline as read may be from the drawn one, in mm; a query sets it to its
        workpiece's.

    Raises
    ------
    InputError
        For lengths that are negative, not finite or too large.
    """

    peg: float = field(default=0.01, converter=convert_real)
    face: float = field(default=0.01, converter=convert_real)
    fit: DowelFit | None = None
    departure: float = field(default=0.0, converter=convert_real)

    def __attrs_post_init__(self) -> None:
        for name, value in (
            ("peg", self.peg),
            ("face", self.face),
            ("departure in the face", self.departure),
        ):
            if not (isfinite(value) and value >= 0):
                raise InputError(f"{name} tolerance {value} is not a length: give 0 or more, in mm.")
            refuse_long(f"{name} tolerance", value)

    @classmethod
    def preset(cls, name: str) -> Tolerance:
        """Return the tolerance that follows from the dowels of
        a preset toolkit, see :meth:`workhold.Vise.preset`.

        Raises
        ------
        InputError
            For a name that is not known.

        Examples
        --------
        >>> from workhold import Tolerance
        >>> round(Tolerance.preset("plate-20mm").peg, 6)
        0.0145
        """
        from workhold.files.toolkit_file import load_preset_tolerance

        return load_preset_tolerance(name)

    def with_departure(self, departure: float) -> Tolerance:
        """Return the tolerance for an outline that is up to ``departure`` mm off the drawn one.

        The face's own error is kept: ``face`` loses the old departure and gains the new one.

        Examples
        --------
        >>> Tolerance(0.01, 0.02).with_departure(0.5).face
        0.52
        >>> round(Tolerance(0.01, 0.02).with_departure(0.5).with_departure(0.1).face, 9)
        0.12
        """
        if departure == self.departure:
            return self
        return evolve(self, face=max(self.face - self.departure, 0.0) + departure, departure=departure)
