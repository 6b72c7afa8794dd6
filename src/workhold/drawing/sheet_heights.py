"""Heights on a setup sheet: of part, pegs, supports and plates, and which of them nobody said.

Glossary
--------
lying plane : the plane on which the part lies, z = 0: the supports' upper side, or that of the plates.
"""

from __future__ import annotations

from attrs import field, frozen

from workhold.drawing.sheet_facts import SheetDetails
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.model.bodies import SUPPORT_HEIGHT, THICKNESS
from workhold.model.fixture import Fixture
from workhold.model.own_outlines import numbered_solid
from workhold.model.recounted import ChosenSupports
from workhold.model.solid import Band
from workhold.model.support_bodies import height_of_supports
from workhold.model.workpiece import Workpiece

__all__ = ["SheetHeights", "heights_of", "lift_of"]


@frozen
class SheetHeights:
    """Heights in mm, z upward from the lying plane.

    Parameters
    ----------
    thickness : of the part.
    peg_top : up to which pegs reach.
    head_room : kept free above the pegs; None of a part that is no solid.
    supported_by : height of the supports, 0 without them.
    plate_thickness : of the plates, through which pegs stand.
    peg_length : of the pegs.
    clamped_height : of the face on which the clamp on top presses; None without one.
    bands : of each peg of the fixture the heights at which it presses; None where nobody knows.
    assumed : names of those of these that nobody said.
    """

    thickness: float
    peg_top: float
    head_room: float | None
    supported_by: float
    plate_thickness: float
    peg_length: float
    bands: tuple[Band | None, ...]
    assumed: frozenset[str] = field(default=frozenset())
    clamped_height: float | None = None

    @property
    def above_plate(self) -> float:
        """How far the pegs stand out of the plates."""
        return self.peg_top + self.supported_by

    @property
    def known_up_to(self) -> float:
        """The height up to which the outline is that of the part."""
        top = self.thickness if self.head_room is None else self.peg_top + self.head_room
        return min(top, self.thickness)

    def sure(self, name: str) -> str:
        """What stands behind a height that was assumed, and nothing behind another one."""
        return " (assumed)" if name in self.assumed else ""


def heights_of(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails
) -> SheetHeights | None:
    """The heights of a set-up; None where nobody knows how thick the part is.

    Raises
    ------
    InputError
        For pegs that end below the part.
    """
    solid, supports = workpiece.solid, details.supports
    thickness = details.thickness
    if thickness is None and supports is not None:
        thickness = supports.supports.request.thickness
    if thickness is None and solid is not None:
        thickness = solid.height
    if thickness is None:
        return None
    assumed = set()
    lift = lift_of(supports, details.support_height)
    if supports is not None and details.support_height is None and height_of_supports(toolkit) is None:
        assumed.add("supported_by")
    plate = THICKNESS if details.plate_thickness is None else details.plate_thickness
    if details.plate_thickness is None:
        assumed.add("plate_thickness")
    if details.peg_height is not None:
        top = details.peg_height - lift
    elif solid is not None:
        top = min(solid.peg_height, thickness)
    else:
        top = thickness
        assumed.add("peg_top")
    if top <= 0:
        raise InputError(
            f"pegs {details.peg_height:g} mm high end below the part, which lies {lift:g} mm above the "
            "plates: give a larger peg height, or lower supports."
        )
    if details.peg_length is None:
        assumed.add("peg_length")
    return SheetHeights(
        thickness=thickness,
        peg_top=top,
        head_room=None if solid is None else solid.head_room,
        supported_by=lift,
        plate_thickness=plate,
        peg_length=top + lift + plate if details.peg_length is None else details.peg_length,
        bands=bands_of_pegs(fixture, workpiece, details, thickness, top),
        assumed=frozenset(assumed),
        clamped_height=clamped_at(supports, thickness),
    )


def clamped_at(supports: ChosenSupports | None, thickness: float) -> float | None:
    """The height of the face on which the clamp presses in mm; None without supports."""
    if supports is None:
        return None
    request = supports.supports.request
    asked = request.clamped_height(supports.clamp.at)
    return thickness if asked == request.thickness else min(asked, thickness)


def lift_of(supports: ChosenSupports | None, support_height: float | None) -> float:
    """How far the part lies above the plates in mm: as high as its supports, or 0 without any."""
    if supports is None:
        return 0.0
    own = height_of_supports(supports.supports.query.toolkit) if support_height is None else support_height
    return SUPPORT_HEIGHT if own is None else own


def bands_of_pegs(
    fixture: Fixture, workpiece: Workpiece, details: SheetDetails, thickness: float, top: float
) -> tuple[Band | None, ...]:
    """The heights at which each peg presses: as supports were asked for, of the solid, or of a prism."""
    supports, solid = details.supports, numbered_solid(workpiece)
    if supports is not None:
        reach = supports.supports.query.peg_height
        given = supports.supports.request.for_fixture(fixture, solid, reach).peg_bands(len(fixture.pegs))
        return tuple((float(low), float(high)) for low, high in given)
    if solid is not None:
        return tuple(solid.bands[peg.face] for peg in fixture.pegs)
    return tuple((0.0, min(top, thickness)) for _ in fixture.pegs)
