"""What every request has in common: its form, and the numbers, names and loops in it."""

from __future__ import annotations

from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from workhold.errors import InputError
from workhold.files.input_forms import TAGS

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
    "of_address",
    "sentence_of",
]

Asked = TypeVar("Asked")

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


def of_address(adapter: TypeAdapter[Asked], name: str, text: str) -> Asked:
    """A value of an address that is JSON.

    Raises
    ------
    InputError
        For anything that the adapter does not take.
    """
    try:
        return adapter.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        raise InputError(sentence_of({**first, "loc": ("query", name, *map(str, first["loc"]))})) from error


def sentence_of(error: dict[str, Any]) -> str:
    """One thing that pydantic finds wrong with a request, as a sentence."""
    loc = [str(part) for part in error.get("loc", ()) if part not in TAGS]
    if error.get("type") == "json_invalid":
        return "The request is not valid JSON: send one object."
    where, rest = (loc[0], loc[1:]) if loc else ("body", [])
    place = ".".join(rest)[:120]
    message = str(error.get("msg", "not what it should be")).strip().rstrip(".")
    message = message[:1].lower() + message[1:200]
    if where == "body":
        return f"The request is not as it should be{f' at {place}' if place else ''}: {message}."
    return f"The {where} value {place} of the address is not as it should be: {message}."
