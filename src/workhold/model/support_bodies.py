"""Supports and the clamp on top as bodies in space, with the fixture on them.

The part lies on the supports at z = 0, and the plates lie below by the height of the supports. Each pad has a
pin down through its hole. The clamp is drawn as a screw from above: a tip, a spindle and a knob over the
point where it presses; its mount is not known. The part is drawn as a prism of its outline. If the clamp
presses on a face below the part's top, room for it is cut out above that face.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.pegs import make_peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Point, make_segment_rows, measure_distance_to_segment
from workhold.kernels.base.distance import is_inside
from workhold.model.bodies import (
    FILM,
    SUPPORT_HEIGHT,
    BodyKind,
    BodySizes,
    FixtureBody,
    Slab,
    find_opening_direction,
    list_fixture_bodies,
)
from workhold.model.fixture import Fixture
from workhold.model.shown import find_shown
from workhold.model.support_triples import ChosenSupports, SupportPad, Supports, Triple

__all__ = [
    "list_bodies_on_supports",
    "list_bodies_with_supports",
    "size_clamp_pieces",
    "find_clamped_height",
    "find_support_height",
    "size_supported_bodies",
    "cut_room",
]

# Of the screw on top, in mm: how high its tip and its knob are, and the least height of its spindle; their
# radii in tips. The knob stands so far above part and pegs that it touches neither.
TIP, SPINDLE, KNOB = (3.0, 1.0), (18.0, 0.6), (6.0, 1.5)
KNOB_ROOM = 5.0


def find_support_height(toolkit: Toolkit) -> float | None:
    """Return the height in mm of a toolkit's own supports; None if it has none or gives no height."""
    return None if toolkit.supports is None else toolkit.supports.height


def size_supported_bodies(
    supports: Supports,
    *,
    peg_length: float | None = None,
    peg_height: float | None = None,
    support_height: float | None = None,
    thickness: float | None = None,
) -> BodySizes:
    """Return the heights in mm of the bodies of a fixture on supports, with defaults for what is None.

    Parameters
    ----------
    peg_length, peg_height : length of the pegs, and their standout above the plates.
    support_height : height of the supports above the plates; if None that of the toolkit's own.
    thickness : thickness of the part; if None the one for which the supports were computed.

    Raises
    ------
    InputError
        For a length that is not positive, such as that of pegs that end below the part.
    """
    own = find_support_height(supports.query.toolkit) if support_height is None else support_height
    raised = SUPPORT_HEIGHT if own is None else own
    return BodySizes.from_workpiece(
        supports.query.workpiece,
        supports.request.thickness if thickness is None else thickness,
        peg_length=peg_length,
        peg_height=None if peg_height is None else peg_height - raised,
        support_height=raised,
    )


def list_bodies_with_supports(
    chosen: ChosenSupports, sizes: BodySizes | None = None
) -> tuple[FixtureBody, ...]:
    """Return all bodies of a fixture on the chosen supports,
    with its holes renumbered so that all have names.

    Parameters
    ----------
    sizes : heights, those of the supports included; those of :func:`size_supported_bodies` if None.

    Raises
    ------
    InputError
        For pegs or pads of radius 0, which have no body.
    """
    return list_bodies_on_supports(
        chosen.supports,
        chosen.triple,
        chosen.recounted.fixture,
        chosen.pads,
        size_supported_bodies(chosen.supports) if sizes is None else sizes,
    )


