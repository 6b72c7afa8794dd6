"""Jobs: parts that are asked for, and what they shall be held in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from attrs import define, field, frozen

from workhold.batch.naming import name_of
from workhold.batch.tasks import Answering, Reading
from workhold.errors import InputError
from workhold.files.part.finding import read_bytes
from workhold.files.part_list import ListedPart
from workhold.files.result.writer import asked_entry
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece

__all__ = ["ANY_PART", "HeldIn", "Job", "Part", "Request"]

# Stands for any part in the queries that wait for theirs.
ANY_PART = Workpiece.from_loops("any", [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])


@frozen(eq=False, slots=False)
class HeldIn:
    """A toolkit, and what is asked of the fixtures in it.

    Parameters
    ----------
    name : what the toolkit is called.
    query : of :data:`ANY_PART`, whose place the part takes; or why nothing can be asked.
    """

    name: str
    query: Query | InputError

    @cached_property
    def entry(self) -> dict[str, Any]:
        """What is asked as it is written, which tells it from anything else that could be.

        Raises
        ------
        InputError
            When it cannot be asked.
        """
        if isinstance(self.query, InputError):
            raise self.query
        return asked_entry(self.query)


@frozen(eq=False)
class Request:
    """A part, and all that it shall be held in.

    Parameters
    ----------
    listed : the part.
    options : of reading it, see ``files.part.load.read_workpiece``.
    held_in : the toolkits; most parts share them.
    """

    listed: ListedPart
    options: Mapping[str, Any]
    held_in: Sequence[HeldIn]


@define(eq=False)
class Part:
    """A part as far as it is known.

    Parameters
    ----------
    request : what is asked of it.
    name : of the task that reads it; empty where its file cannot be opened.
    refusal : why it cannot be read; empty where it can.
    content : hash of what was read; empty before.
    faces, size : how many faces it has, and its width and height in mm.
    remarks : what there is to tell about the drawing.
    """

    request: Request
    name: str = ""
    refusal: str = ""
    content: str = ""
    faces: int = 0
    size: tuple[float, float] = (0.0, 0.0)
    remarks: tuple[str, ...] = ()

    @classmethod
    def of(cls, request: Request) -> Part:
        """A part before it is read."""
        try:
            return cls(request, reading_of(request).name)
        except InputError as error:
            return cls(request, refusal=str(error))

    def reading(self) -> Reading:
        """The task that reads it.

        Raises
        ------
        InputError
            When the file cannot be opened any more.
        """
        return reading_of(self.request)

    def take(self, record: Mapping[str, Any]) -> None:
        """Take note of what was read."""
        self.refusal = record["refusal"]
        if not self.refusal:
            self.content = name_of(record["loops"], record["departure"])
            self.faces, self.remarks = record["faces"], tuple(record["remarks"])
            width, height = record["size"]
            self.size = (width, height)


def reading_of(request: Request) -> Reading:
    """The task that reads a part.

    Raises
    ------
    InputError
        When its file cannot be opened.
    """
    path = request.listed.path
    content = read_bytes(path)
    ending = Path(path).suffix.lower()
    name = name_of(content, ending, dict(request.options))
    return Reading(name, request.listed.name, ending, content, request.options)


@define(eq=False)
class Job:
    """A part with something it shall be held in.

    Parameters
    ----------
    part, held_in : these.
    name : of its task; empty where there is none.
    refusal : why there is none: the part cannot be read, or this cannot be asked; empty otherwise.
    estimate : predicted seconds of its task.
    failure : why its task has failed, though it might not do so again; empty otherwise.
    """

    part: Part
    held_in: HeldIn
    name: str = ""
    refusal: str = ""
    estimate: float = 0.0
    failure: str = field(default="", init=False)

    @property
    def title(self) -> str:
        """What it is called where people see it."""
        return f"{self.part.request.listed.name} in {self.held_in.name}"

    def answering(self, record: bytes, best: int) -> Answering:
        """Its task, from the record of its part."""
        assert isinstance(self.held_in.query, Query)
        return Answering(self.name, self.title, record, self.held_in.query, best)
