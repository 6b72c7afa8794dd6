"""Requests for supports under a fixture and a clamp on top, checked by pydantic; lengths in mm."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import ConfigDict, Field, TypeAdapter

from workhold.model.support_request import SpatialLoad
from workhold.web.form import (
    LARGEST,
    MOST_LOADS,
    MOST_POINTS,
    MOST_RANGES,
    MOST_VERTICES,
    BandForm,
    Form,
    LoopForm,
    Name,
    Number,
    Point,
    of_address,
)

__all__ = ["ChosenSupportsForm", "FirstSideForm", "SpatialLoadForm", "SupportsForm", "asked_of"]

Asked = TypeVar("Asked", bound=Form)

# Sets of three supports that are listed at most.
MOST_SETS = 50

Length = Annotated[float, Field(ge=0, le=LARGEST)]
Ring = Annotated[list[Number], Field(min_length=4, max_length=4)]
Zones = Annotated[list[LoopForm], Field(max_length=MOST_RANGES)]

EXAMPLE: dict[str, Any] = {
    "thickness": 12,
    "pad_radius": 4,
    "tip_radius": 5,
    "loads": [{"points": [[20, 15]], "force": 150, "heights": [8, 12], "axial": [-20, 60]}],
    "best": 3,
}


class SpatialLoadForm(Form):
    """A load in space, in N, mm, degrees and N mm; without heights it acts at the part's upper side.

    ``axial`` is the force downward, negative where a tool pulls; ``tilt`` are the moments about x and y.
    """

    name: Name = ""
    points: list[Point] = Field(default=[], max_length=MOST_POINTS)
    force: Number = 0.0
    directions: Point = Field(default=[0.0, 360.0])
    heights: BandForm | None = None
    axial: Point = Field(default=[0.0, 0.0])
    moment: Number = 0.0
    tilt: Point = Field(default=[0.0, 0.0])

    def load(self) -> SpatialLoad:
        """The load.

        Raises
        ------
        InputError
            When it is none.
        """
        return SpatialLoad(**self.model_dump())


class SupportsForm(Form):
    """What supports and the clamp on top are, and what acts on the part.

    Of a solid the thickness, the level faces and the heights of its walls are known. What is left out is as
    usual. ``bottom_zones`` keep pads off, ``top_zones`` the clamp. Loads are those of the search where none
    are given.
    """

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    thickness: Annotated[float, Field(gt=0, le=LARGEST)] | None = None
    band: BandForm | None = None
    pad_radius: Length | None = None
    pad_margin: Length | None = None
    tip_radius: Annotated[float, Field(gt=0, le=LARGEST)] | None = None
    inside: Annotated[float, Field(gt=0, le=LARGEST)] | None = None
    bottom_zones: Zones = Field(default=[])
    top_zones: Zones = Field(default=[])
    reach: Annotated[list[Ring], Field(max_length=MOST_RANGES)] | None = None
    point: Point | None = None
    loads: Annotated[list[SpatialLoadForm], Field(max_length=MOST_LOADS)] | None = None
    jaw_force: Length | None = None
    best: Annotated[int, Field(ge=1, le=MOST_SETS)] = 3
    unit: Literal["mm", "inch"] = "mm"


class ChosenSupportsForm(SupportsForm):
    """One of the sets of three that are answered to the same request, from 1."""

    chosen: Annotated[int, Field(ge=1, le=MOST_SETS)] = 1


class FirstSideForm(Form):
    """The set-up before: a fixture of another job, and which faces of its part it cuts."""

    job: Name
    rank: Annotated[int, Field(ge=1, le=10**9)]
    cut: list[Annotated[int, Field(ge=0, le=MOST_VERTICES)]] = Field(default=[], max_length=MOST_VERTICES)


def asked_of(form: type[Asked], name: str, text: str | None) -> Asked | None:
    """A value of an address that is JSON of a form; None where none is given.

    Raises
    ------
    InputError
        For anything else.
    """
    return None if text is None else of_address(TypeAdapter(form), name, text)
