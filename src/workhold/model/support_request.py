"""Requests for supports and a clamp on top, and loads in space.

Glossary
--------
band : the heights at which a peg may press on its face, from z0 to z1; z is up, 0 where the part lies.
tip : the round end of the clamp that presses on the part from above.
reach : rings about a clamp's holes in which its tip can be, in the toolkit's frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from math import hypot, isfinite
from typing import Any, Literal

import numpy as np
from attrs import Factory, evolve, field, frozen
from attrs.converters import optional
from numpy.typing import ArrayLike, NDArray

from workhold.errors import InputError, quote_value
from workhold.fixels.support_hardware import SupportPads, TopClamp
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import check_vertices, make_loop_segments
from workhold.geometry.segment import make_segment_rows
from workhold.kernels.base.distance import is_inside
from workhold.limits import convert_real, name_fields_in_errors, refuse_long, refuse_strong
from workhold.model.fixture import Fixture, Peg
from workhold.model.numbered_outlines import NumberedOutlines
from workhold.model.requirements import (
    ANY_DIRECTION,
    Load,
    Zone,
    make_zones,
    to_direction_range,
    to_points,
)
from workhold.model.solid import BESIDE_TOP, SolidOutline, convert_finite_heights
from workhold.model.workpiece import Workpiece

__all__ = [
    "OUTLINE",
    "PAD_RADIUS",
    "TIP_RADIUS",
    "Faces",
    "Loops",
    "SpatialLoad",
    "SupportRequest",
    "to_loops",
    "find_pressed_heights",
    "compute_usual_head",
    "find_usual_pad_radius",
]

# In mm, where nobody says; a pad that the holes leave less room for than the last is none.
PAD_RADIUS, TIP_RADIUS, LEAST_PAD_RADIUS = 4.0, 5.0, 1.0

# The head over a tip, in radii of it.
HEAD = 1.5

Loops = tuple[NDArray[np.float64], ...]
# Faces as users of Python give them, and the word for the whole outline.
OUTLINE: Literal["outline"] = "outline"
Faces = Sequence[ArrayLike] | Literal["outline"]
Span = tuple[float, float]


def compute_usual_head(tip_radius: float) -> float:
    """Return the usual radius in mm of a clamp's head above a tip of this radius."""
    return HEAD * tip_radius


def to_pair(values: Any) -> Span:
    """Return two numbers as floats in their order; raise InputError for anything else."""
    if not isinstance(values, Iterable) or isinstance(values, str) or len(pair := tuple(values)) != 2:
        raise InputError(f"two numbers cannot be {quote_value(values)}: give two.")
    return convert_real(pair[0]), convert_real(pair[1])


def make_span(value: Any) -> Span:
    """Return (low, high) from two numbers in any order, or from one number twice."""
    if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and len(value) == 2:
        low, high = (convert_real(one) for one in value)
        return (low, high) if low <= high else (high, low)
    number = convert_real(value)
    return number, number


def to_loops(loops: Iterable[Any]) -> Loops:
    """Return loops of (x, y, bulge) vertices as (N, 3) arrays; raise InputError for anything else."""
    return tuple(
        check_vertices(loop, f"face: loop {number}", partial("face: loop {}, side {}".format, number))
        for number, loop in enumerate(loops, 1)
    )


def to_rings(reach: Iterable[Iterable[float]]) -> tuple[tuple[float, float, float, float], ...]:
    """Return rings as tuples (x, y, least, most) in mm; raise InputError for anything else."""
    rings = [tuple(convert_real(value) for value in ring) for ring in reach]
    for ring in rings:
        if len(ring) != 4 or not all(map(isfinite, ring)) or not 0 <= ring[2] <= ring[3]:
            raise InputError("a reach is not a ring: give x, y, the least and the most distance in mm.")
    return tuple((x, y, least, most) for x, y, least, most in rings)


