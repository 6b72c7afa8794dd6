"""Requests that send a part, checked by pydantic: outline, solid, and outlines of carriers' own heights."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from workhold.errors import InputError
from workhold.model.own_outlines import with_own_outlines
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece
from workhold.web.form import (
    LARGEST,
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

__all__ = ["WorkpieceForm", "asked_heights", "checked_part"]

FacesForm = Annotated[list[Annotated[int, Field(ge=0, le=1_000_000)]], Field(max_length=10_000)]


class SolidForm(Form):
    """How the solid of an outline stands, and the heights at which each segment is touched; lengths in mm."""

    axis: Literal["x", "y", "z", "-x", "-y", "-z"]
    height: Annotated[float, Field(gt=0, le=LARGEST)]
    peg_height: Annotated[float, Field(gt=0, le=LARGEST)]
    head_room: Annotated[float, Field(ge=0, le=LARGEST)]
    least_band: Annotated[float, Field(ge=0, le=LARGEST)]
    bands: Annotated[list[BandForm | None], Field(max_length=MOST_VERTICES)]
    faces: Annotated[list[FacesForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    bottom: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    top: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    top_heights: Annotated[list[Number], Field(max_length=MOST_VERTICES)] = Field(default=[])


class OwnOutlineForm(Form):
    """What a carrier meets that touches between two heights of its own, as a result file has it."""

    heights: Point
    loops: Annotated[list[LoopForm], Field(min_length=1, max_length=MOST_VERTICES)]
    bands: Annotated[list[BandForm | None], Field(max_length=MOST_VERTICES)]
    solid_faces: Annotated[list[FacesForm], Field(max_length=MOST_VERTICES)] = Field(default=[])


class WorkpieceForm(Form):
    """A part; lengths in mm. Of a solid ``outlines`` are by role those of carriers with own heights."""

    name: Name = "part"
    loops: Annotated[list[LoopForm], Field(min_length=1, max_length=MOST_VERTICES)]
    departure: Annotated[float, Field(ge=0, le=LARGEST)] = 0.0
    solid: SolidForm | None = None
    outlines: Annotated[dict[Name, OwnOutlineForm], Field(max_length=MOST_RANGES)] = Field(default={})

    def workpiece(self, most_segments: int) -> Workpiece:
        """The part.

        Raises
        ------
        InputError
            For loops that cannot be used, and for too many segments.
        """
        solid = None if self.solid is None else SolidOutline(**self.solid.model_dump())
        workpiece = checked_part(self.name, self.loops, most_segments, self.departure, solid)
        if not self.outlines:
            return workpiece
        refuse_many(sum(len(loop) for one in self.outlines.values() for loop in one.loops), most_segments)
        entries = {role: one.model_dump() for role, one in self.outlines.items()}
        heights = {role: (one.heights[0], one.heights[1]) for role, one in self.outlines.items()}
        with numbers_too_large():
            return with_own_outlines(workpiece, entries, heights)


def checked_part(
    name: str,
    loops: Sequence[Sequence[Sequence[float]]],
    most_segments: int,
    departure: float = 0.0,
    solid: SolidOutline | None = None,
) -> Workpiece:
    """A part of loops in mm, with how far they may be from what was drawn.

    Raises
    ------
    InputError
        For loops that cannot be used, and for more segments than this server takes.
    """
    refuse_many(sum(map(len, loops)), most_segments)
    with numbers_too_large():
        return Workpiece.from_loops(name, loops, departure=departure, solid=solid)


def refuse_many(count: int, most: int) -> None:
    """Refuses a part of more segments than a server takes.

    Raises
    ------
    InputError
        With both numbers.
    """
    if count > most:
        raise InputError(
            f"The part has {count} segments, more than the {most} this server takes: draw its outline with "
            "lines and arcs instead of many short pieces."
        )


@contextmanager
def numbers_too_large() -> Iterator[None]:
    """Says of numbers with which arithmetic fails that they are too large or too small.

    Raises
    ------
    InputError
        Instead of errors of arithmetic.
    """
    try:
        yield
    except (ArithmeticError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            "The part's numbers are too large or too small to compute with: check its units."
        ) from error


SeveralHeights = TypeAdapter(Annotated[dict[Name, Point], Field(max_length=MOST_RANGES)])


def asked_heights(text: str | None) -> dict[str, tuple[float, float]] | None:
    """The heights of carriers in an address, JSON by role in mm; None where none are given.

    Raises
    ------
    InputError
        For anything else, and for heights of which the lower does not come first.
    """
    if text is None:
        return None
    found = {role: (low, high) for role, (low, high) in of_address(SeveralHeights, "heights", text).items()}
    for role, (low, high) in found.items():
        if not (low < high and high > 0.0):
            raise InputError(
                f"the heights {low:g} and {high:g} of the {role} are none: give the lower end first, and the "
                "upper one above 0 mm."
            )
    return found
