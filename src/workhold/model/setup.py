"""Part zero (X0 Y0 of the program), and the length to set for each moving carrier.

By default part zero is the origin of the drawing, because the CAM system uses the same drawing. If the origin
lies outside the part's outside dimensions, part zero is the lower left corner of the part as drawn. So a part
cut out of a large assembly, far from its origin, does not get a zero beside the machine.

The setting of a vise is its opening. The setting of a clamp bolted in a hole is the stroke, from the hole to
the tip. If only the clamp's line is known, it is the distance of the tip from the first column or row. Every
picture, sheet and table shows the setting.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from attrs import frozen

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.fixels.carrier import Carrier, Measure
from workhold.fixels.contacts import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Point, compute_bounding_box
from workhold.limits import refuse_long
from workhold.model.fixture import Fixture, Peg
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = [
    "LengthSetting",
    "PartZero",
    "name_contacts",
    "find_hole_centers",
    "choose_part_zero",
    "list_length_settings",
]

WAYS = "give corner, centre, hole and its number, or a point of the drawing as X,Y"


@frozen
class PartZero:
    """A part's zero.

    Parameters
    ----------
    point : in mm in the part's coordinates, which are those of its drawing.
    words : phrase that names the point, such as "centre of hole 2".
    """

    point: Point
    words: str


def choose_part_zero(
    workpiece: Workpiece, asked: str | Sequence[float] | None = None, unit: Unit = MILLIMETRE
) -> PartZero:
    """Return part zero as asked for, else the default described at the head of this module.

    Parameters
    ----------
    workpiece : the part; for a raw block the finished part in it counts.
    asked : "corner" (the lower left one of the outside dimensions), "centre" (of the same), "hole N" (its
        centre), "X,Y" or two numbers. None is the default at the head of this module. Holes are counted from
        1 as in the inset of the setup sheet.
    unit : unit of the numbers.

    Raises
    ------
    InputError
        For anything else, and a hole that the part does not have.

    Examples
    --------
    >>> far = Workpiece.from_loops("plate", [[[2000, 0, 0], [2040, 0, 0], [2040, 20, 0], [2000, 20, 0]]])
    >>> [choose_part_zero(far, asked).point for asked in (None, "centre", "2010,5")]
    [(2000.0, 0.0), (2020.0, 10.0), (2010.0, 5.0)]
    """
    workpiece = workpiece.as_finished
    x0, y0, x1, y1 = workpiece.bounds
    if asked is None:
        within = min(-x0, -y0, x1, y1) >= -AGREEMENT
        return (
            PartZero((0.0, 0.0), "origin of the drawing") if within else choose_part_zero(workpiece, "corner")
        )
    if not isinstance(asked, str):
        return PartZero(check_point(list(map(str, asked)), str(asked), unit), "point given")
    word = asked.strip().lower()
    if word == "corner":
        return PartZero((x0, y0), "lower left corner as drawn")
    if word in ("centre", "center"):
        return PartZero(workpiece.center, "centre of the outside dimensions")
    if word.startswith("hole"):
        number, centers = word.removeprefix("hole").strip(), find_hole_centers(workpiece)
        if number.isascii() and number.isdigit() and 0 < int(number[:9]) <= len(centers):
            return PartZero(centers[int(number) - 1], f"centre of hole {int(number)}")
        count = {0: "no hole", 1: "one hole"}.get(len(centers), f"holes 1 to {len(centers)}")
        raise InputError(f"part zero {asked[:40]!r} cannot be used: the part has {count}; {WAYS}.")
    return PartZero(check_point(asked.split(","), repr(asked[:40]), unit), "point given")


def check_point(numbers: Sequence[str], words: str, unit: Unit) -> Point:
    """Return the point in mm given by two numbers in the unit.

    Raises InputError unless there are exactly two finite numbers, not too large; ``words`` names the point in
    messages.
    """
    try:
        x, y = (unit.to_mm(float(number)) for number in numbers)
    except (ValueError, OverflowError):
        x = y = float("nan")
    if not (isfinite(x) and isfinite(y)):
        raise InputError(f"part zero {words} is not known: {WAYS}.")
    for value in (x, y):
        refuse_long("part zero", value)
    return x, y


def find_hole_centers(workpiece: Workpiece) -> list[Point]:
    """Return the centre (x, y) in mm of each hole, in the order of the part's loops.

    A round hole has the centre of its circle, any other the middle of its bounding box.
    """
    outer = workpiece.outer_count
    round_ones = {
        face.number: face.segment.center
        for face in workpiece.faces
        if face.number >= outer and isinstance(face.segment, Arc) and face.segment.is_full
    }
    centers, number = [], outer
    for loop in workpiece.hole_segments:
        boxes = [compute_bounding_box(segment) for segment in loop]
        middle = [(min(box[k] for box in boxes) + max(box[k + 2] for box in boxes)) / 2 for k in (0, 1)]
        x, y = round_ones.get(number, middle)
        centers.append((float(x), float(y)))
        number += len(loop)
    return centers


@frozen
class Mounting:
    """Words for putting a clamp on its plate; ``{clamp}`` is its name, ``{place}`` its hole or line.

    Parameters
    ----------
    label : text above the place.
    there : phrase on the place of the clamp.
    put : instruction for putting it on the plate.
    how : beginning of a sentence on the length to measure; ``{title}`` is the setting's title.
    then : the length to measure once the tip touches, with placeholders for the setting's title and name.
    """

    label: str
    there: str
    put: str
    how: str
    then: str


BOLTED = Mounting(
    "bolted in",
    "bolted in {place}",
    "Bolt {clamp} in {place}",
    "Stroke: from the centre of hole {place} to the centre of the tip",
    "Its {name}",
)
ALONG = Mounting(
    "along",
    "on {place}",
    "Set {clamp} so that its tip is on {place}",
    "{title}, to its centre",
    "The {title},",
)
MOUNTINGS: Mapping[Measure, Mounting] = {"stroke": BOLTED, "tip": ALONG}


@frozen
class LengthSetting:
    """A length to set.

    Parameters
    ----------
    name : name in sentences, such as "opening S".
    title : name above the length itself.
    sign : symbol before the length on a drawing, such as "S".
    length : in mm.
    start, end : points between which the length is measured along the travel, in mm.
    carrier : the carrier that moves.
    tip : the peg of a clamp that touches the part; None of a carrier with a lattice of pegs.
    """

    name: str
    title: str
    sign: str
    length: float
    start: Point
    end: Point
    carrier: Carrier
    tip: Peg | None = None

    @property
    def short(self) -> str:
        """Name over a column of such lengths."""
        return self.name if self.carrier.measure == "tip" else self.sign

    @property
    def mounting(self) -> Mounting:
        """Words for putting the clamp on its plate."""
        return MOUNTINGS[self.carrier.measure]

    @property
    def label(self) -> str:
        """Heading above the clamp's place."""
        return f"{self.carrier.noun.capitalize()} {self.mounting.label}"

    @property
    def place(self) -> str:
        """The clamp's hole or line, without the noun; "" where ``tip`` is None."""
        if self.tip is None:
            return ""
        return self.carrier.name_place(self.tip.column, self.tip.row).removeprefix(f"{self.carrier.noun} ")

    @property
    def caption(self) -> str:
        """Title with a capital letter."""
        return f"{self.title[0].upper()}{self.title[1:]}"