@frozen(field_transformer=name_fields_in_errors)
class SpatialLoad:
    """A load in space. Force, axial force and moments act together; each varies in its own range.

    Parameters
    ----------
    points : points (x, y) in mm, in the part's coordinates, at which it may act; empty for moments alone.
    force : in the plane, in N, 0 or more.
    directions : of that force, in degrees in the part's frame, as of a planar load.
    heights : (least, greatest) height in mm at which it acts; None is the top of the part.
    axial : (least, greatest) force along -z in N: positive presses down as a drill does, negative pulls up as
        a helix may.
    moment : about z, in N mm.
    tilt : moments about x and about y, in N mm.
    name : what the user calls it.

    Raises
    ------
    InputError
        For numbers that are not finite or too large, a force without a point, and a load that does nothing.

    Examples
    --------
    >>> SpatialLoad(points=[(10, 5)], axial=400).axial
    (400.0, 400.0)
    """

    points: tuple[tuple[float, float], ...] = field(default=(), converter=to_points)
    force: float = field(default=0.0, converter=convert_real)
    directions: Span = field(default=ANY_DIRECTION, converter=to_direction_range)
    heights: Span | None = field(default=None, converter=optional(make_span))
    axial: Span = field(default=(0.0, 0.0), converter=make_span)
    moment: float = field(default=0.0, converter=convert_real)
    tilt: Span = field(default=(0.0, 0.0), converter=to_pair)
    name: str = ""

    def __attrs_post_init__(self) -> None:
        numbers = (self.force, *self.axial, self.moment, *self.tilt, *(self.heights or ()))
        if not all(map(isfinite, numbers)) or self.force < 0 or len(self.tilt) != 2:
            raise InputError(
                "a load has a number that is not finite, or a negative force: give 0 or more, and its "
                "direction."
            )
        for value in numbers:
            refuse_strong("a load", value)
        for x, y in self.points:
            if not isfinite(hypot(x, y)):
                raise InputError("the point of a load is not a place: give finite coordinates in mm.")
            refuse_long("a load's point", max(x, y, key=abs))
        if not self.points and (self.force or any(self.axial)):
            raise InputError("a force needs the point it acts at: give at=X,Y or path=X,Y;X,Y.")
        if not any((self.force, *self.axial, self.moment, *self.tilt)):
            raise InputError(
                "a load without force and moment does nothing: give force, axial, moment or tilt."
            )

    @classmethod
    def from_planar_load(cls, load: Load) -> SpatialLoad:
        """Return a planar load as a load in space, at the planar load's height, or at the top of the part
        where that has none.
        """
        heights = None if load.height is None else (load.height, load.height)
        axial = (0.0 - load.upward, 0.0 - load.upward)
        return cls(
            load.points, load.force, load.directions, heights, axial, load.moment, (0.0, 0.0), load.name
        )

    @property
    def planar(self) -> Load | None:
        """The force and moment in the plane as a load on the pegs; None where both are 0."""
        if self.force == 0 and self.moment == 0:
            return None
        return Load(self.points if self.force else (), self.force, self.directions, self.moment, self.name)

    def with_height(self, thickness: float) -> SpatialLoad:
        """Return the load unchanged if it has heights; else acting at the top of a part of this thickness in
        mm.
        """
        return self if self.heights is not None else evolve(self, heights=(thickness, thickness))