def list_bodies_on_supports(
    supports: Supports, triple: Triple, fixture: Fixture, pads: Sequence[SupportPad], sizes: BodySizes
) -> tuple[FixtureBody, ...]:
    """Return the bodies of a fixture on a set of supports:
    first those of the fixture, then supports, then the clamp on top.

    Parameters
    ----------
    fixture, pads : fixture and pads, renumbered so that all their holes have names, see
        ``model.support_triples``.
    sizes : heights, those of the supports included.

    Raises
    ------
    InputError
        For pegs or pads of radius 0, which have no body.
    """
    if supports.request.pad_radius <= 0.0:
        raise InputError("pads of radius 0 have no body to write or show: give a pad radius.")
    query, clamp = supports.query, make_clamp_screw(supports, triple, fixture, sizes)
    more = (*make_pad_bodies(supports, fixture, pads, sizes), clamp)
    part, *others = list_fixture_bodies(fixture, query.workpiece, query.toolkit, sizes, more)
    center, radius = fixture.pose.apply(*triple.clamp.at), supports.request.tip_radius
    slabs = [piece for slab in part.slabs for piece in cut_room(slab, center, radius, clamp.slabs[0].low)]
    return evolve(part, slabs=tuple(slabs)), *others


def cut_room(slab: Slab, center: Point, radius: float, low: float) -> Iterator[Slab]:
    """Yield a slab of a part, cut so that a vertical cylinder above the height ``low`` is free, all in mm.

    A cylinder inside the slab leaves a round well. If it meets the slab's border, all material above ``low``
    is removed. A slab that it does not reach is yielded unchanged.
    """
    border = [segment for loop in (slab.outer, *slab.holes) for segment in loop]
    away = min(measure_distance_to_segment(center, segment) for segment in border)
    inside = is_inside(*center, make_segment_rows(border))
    if low >= slab.high or (away >= radius and not inside):
        yield slab
        return
    yield evolve(slab, high=low)
    if away >= radius + FILM:
        yield evolve(slab, holes=(*slab.holes, (Arc(center, radius, 0.0, pi, -1.0),)), low=low)


def make_pad_bodies(
    supports: Supports, fixture: Fixture, pads: Sequence[SupportPad], sizes: BodySizes
) -> Iterator[FixtureBody]:
    """Yield the supports: each a pin through the plate, and a pad up to the part if that lies above the
    plates.
    """
    query, floor = supports.query, sizes.floor
    carriers = {one.carrier.name: one for one in find_shown(fixture, query.toolkit, query.workpiece).carriers}
    for pad in pads:
        center, carrier = fixture.pose.apply(pad.x, pad.y), carriers[pad.carrier]
        pin = tuple(make_peg_outline(center, carrier.carrier.peg_radius))
        slabs = [Slab(pin, (), floor - sizes.plate_thickness, floor)]
        if floor < 0.0:
            slabs.append(Slab(tuple(make_peg_outline(center, supports.request.pad_radius)), (), floor, 0.0))
        yield FixtureBody(
            f"support {pad.hole}", BodyKind.SUPPORT, tuple(slabs), find_opening_direction(carrier)
        )


def size_clamp_pieces(low: float, highest: float) -> tuple[tuple[float, float], ...]:
    """Return (height in mm, radius over tip radius) of the tip, spindle and knob of the clamp on top.

    Parameters
    ----------
    low : height at which the tip presses, in mm.
    highest : height of part and pegs in mm; the knob must be above it.
    """
    spindle = max(SPINDLE[0], highest + KNOB_ROOM - low - TIP[0])
    return TIP, (spindle, SPINDLE[1]), KNOB


def find_clamped_height(supports: Supports, triple: Triple, sizes: BodySizes) -> float:
    """Return the height in mm of the upper face under the clamp's tip."""
    asked = supports.request.find_clamped_height(triple.clamp.at)
    return sizes.thickness if asked == supports.request.thickness else min(asked, sizes.thickness)


def make_clamp_screw(supports: Supports, triple: Triple, fixture: Fixture, sizes: BodySizes) -> FixtureBody:
    """Return the clamp on top as a body, its tip on the upper face at its place."""
    center, low, slabs = (
        fixture.pose.apply(*triple.clamp.at),
        find_clamped_height(supports, triple, sizes),
        [],
    )
    for height, share in size_clamp_pieces(low, max(sizes.thickness, sizes.top, sizes.others)):
        outline = tuple(make_peg_outline(center, share * supports.request.tip_radius))
        slabs.append(Slab(outline, (), low, low + height))
        low += height
    return FixtureBody("clamp on top", BodyKind.CLAMP, tuple(slabs))
