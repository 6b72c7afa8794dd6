"""The shape of a whole result file, fixtures included, for its JSON Schema.

A file is not read by these forms: a million fixtures are collected into arrays (``files.result.reader``).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from workhold.files.result.forms import Head, Pair, Part
from workhold.files.result.seating_forms import SeatingPart

__all__ = ["FixturePart", "ResultFile"]

Whole = Annotated[int, Field(ge=0)]


class ContactPart(Part):
    """Where a peg's centre is in mm, the face it touches, and its force per unit of clamping force, or of each of two."""

    x: float
    y: float
    segment: Whole = Field(description="number of the face that is touched")
    force: float | Pair


class JawPegPart(ContactPart):
    """A peg in a hole of a vise's jaw."""

    jaw: Literal["left", "right"]
    column: Whole
    row: Whole


class LocatorPart(ContactPart):
    """A peg in a hole of a plate, which stands still or slides with a jaw."""

    role: Literal["locator", "jaw"]
    column: Whole
    row: Whole


class ClampPart(ContactPart):
    """The tip of a clamp, the hole it is bolted in where that is known, and the row or column that it pushes along."""

    role: Literal["clamp"]
    hole: Annotated[list[Whole], Field(min_length=2, max_length=2)] | None
    row: Whole | None = None
    column: Whole | None = None
    direction: str | None = None


class WallPart(Part):
    """The contact with a fence, from one end to the other."""

    from_: Pair = Field(alias="from")
    to: Pair
    segments: Annotated[list[Whole], Field(min_length=2, max_length=2)]
    forces: list[float | Pair]


class PosePart(Part):
    """Where the workpiece lies."""

    theta_deg: float
    x: float
    y: float


class FixturePart(Part):
    """One fixture; best first."""

    type: str
    direction: str | None = None
    directions: list[str] | None = None
    wall: WallPart | None = None
    ratio: list[float | None] | None = None
    pegs: list[JawPegPart | LocatorPart | ClampPart] = Field(min_length=2, max_length=5)
    pose: PosePart
    jaw_separation: float | None = None
    flats: list[float | None] | None = Field(None, description="which way the flat of each peg looks, in degrees")
    pairs: Whole | None = None
    quality: dict[str, float] = Field(default_factory=dict)
    seating: SeatingPart | None = None


class ResultFile(Head):
    """A result file; lengths in mm, angles in degrees."""

    fixtures: list[FixturePart]