@frozen(field_transformer=name_fields_in_errors)
class SupportRequest:
    """Sizes of supports and clamp, and their allowed places; lengths in mm, in the part's coordinates.

    Parameters
    ----------
    thickness : of the part, T.
    pad_radius : of the supports' round pads.
    tip_radius : of the clamp's round tip.
    band : heights (low, high) at which pegs may press; None for each peg's own: the band of its face on the
        part's solid, or 0 to T where there is no solid.
    bands : for each peg of the fixture, in order, its band in place of ``band``; None for a peg without one.
    pad_margin : smallest distance from a pad to the border of the face it supports.
    bottom, top : faces that supports and the clamp may touch, as loops of (x, y, bulge), the outer one first.
        An empty value means no face, None the outline with its holes.
    top_heights : for each loop of ``top`` the height of its face in mm; None if all are at the thickness.
    bottom_zones, top_zones : keep-outs from below and from above.
    inside : smallest distance from the clamp to each side of the supports' triangle; the tip's radius if not
        given.
    reach : rings in which the clamp can stand, None for anywhere.
    point : place (x, y) of the clamp; None where it is free.
    tip_margin : smallest distance from the tip to the border of the face on which it stands.
    head_radius : radius around the clamp within which nothing may rise above the clamped face; 1.5 times the
        tip's radius if not given.
    rising, rising_heights : loops around what rises above faces of ``top``, and for each loop the height of
        the face.
    hanging, hanging_heights : loops of the parts of ``top`` with air below, and for each loop the height of
        its face.

    Raises
    ------
    InputError
        For impossible lengths.

    Examples
    --------
    >>> SupportRequest(thickness=12, pad_radius=4, tip_radius=5).inside
    5.0
    """

    thickness: float = field(converter=convert_real)
    pad_radius: float = field(converter=convert_real)
    tip_radius: float = field(converter=convert_real)
    band: Span | None = field(default=None, converter=optional(to_pair))
    bands: tuple[Span | None, ...] | None = None
    pad_margin: float = field(default=0.0, converter=convert_real)
    bottom: Loops | None = field(default=None, converter=optional(to_loops), eq=False)
    top: Loops | None = field(default=None, converter=optional(to_loops), eq=False)
    bottom_zones: tuple[Zone, ...] = field(default=(), converter=make_zones)
    top_zones: tuple[Zone, ...] = field(default=(), converter=make_zones)
    inside: float = field(
        default=Factory(lambda self: self.tip_radius, takes_self=True), converter=convert_real
    )
    reach: tuple[tuple[float, float, float, float], ...] | None = field(
        default=None, converter=optional(to_rings)
    )
    point: Span | None = field(default=None, converter=optional(to_pair))
    top_heights: tuple[float, ...] | None = field(default=None, converter=optional(convert_finite_heights))
    tip_margin: float = field(default=0.0, converter=convert_real)
    head_radius: float = field(
        default=Factory(lambda self: compute_usual_head(self.tip_radius), takes_self=True),
        converter=convert_real,
    )
    rising: Loops = field(default=(), converter=to_loops, eq=False)
    rising_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)
    hanging: Loops = field(default=(), converter=to_loops, eq=False)
    hanging_heights: tuple[float, ...] = field(default=(), converter=convert_finite_heights)

    def __attrs_post_init__(self) -> None:
        for name, value in (
            ("thickness", self.thickness),
            ("tip radius", self.tip_radius),
            ("distance inside the triangle", self.inside),
        ):
            if not (isfinite(value) and value > 0):
                raise InputError(f"{name} {value:g} cannot be used: give a length above 0.")
            refuse_long(name, value)
        for name, value in (
            ("pad radius", self.pad_radius),
            ("pad margin", self.pad_margin),
            ("tip margin", self.tip_margin),
            ("head radius", self.head_radius),
        ):
            if not (isfinite(value) and value >= 0):
                raise InputError(f"{name} {value:g} cannot be used: give 0 or more.")
            refuse_long(name, value)
        for low, high in (band for band in (self.band, *(self.bands or ())) if band is not None):
            if not 0 <= low <= high <= self.thickness:
                raise InputError(
                    f"a peg cannot press at heights {low:g} to {high:g} of a part {self.thickness:g} thick: "
                    "give "
                    "a band between 0 and the thickness, the smaller height first."
                )
        for loops, heights in (
            (self.top or (), self.top_heights),
            (self.rising, self.rising_heights),
            (self.hanging, self.hanging_heights),
        ):
            if heights is not None and len(heights) != len(loops):
                raise InputError(
                    f"there are {len(loops)} loops of upper faces and {len(heights)} heights: give one for "
                    "each."
                )
        if self.point is not None and not all(map(isfinite, self.point)):
            raise InputError("the clamp's point is not a place: give finite coordinates in mm.")

    @classmethod
    def from_workpiece(
        cls,
        workpiece: Workpiece,
        thickness: float | None = None,
        *,
        pad_radius: float | None = None,
        tip_radius: float | None = None,
        toolkit: Toolkit | None = None,
    ) -> SupportRequest:
        """Return the usual request for a part:
        thickness and level faces are those of its solid, radii those of the toolkit.

        Parameters
        ----------
        thickness : in mm; that of the solid if None.
        pad_radius, tip_radius : in mm; the usual ones if None.
        toolkit : toolkit that holds the part; its own supports and clamp on top are used. If it has none, the
            usual pad is made small enough for the toolkit's holes.

        Raises
        ------
        InputError
            When the thickness of the part is not known.

        Examples
        --------
        >>> plate = Workpiece.from_loops("plate", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
        >>> SupportRequest.from_workpiece(plate, 12).pad_radius
        4.0
        """
        solid = workpiece.solid
        if thickness is None and solid is None:
            raise InputError("the thickness of the part is not known: give it in mm.")
        pads = toolkit.supports if toolkit is not None and toolkit.supports is not None else SupportPads()
        clamp = toolkit.top_clamp if toolkit is not None and toolkit.top_clamp is not None else TopClamp()
        tip_radius = clamp.tip_radius if tip_radius is None else tip_radius
        tip_radius = TIP_RADIUS if tip_radius is None else tip_radius
        if pad_radius is None:
            pad_radius = find_usual_pad_radius(toolkit)
        return cls(
            thickness=solid.height if thickness is None and solid is not None else thickness,
            pad_radius=pad_radius,
            tip_radius=tip_radius,
            bottom=None if solid is None else solid.bottom,
            top=None if solid is None else solid.top,
            top_heights=None if solid is None else solid.top_heights or None,
            pad_margin=0.0 if pads.pad_margin is None else pads.pad_margin,
            inside=tip_radius if clamp.inside is None else clamp.inside,
            reach=clamp.reach,
            tip_margin=0.0 if clamp.tip_margin is None else clamp.tip_margin,
            head_radius=compute_usual_head(tip_radius) if clamp.head_radius is None else clamp.head_radius,
            **({} if solid is None else {name: getattr(solid, name) for name in BESIDE_TOP}),
        )

    def find_clamped_height(self, point: tuple[float, float]) -> float:
        """Return the height in mm of the highest upper face at a point (x, y) of the part;
        the thickness where none is known.
        """
        found = self.thickness
        for height in sorted(set(self.top_heights or ())):
            loops = [
                loop
                for loop, own in zip(self.top or (), self.top_heights or (), strict=True)
                if own == height
            ]
            rows = make_segment_rows([segment for loop in loops for segment in make_loop_segments(loop)])
            if is_inside(*point, rows):
                found = min(height, self.thickness)
        return found

    def adapt_to_fixture(
        self,
        fixture: Fixture,
        solid: SolidOutline | None,
        peg_height: float | None = None,
        numbered: NumberedOutlines | None = None,
    ) -> SupportRequest:
        """Return the request with its bands filled in:
        those given, else the heights at which each peg can press on a solid.

        Parameters
        ----------
        peg_height : height of the pegs in mm above the plane on which a prism lies; None for the prism's
            height.
        numbered : the segments of the part with the run of heights over each; if None, pegs press only within
            the bands of their faces.
        """
        whole = (0.0, self.thickness if peg_height is None else min(peg_height, self.thickness))
        if self.band is not None or self.bands is not None or solid is None:
            return self if self.band is not None else evolve(self, band=whole)
        own = [
            find_touched_band(peg, solid)
            if numbered is None
            else find_pressed_heights(peg, fixture, numbered)
            for peg in fixture.pegs
        ]
        cut = (band and (min(band[0], self.thickness), min(band[1], self.thickness)) for band in own)
        return evolve(self, band=whole, bands=tuple(cut))

    def list_peg_bands(self, pegs: int) -> NDArray[np.float64]:
        """Return the bands (P, 2), low and high in mm, of P pegs.

        Raises
        ------
        InputError
            When the numbers of bands and of pegs differ.
        """
        bands = self.bands or (None,) * pegs
        if len(bands) != pegs:
            raise InputError(
                f"there are {len(bands)} bands for {pegs} pegs: give one for each, or one for all."
            )
        others = (0.0, self.thickness) if self.band is None else self.band
        return np.array([others if band is None else band for band in bands], np.float64)

    def refuse_fat_pads(self, toolkit: Toolkit) -> None:
        """Raise InputError where pads in neighbouring holes of a toolkit would overlap."""
        apart = find_least_hole_distance(toolkit)
        if 2 * self.pad_radius > apart:
            raise InputError(
                f"pads of radius {self.pad_radius:g} would overlap {apart:g} mm apart: give a smaller "
                "pad radius."
            )


