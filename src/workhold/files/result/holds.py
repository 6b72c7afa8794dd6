"""Fixtures in a result file that hold by friction, checked and read: those of flat jaws, and of straps.

:mod:`workhold.files.result.hold_text` writes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import radians
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from workhold.errors import InputError
from workhold.files.result.bending_forms import BendingPart
from workhold.files.result.forms import FormPart, describe_first_fault
from workhold.files.result.strapped import (
    ProgramForcePart,
    StrappedSeatPart,
    check_strapped,
    make_strapped_table,
)
from workhold.files.result.strapped_text import is_strapped
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.fixture_table import FixtureTable, make_flat_jaw_table
from workhold.model.jaw_hold import JawHold, JawPatch
from workhold.model.part_bending import BendingFigures
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.model.straps import StrappedHold

__all__ = [
    "AnyHoldPart",
    "HoldPart",
    "make_jaw_holds",
    "read_bendings_of_holds",
    "read_holds",
    "make_table_of_holds",
]

LARGEST = 1e9
Whole = Annotated[int, Field(ge=0)]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
RectanglePart = Annotated[list[Number], Field(min_length=4, max_length=4)]


class PatchPart(FormPart):
    """The contact of a jaw: faces, and rectangles [x0, x1, z0, z1] in mm; a line contact has no width."""

    segments: list[Whole] = Field(description="numbers of the faces; none where corners touch")
    rectangles: list[RectanglePart] = Field(min_length=1)

    def to_patch(self) -> JawPatch:
        """Return the patch as an object of the model."""
        rows = tuple((x0, x1, z0, z1) for x0, x1, z0, z1 in self.rectangles)
        return JawPatch(rows, tuple(self.segments), not self.segments)


class HoldPosePart(FormPart):
    """Pose of the workpiece."""

    theta_deg: Number
    x: Number
    y: Number


class HoldQualityPart(FormPart):
    """Figures, in mm, mm², N and MPa."""

    full_contact: bool
    clamp_needed: Number | None = None
    clamp_needed_each: list[Number | None] = Field(
        default=[], description="for each load in its order; null where no jaw force holds it"
    )
    grip: Number | None = None
    above: Number | None = None
    contact_area: Number | None = None
    max_pressure: Number | None = None
    slip_reserve: Number | None = None
    safety_reached: Number | None = None
    tilt: Number = 0.0


class HoldPart(FormPart):
    """A fixture between two flat jaws; the best comes first."""

    type: str
    parallels: Number
    parallel_offsets: Annotated[list[Number], Field(min_length=2, max_length=2)] = Field(
        default=[0.0, 0.0],
        description="how far the parallels stand from the fixed and the moving jaw; beside them if not given",
    )
    stop: Literal["left", "right"] | None
    fixed: PatchPart
    moving: PatchPart
    pose: HoldPosePart
    jaw_separation: Number
    warnings: list[str] = Field(default=[])
    quality: HoldQualityPart
    program_force: ProgramForcePart | None = None
    bending: BendingPart | None = None

    def to_fixture(self, toolkit: Toolkit, unit_force: float | None = None) -> Fixture:
        """Return the fixture with the figures that are written.

        ``unit_force`` is the unit force of the query; it is passed on by :meth:`to_hold`.
        """
        pose = Pose(self.pose.theta_deg, self.pose.x, self.pose.y)
        written = self.quality.model_dump(exclude={"full_contact", "clamp_needed_each"}, exclude_none=True)
        return Fixture(
            self.type, (), pose, self.jaw_separation, written, hold=self.to_hold(toolkit, unit_force)
        )

    def to_hold(self, toolkit: Toolkit, unit_force: float | None = None) -> JawHold:
        """Return how the jaws of a toolkit hold the part; raise InputError for a toolkit without flat jaws.

        ``unit_force`` is passed on to :class:`JawHold`.
        """
        if toolkit.flat_jaws is None:
            raise InputError(f"it lies between flat jaws, which a {toolkit.noun} does not have.")
        quality, need = self.quality, self.program_force
        return JawHold(
            parallels=self.parallels,
            stop=self.stop,
            fixed=self.fixed.to_patch(),
            moving=self.moving.to_patch(),
            opening=self.jaw_separation,
            above=quality.above,
            full_contact=quality.full_contact,
            clamp_needed_each=tuple(quality.clamp_needed_each),
            program_need=None if need is None else need.to_need(),
            max_pressure=quality.max_pressure,
            max_force=toolkit.flat_jaws.max_force,
            unit_force=unit_force,
            warnings=tuple(self.warnings),
            parallel_offsets=(self.parallel_offsets[0], self.parallel_offsets[1]),
        )


AnyHoldPart = HoldPart | StrappedSeatPart


def read_holds(fixtures: Iterable[Any], path: Path) -> list[AnyHoldPart]:
    """Return the fixtures of a file in their checked form.

    Raises
    ------
    InputError
        Naming the first key that is missing or cannot be used.
    """
    out = list[AnyHoldPart]()
    for number, fixture in enumerate(fixtures, 1):
        form = StrappedSeatPart if is_strapped(fixture) else HoldPart
        try:
            out.append(form.model_validate(fixture))
        except ValidationError as error:
            key, reason = describe_first_fault(error)
            raise InputError(f"{path}: fixture {number} cannot be used: {key}: {reason}.") from error
    return out


def make_jaw_holds(
    parts: Sequence[AnyHoldPart], query: Query, path: Path
) -> tuple[JawHold | StrappedHold, ...]:
    """Return the hold of each fixture of a file, in its order.

    Raises InputError for fixtures of another kind of toolkit or of an unknown type, and for segments that are
    not faces.
    """
    strapped = [part for part in parts if isinstance(part, StrappedSeatPart)]
    jaws = [part for part in parts if isinstance(part, HoldPart)]
    if (strapped if query.toolkit.flat_jaws is not None else jaws) or (strapped and jaws):
        raise InputError(f"{path}: its fixtures are not those of a {query.toolkit.noun}.")
    check_strapped(strapped, query, path)
    faces = {face.number for face in query.workpiece.numbered.faces}
    names = query.toolkit.types
    for number, part in enumerate(jaws, 1):
        if part.type not in names:
            raise InputError(
                f"{path}: fixture {number} cannot be used: its type is not {' or '.join(names)}."
            )
        if not faces.issuperset((*part.fixed.segments, *part.moving.segments)):
            raise InputError(
                f"{path}: fixture {number} touches a segment that does not name a face of the part."
            )
    return tuple(part.to_hold(query.toolkit, query.unit_force) for part in parts)


def read_bendings_of_holds(parts: Sequence[AnyHoldPart], path: Path) -> dict[int, BendingFigures]:
    """Return how far fixtures of a file bend their part, by index; raise InputError for a material that cannot be."""
    found = {}
    for row, part in enumerate(parts):
        if part.bending is not None:
            try:
                found[row] = part.bending.to_figures()
            except InputError as error:
                raise InputError(f"{path}: fixture {row + 1} cannot be used: {error}") from error
    return found


def make_table_of_holds(given: Sequence[AnyHoldPart], toolkit: Toolkit) -> FixtureTable:
    """Return the table of the fixtures of a file, in its order."""
    if toolkit.strap_set is not None:
        return make_strapped_table([part for part in given if isinstance(part, StrappedSeatPart)])
    parts = [part for part in given if isinstance(part, HoldPart)]
    return make_flat_jaw_table(
        [radians(part.pose.theta_deg) for part in parts],
        [(part.pose.x, part.pose.y) for part in parts],
        [part.jaw_separation for part in parts],
        [len(part.warnings) for part in parts],
    )
