"""Bodies of a fixture with supports under the part and a clamp on top, from those of the fixture alone.

The part stays where it is, its underside at z = 0; plates and all that stands on them are lowered by the
height of the supports. Heights that nobody says are those of the setup sheet.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from attrs import evolve

from workhold.drawing.sheet_heights import SUPPORT_HEIGHT
from workhold.fixels.carrier import Carrier
from workhold.geometry.segment import Arc, Point
from workhold.model.bodies import BodyKind, BodySizes, FixtureBody, Slab, fixture_bodies
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.support_request import SupportRequest
from workhold.model.support_triples import SupportPad

__all__ = ["TIP_LENGTH", "sizes_with", "supported_bodies"]

# How far the clamp from above is drawn over the part, in mm.
TIP_LENGTH = 14.0


def sizes_with(
    query: Query,
    request: SupportRequest,
    peg_length: float | None = None,
    peg_height: float | None = None,
) -> BodySizes:
    """Heights in mm counted from the part's underside.

    Parameters
    ----------
    peg_length, peg_height : of the pegs, and how far they stand out of the plates; None where nobody says.

    Raises
    ------
    InputError
        For a length that is not positive, as of pegs that end below the part.
    """
    top = None if peg_height is None else peg_height - SUPPORT_HEIGHT
    sizes = BodySizes.of(query.workpiece, request.thickness, peg_height=top)
    length = sizes.peg_length + SUPPORT_HEIGHT if peg_length is None else peg_length
    return evolve(sizes, peg_length=length)


def supported_bodies(
    fixture: Fixture,
    query: Query,
    request: SupportRequest,
    pads: Sequence[tuple[str, SupportPad]],
    clamp: Point,
    sizes: BodySizes,
) -> tuple[FixtureBody, ...]:
    """The bodies of a fixture on supports, with the supports and the clamp from above last.

    Parameters
    ----------
    pads : the supports with the names of their holes.
    clamp : where the clamp presses, (x, y) in mm in the part's coordinates.
    sizes : heights, see :func:`sizes_with`.

    Raises
    ------
    InputError
        For pegs of radius 0, which have no body.
    """
    toolkit = query.toolkit
    bodies = [lowered(body) for body in fixture_bodies(fixture, query.workpiece, toolkit, sizes)]
    ways = {body.name: body.opens for body in bodies if body.kind is BodyKind.PLATE}
    floor = -SUPPORT_HEIGHT - sizes.plate_thickness

    def support(name: str, pad: SupportPad) -> FixtureBody:
        carrier: Carrier = toolkit.carrier(pad.carrier)
        center = placed(fixture, pad.x, pad.y)
        foot = disc(center, min(carrier.peg_radius, request.pad_radius), floor, -SUPPORT_HEIGHT)
        head = disc(center, request.pad_radius, -SUPPORT_HEIGHT, 0.0)
        return FixtureBody(f"support {name}", BodyKind.SUPPORT, (foot, head), ways.get(carrier.title))

    tip = disc(placed(fixture, *clamp), request.tip_radius, request.thickness, request.thickness + TIP_LENGTH)
    above = FixtureBody("clamp from above", BodyKind.CLAMP, (tip,))
    return (*bodies, *(support(name, pad) for name, pad in pads), above)


def placed(fixture: Fixture, x: float, y: float) -> Point:
    """A point of the part in the toolkit's frame."""
    px, py = fixture.pose.apply(x, y)
    return float(px), float(py)


def disc(center: Point, radius: float, low: float, high: float) -> Slab:
    """A round slab."""
    return Slab((Arc(center, radius, 0.0, pi, 1.0),), (), low, high)


def lowered(body: FixtureBody) -> FixtureBody:
    """A body as it stands once the part lies on supports: the part and the tops of the others stay."""
    if body.kind in (BodyKind.PART, BodyKind.PEG):
        return body
    slabs = [evolve(slab, low=slab.low - SUPPORT_HEIGHT) for slab in body.slabs]
    ends = [slab.high - SUPPORT_HEIGHT if slab.high <= 0.0 else slab.high for slab in slabs]
    return evolve(body, slabs=tuple(evolve(slab, high=end) for slab, end in zip(slabs, ends, strict=True)))
