"""An owner's hardware beside a toolkit: supports, a clamp on top and limits of pins.

Every kind of toolkit may have all of them. Each figure is a row of a table, from which files, requests and
constructors are made; None stands for the usual value. Files leave out hardware that a toolkit does not have.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any, ClassVar, TypeAlias

from attrs import field, frozen
from attrs.converters import optional

from workhold.errors import InputError
from workhold.fixels.table import FieldTable, PageLabel, ToolkitField
from workhold.limits import convert_real, refuse_long

__all__ = [
    "CLAMP",
    "HARDWARE",
    "PADS",
    "PINS",
    "SUPPORTS",
    "TOP_CLAMP",
    "PinLimits",
    "SupportPads",
    "TopClamp",
    "convert_hardware",
]

# What the tables are called in a toolkit's file, and in all that the program writes.
SUPPORTS, TOP_CLAMP, PINS = "supports", "top_clamp", "pins"

Rings = tuple[tuple[float, ...], ...]
# What stands in a field of the page that is empty.
USUAL = "usual"


# Sections of the command's help.
SUPPORTS_SECTION, CLAMP_SECTION = "Supports", "The clamp on top"


def make_length_field(
    name: str, least: Any, figure: str, label: str, typed: str = "", section: str | None = None
) -> ToolkitField:
    """Return a field of hardware that is a length.

    Parameters
    ----------
    least : smallest value, see ``ToolkitField``.
    figure : name of the figure in texts; also the help.
    label : label on the page.
    typed : help of the command's option; empty for no option.
    section : of the command's help.
    """
    labels, help = (PageLabel(label, USUAL),), f"{figure[:1].upper()}{figure[1:]}."
    return ToolkitField(
        name, "length", help, labels, least=least, figure=figure, typed=typed, section=section
    )


def convert_rings(values: Iterable[Iterable[Any]] | None) -> Rings | None:
    """Return rings (sequences of numbers) as a tuple of tuples of floats; None for None."""
    return None if values is None else tuple(tuple(convert_real(one) for one in ring) for ring in values)


PADS = FieldTable(
    SUPPORTS,
    "Supports under the part",
    (
        make_length_field(
            "pad_radius",
            "0",
            "radius of the supports' pads",
            "Pad radius",
            "Radius of the supports' round pads. If not given, the toolkit's, or 4mm, or less where "
            "the distance of the holes asks for less.",
            SUPPORTS_SECTION,
        ),
        make_length_field(
            "pad_margin",
            "0",
            "from a pad to the border of the face below",
            "Pad to border",
            "Least distance of a pad from the border of the face below; the toolkit's, or 0mm, if not given.",
            SUPPORTS_SECTION,
        ),
        make_length_field("height", "above 0", "height of the supports", "Height"),
    ),
)
CLAMP = FieldTable(
    TOP_CLAMP,
    "A clamp on top",
    (
        make_length_field(
            "tip_radius",
            "above 0",
            "radius of the tip of the clamp on top",
            "Tip radius",
            "Radius of the clamp's round tip; the toolkit's, or 5mm, if not given.",
            CLAMP_SECTION,
        ),
        make_length_field(
            "inside",
            "above 0",
            "from the clamp on top to the supports' triangle",
            "Tip within the triangle",
            "Least distance of the clamp from the triangle's sides; the toolkit's, or the tip's radius, if not "
            "given.",
            CLAMP_SECTION,
        ),
        make_length_field(
            "tip_margin",
            "0",
            "from the tip of the clamp on top to the border of its face",
            "Tip to border",
            "Least distance of the tip from the border of its face; the toolkit's, or 0mm, if not given.",
            CLAMP_SECTION,
        ),
        make_length_field(
            "head_radius",
            "above 0",
            "radius of the head of the clamp on top",
            "Head radius",
            "Radius of the clamp's head. Within this radius the part must not rise above the "
            "face. If not given, the toolkit's, or one and a half times the tip's radius.",
            CLAMP_SECTION,
        ),
        ToolkitField(
            "reach",
            "rings",
            "Places in which the tip of the clamp on top can stand.",
            (PageLabel("Reaches about x, y from least to most", "anywhere"),),
            typed="A ring about a point of the toolkit, in which the tip of the clamp can stand. If not "
            "given, the toolkit's rings, or everywhere.",
            section=CLAMP_SECTION,
        ),
    ),
)
LIMITS = FieldTable(
    PINS,
    "Limits of pins",
    (
        ToolkitField(
            "stress_limit",
            "stress",
            "largest bending stress of a pin",
            (PageLabel("Bending stress", USUAL),),
            figure="largest bending stress of a pin",
        ),
        make_length_field(
            "movement_limit",
            "above 0",
            "farthest that pins may give way under the part",
            "Part moved by bending pins",
        ),
    ),
)


def refuse_wrong(hardware: Hardware) -> None:
    """Raise InputError for lengths, stresses or rings of hardware that are out of range."""
    for row in hardware.table.fields:
        value, words = getattr(hardware, row.name), f"{hardware.table.noun.replace('_', '-')}: {row.words}"
        if row.form in ("length", "stress") and value is not None:
            if not isfinite(value) or value < 0 or (value == 0 and row.least == "above 0"):
                above = "a length above 0" if row.form == "length" else "MPa above 0"
                least = "0 or more" if row.least == "0" else above
                raise InputError(f"{words} {value:g} cannot be used: give {least}.")
            refuse_long(words, value)
        if row.form == "rings":
            for ring in value or ():
                if len(ring) != 4 or not all(map(isfinite, ring)) or not 0 <= ring[2] <= ring[3]:
                    raise InputError(
                        f"{words} is not a list of rings: give for each ring x, y, the least and the most distance."
                    )
                for one in ring:
                    refuse_long(words, one)


@frozen(kw_only=True)
class SupportPads:
    """The supports under the part that an owner has; lengths in mm, None for the program's usual value.

    Parameters
    ----------
    pad_radius : of the round pads.
    pad_margin : smallest distance from a pad to the border of the face that it supports.
    height : of the supports above the plates.

    Raises
    ------
    InputError
        For invalid lengths.

    Examples
    --------
    >>> SupportPads(pad_radius=3).pad_radius
    3.0
    """

    table: ClassVar[FieldTable] = PADS

    pad_radius: float | None = field(default=None, converter=optional(convert_real))
    pad_margin: float | None = field(default=None, converter=optional(convert_real))
    height: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        refuse_wrong(self)


@frozen(kw_only=True)
class TopClamp:
    """The owner's clamp that presses on the part from above; lengths in mm.

    None stands for the program's usual value.

    Parameters
    ----------
    tip_radius : radius of its round tip.
    inside : smallest distance from its tip's centre to each side of the supports' triangle.
    reach : rings (x, y, least, most) in the toolkit's frame in which its tip can stand; None for anywhere.
    tip_margin : smallest distance of its tip from the border of the face on which it presses.
    head_radius : radius within which no part of the workpiece may rise above that face.

    Raises
    ------
    InputError
        For invalid lengths and rings.
    """

    table: ClassVar[FieldTable] = CLAMP

    tip_radius: float | None = field(default=None, converter=optional(convert_real))
    inside: float | None = field(default=None, converter=optional(convert_real))
    reach: Rings | None = field(default=None, converter=convert_rings)
    tip_margin: float | None = field(default=None, converter=optional(convert_real))
    head_radius: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        refuse_wrong(self)


@frozen(kw_only=True)
class PinLimits:
    """Limits of the bending of pegs, above which the program warns; None for the usual limits in
    ``conventions``.

    Parameters
    ----------
    stress_limit : largest bending stress in MPa.
    movement_limit : largest movement in mm of a point of the part by bending pegs.

    Raises
    ------
    InputError
        For invalid numbers.
    """

    table: ClassVar[FieldTable] = LIMITS

    stress_limit: float | None = field(default=None, converter=optional(convert_real))
    movement_limit: float | None = field(default=None, converter=optional(convert_real))

    def __attrs_post_init__(self) -> None:
        refuse_wrong(self)


Hardware: TypeAlias = SupportPads | TopClamp | PinLimits
# The classes by the names of the toolkits' fields.
HARDWARE: Mapping[str, type[Hardware]] = {SUPPORTS: SupportPads, TOP_CLAMP: TopClamp, PINS: PinLimits}


def convert_hardware(name: str, value: Any) -> Hardware | None:
    """Return the hardware for a toolkit's field from a mapping of values by name.

    None and hardware that is already made are returned unchanged.

    Parameters
    ----------
    name : of the toolkit's field: "supports", "top_clamp" or "pins".

    Raises
    ------
    InputError
        For any other value, and for unknown figures.

    Examples
    --------
    >>> convert_hardware("supports", {"height": 8}).height
    8.0
    """
    kind = HARDWARE[name]
    if value is None or isinstance(value, kind):
        return value
    known = [row.name for row in kind.table.fields]
    words = f"{name.replace('_', '-')}: "
    if not isinstance(value, Mapping):
        raise InputError(f"{words}{value!r} is not a table: give some of {', '.join(known)}.")
    for one in value:
        if one not in known:
            raise InputError(f"{words}there is no {str(one)[:40]!r}: give some of {', '.join(known)}.")
    for row in kind.table.fields:
        given = value.get(row.name)
        if given is not None and isinstance(given, list | tuple) != (row.form == "rings"):
            wanted = "a list of rings [x, y, least, most]" if row.form == "rings" else "one number"
            raise InputError(f"{words}{row.words} cannot be used: give {wanted}.")
    return kind(**value)