def list_length_settings(fixture: Fixture, toolkit: Toolkit) -> tuple[LengthSetting, ...]:
    """Return the lengths to set: one for a vise's opening,
    one for each moving clamp in order; () where nothing moves.

    Examples
    --------
    >>> from workhold.model.fixture import Pose
    >>> from workhold import Plate
    >>> plate, tip = Plate(pitch=20, peg_radius=3, travel=(10, 30)), Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0)
    >>> (setting,) = list_length_settings(Fixture("clamp", (tip,), Pose(0, 0, 0), -14.0, {}, "-x"), plate)
    >>> setting.sign, setting.length, setting.start
    ('stroke', 14.0, (80.0, 20.0))
    """
    clamps = [peg for peg in fixture.pegs if toolkit.find_carrier(peg.carrier).contact is CLAMP_TIP]
    if clamps:
        return tuple(
            measure_clamp_setting(tip, toolkit, travelled, len(clamps))
            for tip, travelled in zip(clamps, fixture.travels, strict=True)
            if toolkit.find_carrier(tip.carrier).travel is not None
        )
    travelled, name = fixture.travel, "opening S"
    return tuple(
        LengthSetting(
            name=name,
            title=f"{name} of the {carrier.noun}s",
            sign="S",
            length=travelled,
            start=carrier.compute_hole_center(0, 0),
            end=carrier.compute_hole_center(0, 0, travelled),
            carrier=carrier,
        )
        for carrier in toolkit.carriers
        if carrier.travel is not None and (carrier.has_lattice or carrier.is_jaw)
    )


def measure_clamp_setting(tip: Peg, toolkit: Toolkit, travelled: float, clamps: int) -> LengthSetting:
    """Return the length to set on one clamp: its stroke, or its tip's distance from the first column or row.

    Parameters
    ----------
    travelled : travel of the clamp in mm.
    clamps : number of clamps of the fixture; with several the clamp is named by its place.
    """
    carrier, end = toolkit.find_carrier(tip.carrier), (tip.x, tip.y)
    named = f"the {carrier.noun}" if clamps == 1 else carrier.name_place(tip.column, tip.row)
    if carrier.measure == "stroke":
        start, stroke = carrier.compute_hole_center(tip.column, tip.row), 0.0 - toolkit.clamping * travelled
        return LengthSetting(
            "stroke", f"stroke of {named}, from hole to tip", "stroke", stroke, start, end, carrier, tip
        )
    column, row = toolkit.datum.lines
    if carrier.line == "row":
        sign, first, length, start = "x", column, tip.x, (0.0, tip.y)
    else:
        sign, first, length, start = "y", row, tip.y, (tip.x, 0.0)
    return LengthSetting(
        f"tip {sign}", f"tip of {named}, {sign} from {first}", sign, length, start, end, carrier, tip
    )


def name_contacts(fixture: Fixture, toolkit: Toolkit) -> list[str]:
    """Return the name of each contact of a fixture, in the order of its pegs.

    It is the name of the peg's hole, or of the clamp's hole or line; the only clamp of a fixture is called by
    its noun.
    """
    clamps = [peg for peg in fixture.pegs if toolkit.find_carrier(peg.carrier).contact is CLAMP_TIP]
    return [toolkit.find_carrier(peg.carrier).noun if [peg] == clamps else peg.hole for peg in fixture.pegs]
