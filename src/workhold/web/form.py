"""What every request has in common: its form, and the numbers, names and loops in it."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "LARGEST",
    "MOST_LOADS",
    "MOST_POINTS",
    "MOST_RANGES",
    "MOST_VERTICES",
    "BandForm",
    "Form",
    "LoopForm",
    "Name",
    "Number",
    "Point",
]

# Beyond this, in mm, degrees, N or N mm, a number is a mistake.
LARGEST = 1e9
MOST_VERTICES, MOST_LOADS, MOST_POINTS, MOST_RANGES = 20_000, 50, 500, 50

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Point = Annotated[list[Number], Field(min_length=2, max_length=2)]
Vertex = Annotated[list[Number], Field(min_length=3, max_length=3)]
LoopForm = Annotated[list[Vertex], Field(min_length=1, max_length=MOST_VERTICES)]
BandForm = Annotated[list[Annotated[float, Field(ge=0, le=LARGEST)]], Field(min_length=2, max_length=2)]
Name = Annotated[str, Field(max_length=200)]


class Form(BaseModel):
    """The base of all requests.

    Keys that are not known are refused. So are numbers written as text, and numbers that are not finite.
    What is too long or too many is refused as well, and the sentence says how much is taken.
    """

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
