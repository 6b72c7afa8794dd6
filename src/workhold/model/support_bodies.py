"""Supports and the clamp on top as bodies in space, with the fixture that stands on them.

The part lies on the supports at z = 0, and the plates lie below by the height of the supports. Each pad has
a pin down through the hole it stands in. The clamp is drawn as a screw from above, a tip, a spindle and a
knob over the point where it presses: what holds it nobody says. Where it presses on a face lower than the
part is high, the part, which is drawn as a prism of its outline, has room for it above that face.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.pegs import make_peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Point, measure_distance_to_segment, segment_rows
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
from workhold.model.shown import shown
from workhold.model.support_triples import ChosenSupports, SupportPad, Supports, Triple

__all__ = [
    "list_bodies_on_supports",
    "list_bodies_with_supports",
    "size_clamp_pieces",
    "clamped_height",
    "find_support_height",
    "size_supported_bodies",
    "with_room",
]

# Of the screw on top, in mm: how high its tip and its knob are, and the least height of its spindle; their
# radii in tips. The knob stands so far above part and pegs that it touches neither.
TIP, SPINDLE, KNOB = (3.0, 1.0), (18.0, 0.6), (6.0, 1.5)
KNOB_ROOM = 5.0


def find_support_height(toolkit: Toolkit) -> float | None:
    """How high the supports are that a toolkit has, in mm; None where nobody says."""
    return None if toolkit.supports is None else toolkit.supports.height


def size_supported_bodies(
    supports: Supports,
    *,
    peg_length: float | None = None,
    peg_height: float | None = None,
    support_height: float | None = None,
    thickness: float | None = None,
) -> BodySizes:
    """Heights of the bodies of a fixture on supports, in mm; the usual ones where nobody says.

    Parameters
    ----------
    peg_length, peg_height : of the pegs, and how far they stand out of the plates.
    support_height : of the supports above the plates; if None that of the toolkit's own.
    thickness : of the part; that which the supports were asked for if None.

    Raises
    ------
    InputError
        For a length that is not positive, as of pegs that end below the part.
    """
    own = find_support_height(supports.query.toolkit) if support_height is None else support_height
    raised = SUPPORT_HEIGHT if own is None else own
    return BodySizes.of(
        supports.query.workpiece,
        supports.request.thickness if thickness is None else thickness,
        peg_length=peg_length,
        peg_height=None if peg_height is None else peg_height - raised,
        support_height=raised,
    )


def list_bodies_with_supports(
    chosen: ChosenSupports, sizes: BodySizes | None = None
) -> tuple[FixtureBody, ...]:
    """All bodies of a fixture as a set of three asks for, in holes that have names.

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
    """The bodies of a fixture on the supports of a set, with these and the clamp on top last.

    Parameters
    ----------
    fixture, pads : as their holes are counted, see ``model.support_triples``.
    sizes : heights, those of the supports included.

    Raises
    ------
    InputError
        For pegs or pads of radius 0, which have no body.
    """
    if supports.request.pad_radius <= 0.0:
        raise InputError("pads of radius 0 have no body to write or show: give a pad radius.")
    query, clamp = supports.query, screw(supports, triple, fixture, sizes)
    more = (*make_pad_bodies(supports, fixture, pads, sizes), clamp)
    part, *others = list_fixture_bodies(fixture, query.workpiece, query.toolkit, sizes, more)
    center, radius = fixture.pose.apply(*triple.clamp.at), supports.request.tip_radius
    slabs = [piece for slab in part.slabs for piece in with_room(slab, center, radius, clamp.slabs[0].low)]
    return evolve(part, slabs=tuple(slabs)), *others


def with_room(slab: Slab, center: Point, radius: float, low: float) -> Iterator[Slab]:
    """A slab of a part with room above a height in mm for what stands within a circle there.

    A circle inside leaves a round well. One that meets the border of the slab leaves nothing of it above the
    height.
    """
    border = [segment for loop in (slab.outer, *slab.holes) for segment in loop]
    away = min(measure_distance_to_segment(center, segment) for segment in border)
    inside = is_inside(*center, segment_rows(border))
    if low >= slab.high or (away >= radius and not inside):
        yield slab
        return
    yield evolve(slab, high=low)
    if away >= radius + FILM:
        yield evolve(slab, holes=(*slab.holes, (Arc(center, radius, 0.0, pi, -1.0),)), low=low)


def make_pad_bodies(
    supports: Supports, fixture: Fixture, pads: Sequence[SupportPad], sizes: BodySizes
) -> Iterator[FixtureBody]:
    """The supports: each a pad under the part, with its pin through the plate."""
    query, floor = supports.query, sizes.floor
    carriers = {one.carrier.name: one for one in shown(fixture, query.toolkit, query.workpiece).carriers}
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
    """Heights in mm of the pieces of the clamp on top, from its tip upward, and their radii in tips.

    Parameters
    ----------
    low : where the tip presses.
    highest : of what the knob has to stand above.
    """
    spindle = max(SPINDLE[0], highest + KNOB_ROOM - low - TIP[0])
    return TIP, (spindle, SPINDLE[1]), KNOB


def clamped_height(supports: Supports, triple: Triple, sizes: BodySizes) -> float:
    """The height in mm of the upper face on which the clamp presses."""
    asked = supports.request.clamped_height(triple.clamp.at)
    return sizes.thickness if asked == supports.request.thickness else min(asked, sizes.thickness)


def screw(supports: Supports, triple: Triple, fixture: Fixture, sizes: BodySizes) -> FixtureBody:
    """The clamp on top, its tip on the upper face at its place."""
    center, low, slabs = fixture.pose.apply(*triple.clamp.at), clamped_height(supports, triple, sizes), []
    for height, share in size_clamp_pieces(low, max(sizes.thickness, sizes.top, sizes.others)):
        outline = tuple(make_peg_outline(center, share * supports.request.tip_radius))
        slabs.append(Slab(outline, (), low, low + height))
        low += height
    return FixtureBody("clamp on top", BodyKind.CLAMP, tuple(slabs))