def find_usual_pad_radius(toolkit: Toolkit | None) -> float:
    """Return the radius in mm of the pads of a toolkit's own supports, else the usual one.

    The usual radius is reduced to half the least distance between holes, unless that is less than the
    smallest pad. For None it is the usual one.
    """
    if toolkit is None:
        return PAD_RADIUS
    if toolkit.supports is not None and toolkit.supports.pad_radius is not None:
        return toolkit.supports.pad_radius
    room = find_least_hole_distance(toolkit) / 2
    return min(PAD_RADIUS, room) if room >= LEAST_PAD_RADIUS else PAD_RADIUS


def find_least_hole_distance(toolkit: Toolkit) -> float:
    """Return the least distance in mm between two holes of a toolkit: a pitch, or the gap between two plates'
    holes.
    """
    apart = [pitch for plate in toolkit.plates for pitch in plate.pitch]
    if toolkit.gap is not None and len(toolkit.plates) > 1:
        apart.append(toolkit.gap)
    return min(apart)


def find_touched_band(peg: Peg, solid: SolidOutline) -> Span | None:
    """Return the band (low, high) in mm of the face that a peg touches; None where it has none.

    On a corner it spans the bands of both faces.
    """
    faces = (peg.face,) if peg.beside is None else (peg.face, peg.beside)
    bands = [band for face in faces if (band := solid.bands[face]) is not None]
    if not bands:
        return None
    return min(low for low, _ in bands), max(high for _, high in bands)


def find_pressed_heights(peg: Peg, fixture: Fixture, numbered: NumberedOutlines) -> Span | None:
    """Return the heights (low, high) in mm at which a peg can press where it touches its face; None if there
    are none.

    On a corner they span those of both faces.
    """
    faces = (peg.face,) if peg.beside is None else (peg.face, peg.beside)
    point = fixture.pose.inverse.apply(peg.x, peg.y)
    runs = [run for face in faces if (run := numbered.find_pressed_band(face, point)) is not None]
    if not runs:
        return None
    return min(low for low, _ in runs), max(high for _, high in runs)
