"""Supports and the clamp on top as bodies in space, and the fixture with them written out.

The part lies on the supports at z = 0, and the plates lie below by the height of the supports. Each pad has
a pin down through the hole it stands in. The clamp is drawn as a screw from above, a tip, a spindle and a
knob over the point where it presses: what holds it nobody says.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier
from workhold.fixels.pegs import peg_outline
from workhold.model.bodies import BodyKind, BodySizes, FixtureBody, Slab, fixture_bodies, way_open
from workhold.model.fixture import Fixture, Peg, Pose
from workhold.model.shown import shown
from workhold.model.support_triples import SupportPad, Supports, Triple

__all__ = ["SUPPORT_HEIGHT", "bodies_with_supports", "support_bodies", "triple_of_rank", "written_out"]

# Of supports above the plates, in mm, where nobody says.
SUPPORT_HEIGHT = 6.0
# Of the screw on top, in mm: how high its tip, its spindle and its knob are, and their radii in tips.
SCREW = ((3.0, 1.0), (18.0, 0.6), (6.0, 1.5))


def triple_of_rank(supports: Supports, rank: int) -> Triple:
    """The set of three of a rank from 1.

    Raises
    ------
    InputError
        When there is none.
    """
    if not 1 <= rank <= len(supports.triples):
        raise InputError(f"there is no set {rank} of supports: {len(supports.triples)} are listed.")
    return supports.triples[rank - 1]


def bodies_with_supports(
    supports: Supports, triple: Triple, sizes: BodySizes | None = None
) -> tuple[FixtureBody, ...]:
    """All bodies of a fixture that stands as a set of three asks for, with its supports and its clamp on top.

    Parameters
    ----------
    sizes : heights, those of the supports included; the usual ones if None.

    Raises
    ------
    InputError
        For pegs or pads of radius 0, which have no body.
    """
    query, (fixture, _) = supports.query, written_out(supports, triple)
    if sizes is None:
        sizes = BodySizes.of(query.workpiece, supports.request.thickness, support_height=SUPPORT_HEIGHT)
    more = support_bodies(supports, triple, sizes)
    return fixture_bodies(fixture, query.workpiece, query.toolkit, sizes, more)


def support_bodies(supports: Supports, triple: Triple, sizes: BodySizes) -> tuple[FixtureBody, ...]:
    """The three supports of a set and the clamp on top, in the frame of :func:`written_out`.

    Raises
    ------
    InputError
        For pads of radius 0, which have no body.
    """
    if supports.request.pad_radius <= 0.0:
        raise InputError("pads of radius 0 have no body to write or show: give a pad radius.")
    fixture, pads = written_out(supports, triple)
    carriers = {
        one.carrier.name: one
        for one in shown(fixture, supports.query.toolkit, supports.query.workpiece).carriers
    }
    out = []
    for pad in pads:
        center = fixture.pose.apply(pad.x, pad.y)
        carrier = carriers[pad.carrier]
        low, radius = -sizes.support_height, supports.request.pad_radius
        slabs = [
            Slab(tuple(peg_outline(center, carrier.carrier.peg_radius)), (), low - sizes.plate_thickness, low)
        ]
        if low < 0.0:
            slabs.append(Slab(tuple(peg_outline(center, radius)), (), low, 0.0))
        out.append(FixtureBody(f"support {pad.hole}", BodyKind.SUPPORT, tuple(slabs), way_open(carrier)))
    center, low = fixture.pose.apply(*triple.clamp_at), sizes.thickness
    slabs = []
    for height, share in SCREW:
        outline = tuple(peg_outline(center, share * supports.request.tip_radius))
        slabs.append(Slab(outline, (), low, low + height))
        low += height
    return (*out, FixtureBody("clamp on top", BodyKind.CLAMP, tuple(slabs)))


def written_out(supports: Supports, triple: Triple) -> tuple[Fixture, tuple[SupportPad, ...]]:
    """The fixture and its supports with holes as they are counted once the jaws stand where a set asks for.

    Two jaws stand nearer together for supports between the pegs, so that columns and the opening may differ
    from the planar fixture's. Pegs and supports stand where they stood relative to the part. A fixture that
    has room for the supports as it is written comes back unchanged.
    """
    fixture, pads = supports.fixture, triple.supports
    plates = supports.query.toolkit.plates
    if len(plates) != 2 or triple.travel is None:
        return fixture, pads
    pitch = plates[0].pitch
    nearer = round((fixture.jaw_separation - triple.travel) / pitch[0])
    names = [one.name for one in plates]
    standing = [(one.carrier, one.column, one.row) for one in fixture.pegs if one.carrier in names]
    standing += [(one.carrier, one.column, one.row) for one in pads]
    for left, lift in shifts(plates[0]):
        shift = {names[0]: left, names[1]: left + nearer}
        moved = [(names.index(name), column + shift[name], row + lift) for name, column, row in standing]
        if all(is_usable(plates[number], column, row) for number, column, row in moved):
            break
    else:
        return fixture, pads
    x, y = left * pitch[0], lift * pitch[1]

    def written(peg: Peg) -> Peg:
        if peg.carrier not in shift:
            return peg
        column, row = peg.column + shift[peg.carrier], peg.row + lift
        return evolve(peg, column=column, row=row, x=peg.x + x, y=peg.y + y)

    pose = Pose(fixture.pose.theta_deg, fixture.pose.x + x, fixture.pose.y + y)
    return (
        evolve(
            fixture,
            pegs=tuple(map(written, fixture.pegs)),
            pose=pose,
            jaw_separation=triple.travel,
        ),
        tuple(evolve(pad, column=pad.column + shift[pad.carrier], row=pad.row + lift) for pad in pads),
    )


def shifts(plate: Carrier) -> Iterator[tuple[int, int]]:
    """Columns and rows by which pegs and supports may be written elsewhere, the smallest changes first."""
    columns = plate.columns or 0
    rows = 4 * columns + 8 if plate.rows is None else plate.rows
    both = product(range(-columns, columns + 1), range(-rows, rows + 1))
    return iter(sorted(both, key=lambda one: (abs(one[0]) + abs(one[1]), one)))


def is_usable(plate: Carrier, column: int, row: int) -> bool:
    """Whether a plate has a hole that is not blocked."""
    inside = 0 <= column < plate.column_count and row >= 0
    return inside and (plate.rows is None or row < plate.rows) and not plate.is_blocked(column, row)
