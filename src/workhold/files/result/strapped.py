"""Seats under straps in a result file, checked and read; :mod:`workhold.files.result.strapped_text` writes them."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, radians
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.files.result.bending_forms import BendingPart
from workhold.files.result.forms import FormPart
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.jaw_hold import ProgramJawForce
from workhold.model.pose import Pose
from workhold.model.quality import FIGURES
from workhold.model.query import Query
from workhold.model.straps import HandPush, Strap, StrappedHold

__all__ = ["ProgramForcePart", "StrappedSeatPart", "check_strapped", "make_strapped_table"]

LARGEST, MOST_HOLES = 1e9, 1_000_000
Whole = Annotated[int, Field(ge=0)]
Hole = Annotated[int, Field(ge=0, le=MOST_HOLES)]
HolePair = Annotated[list[Hole], Field(min_length=2, max_length=2)]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Point = Annotated[list[Number], Field(min_length=2, max_length=2)]
# Of what quality says, what is not a figure.
NOT_FIGURES = {"full_contact", "clamp_needed_each", "safety_reached_each"}


class StrappedPegPart(FormPart):
    """A locator in a hole of the plate: its centre in mm, and the face that it touches."""

    role: Literal["locator"] = "locator"
    column: Hole
    row: Hole
    x: Number
    y: Number
    segment: Whole


class StrappedPosePart(FormPart):
    """Pose of the workpiece."""

    theta_deg: Number
    x: Number
    y: Number


class StrapPart(FormPart):
    """A strap: the hole of its bolt, the point where its tip presses, the hole of the support under that
    point or "plate", and the height of its heel.
    """

    hole: HolePair
    at: Point
    over: Literal["plate"] | HolePair = "plate"
    heel: Number


class PushPart(FormPart):
    """A push by hand that seats the part: the point, the direction, and
    the share of the push on each locator.
    """

    at: Point
    direction_deg: Number
    shares: list[Number] = Field(default=[])


class StrappedQualityPart(FormPart):
    """Figures, in mm, degrees and N."""

    location_error: Number | None = None
    end_distance: Number | None = None
    edge_distance: Number | None = None
    tilt: Number | None = None
    smallest_face: Number | None = None
    full_contact: bool | None = None
    clamp_needed: Number | None = None
    clamp_needed_each: list[Number | None] = Field(
        default=[], description="for each load in its order; null where no force of the straps holds it"
    )
    safety_reached: Number | None = None
    safety_reached_each: list[Number | None] = Field(
        default=[],
        description="with a given force of the straps: how many times it holds each load; null for any number",
    )


class ProgramForcePart(FormPart):
    """The clamp force in N that the program's tools need, of flat jaws or
    of each strap, and the move that needs it.
    """

    force: Number | None = Field(description="null where no force is enough")
    line: int
    tool: int
    move: Whole = Field(description="number of the program's move, from 0")
    safety_reached: Number | None = Field(
        default=None,
        description="how many times the given force of the straps holds the part; null for any number",
    )

    def to_need(self) -> ProgramJawForce:
        """Return the force as an object of the model."""
        return ProgramJawForce(self.force, self.line, self.tool, self.move)


class StrappedSeatPart(FormPart):
    """A seat of three locators, with the straps that hold the part down there; the file lists the best seat
    first.
    """

    type: str
    pegs: list[StrappedPegPart] = Field(min_length=3, max_length=3)
    pose: StrappedPosePart
    looked_at: bool = True
    straps: list[StrapPart] = Field(max_length=4)
    supports: list[HolePair] = Field(
        default=[],
        max_length=3,
        description="holes of the three that the part lies on; none: it lies on the plate",
    )
    places: Whole | None = None
    push: PushPart | None
    quality: StrappedQualityPart
    program_force: ProgramForcePart | None = None
    bending: BendingPart | None = None

    def to_fixture(self, toolkit: Toolkit, unit_force: float | None = None) -> Fixture:
        """Return the seat as a fixture, with the figures that are written in the file.

        ``unit_force`` is passed on by :meth:`to_hold`.
        """
        plate = toolkit.plates[0]
        pegs = tuple(
            Peg(plate.name, one.column, one.row, one.x, one.y, one.segment, 0.0) for one in self.pegs
        )
        pose = Pose(self.pose.theta_deg, self.pose.x, self.pose.y)
        written = self.quality.model_dump(exclude=NOT_FIGURES, exclude_none=True)
        return Fixture(self.type, pegs, pose, 0.0, written, hold=self.to_hold(toolkit, unit_force))

    def to_hold(self, toolkit: Toolkit, unit_force: float | None = None) -> StrappedHold:
        """Return how straps hold the part; raise InputError for a toolkit without straps.

        ``unit_force`` is None where the query gives no force of the straps; its value is not used.
        """
        if toolkit.strap_set is None:
            raise InputError(f"straps hold it, which a {toolkit.noun} does not have.")
        push = self.push
        return StrappedHold(
            tuple(
                Strap(
                    (a, b),
                    (x, y),
                    one.heel,
                    None if isinstance(one.over, str) else (one.over[0], one.over[1]),
                )
                for one in self.straps
                for a, b in [one.hole]
                for x, y in [one.at]
            ),
            None
            if push is None
            else HandPush((push.at[0], push.at[1]), push.direction_deg, tuple(push.shares)),
            self.places,
            tuple(self.quality.clamp_needed_each),
            toolkit.strap_set.max_force,
            self.looked_at,
            tuple((a, b) for a, b in self.supports),
            None if self.program_force is None else self.program_force.to_need(),
            self.list_safety() if unit_force is not None and self.straps else (),
        )

    def list_safety(self) -> tuple[float, ...]:
        """Return how many times the given force of the straps holds each load, then the program."""
        of_program = () if self.program_force is None else (self.program_force.safety_reached,)
        return tuple(inf if one is None else one for one in (*self.quality.safety_reached_each, *of_program))


def check_strapped(parts: Sequence[StrappedSeatPart], query: Query, path: Path) -> None:
    """Raise InputError if the toolkit has no seats of a seat's type, a face does not exist, or a peg is not in
    its hole.

    Seats are counted from 1 in the message, which begins with ``path``.
    """
    if not parts:
        return
    faces = {face.number for face in query.workpiece.numbered.faces}
    plate, names = query.toolkit.plates[0], query.toolkit.types
    for number, part in enumerate(parts, 1):
        if part.type not in names:
            raise InputError(
                f"{path}: fixture {number} cannot be used: its type is not {' or '.join(names)}."
            )
        if not faces.issuperset(peg.segment for peg in part.pegs):
            raise InputError(
                f"{path}: fixture {number} touches a segment that does not name a face of the part."
            )
        for peg in part.pegs:
            x, y = plate.compute_hole_center(peg.column, peg.row)
            if hypot(peg.x - x, peg.y - y) > AGREEMENT:
                raise InputError(f"{path}: fixture {number} has a peg whose x, y are not those of its hole.")


def make_strapped_table(parts: Sequence[StrappedSeatPart]) -> FixtureTable:
    """Return the table of the seats of a file, in their order; forces of pegs are 0."""
    count = len(parts)
    quality = make_unknown_quality(np.full(count, np.nan))
    places = {one.key: number for number, one in enumerate(FIGURES)}
    for row, part in zip(quality, parts, strict=True):
        for key, value in part.quality.model_dump(exclude_none=True).items():
            if key in places:
                row[places[key]] = value
    whole = np.array(
        [[[peg.column, peg.row, peg.segment] for peg in part.pegs] for part in parts], np.int32
    ).reshape(count, 3, 3)
    return FixtureTable(
        arrangement=np.zeros(count, np.int8),
        column=whole[:, :, 0].copy(),
        row=whole[:, :, 1].copy(),
        face=whole[:, :, 2].copy(),
        theta=np.array([radians(part.pose.theta_deg) for part in parts]),
        position=np.array([(part.pose.x, part.pose.y) for part in parts]).reshape(-1, 2),
        jaw_separation=np.zeros(count),
        force=np.zeros((count, 3)),
        quality=quality,
    )
