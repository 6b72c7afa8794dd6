"""A fixture: four pegs, a pose and a jaw separation, written out as holes that a machinist can count."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan, tan
from pathlib import Path
from typing import Any

from attrs import field, frozen

from workhold.delegates import delegate
from workhold.errors import InputError
from workhold.fixels.carrier import WALL, hole_name
from workhold.model.pose import Pose

__all__ = ["Fixture", "Listed", "Pair", "Peg"]


@frozen
class Peg:
    """A peg in a hole.

    Parameters
    ----------
    carrier : name of what it stands on: "left" or "right" of a vise.
    column, row : the hole, counted from 0.
    x, y : the peg's centre in the vise frame, in mm.
    face : number of the face it touches.
    force : contact force per unit of clamping force; of two clamps per unit of the sum of theirs, at the
        working ratio.
    place : what its place is called where that is no hole of its carrier: of a clamp its hole or its line.
    beside : number of a second face that it touches: of a corner that lies on a wall; None of all others.
    flat_deg : which way its flat looks, in degrees from the x axis; None of a peg that touches with its round
        side.
    """

    carrier: str
    column: int
    row: int
    x: float
    y: float
    face: int
    force: float
    place: str | None = None
    beside: int | None = None
    flat_deg: float | None = None

    @property
    def is_on_wall(self) -> bool:
        """Whether it is an end of the contact with a wall rather than a peg."""
        return self.carrier == WALL

    @property
    def touched(self) -> str:
        """The number of the face touched, or those of the two that meet at a corner.

        >>> Peg("wall", 0, 0, 12.0, 0.0, 3, 0.4, beside=4).touched
        '3/4'
        """
        return str(self.face) if self.beside is None else f"{self.face}/{self.beside}"

    @property
    def touching(self) -> str:
        """What it touches, in words."""
        return (
            f"face {self.face}"
            if self.beside is None
            else f"the corner of faces {self.face} and {self.beside}"
        )

    @property
    def hole(self) -> str:
        """The hole's name: the carrier's letter, column letter, row number from 1, such as ``L-B3``."""
        return self.place or hole_name(self.carrier, self.column, self.row)


@frozen
class Pair:
    """What is particular to a fixture with two clamps.

    Parameters
    ----------
    travels : how far each clamp has travelled from its hole, in mm.
    ratio : the open interval of the second clamp's force over the first's in which all locators are pressed;
        the upper end may be infinite.
    reactions : of each peg its force per unit of the force of the first clamp, and of the second.
    count : how many pairs of clamps there are at this seat, of which this one is listed.
    """

    travels: tuple[float, float]
    ratio: tuple[float, float]
    reactions: tuple[tuple[float, float], ...]
    count: int

    @property
    def working_ratio(self) -> float:
        """The second clamp's force over the first's, in the middle of the interval as an angle."""
        return tan((atan(self.ratio[0]) + atan(self.ratio[1])) / 2)


@frozen
class Listed:
    """Where a fixture is listed. A copy made by pickle keeps that fixture alone of the result.

    Parameters
    ----------
    result : the :class:`workhold.Result`.
    row : of the fixture in the result's table.
    rank, count : of the fixture, from 1, and how many fixtures are listed.
    in_same_holes : how many of these use the same holes; None until it is counted.
    """

    result: Any
    row: int
    rank: int
    count: int
    in_same_holes: int | None = None

    @property
    def others(self) -> int:
        """How many other fixtures of the result use the same holes."""
        return (
            int(self.result.table.same_holes(self.row)) if self.in_same_holes is None else self.in_same_holes
        )

    def __reduce__(self) -> tuple[Any, ...]:
        alone = self.result.part(slice(self.row, self.row + 1))
        return Listed, (alone, 0, self.rank, self.count, self.others)


@frozen(repr=False)
class Fixture:
    """One way to hold the workpiece.

    Parameters
    ----------
    type : name of its arrangement: of a vise "I" for two pegs on each jaw, "II" for three on the left and one
        on the right.
    pegs : in the order of the arrangement, those of a vise's left jaw first.
    pose : where the workpiece lies.
    jaw_separation : x distance in mm from the left jaw's last column to the right jaw's first; of another
        toolkit the travel of what moves.
    quality : figures of merit by name.
    direction : in which the clamp moves when it clamps, such as "-x", or two clamps do, "-x -y"; None of a
        vise.
    pair : what is particular to two clamps; None of other fixtures.
    listed : where it is listed, so that it can be drawn; None of one that was put together otherwise. It
        makes no difference between fixtures.
    seating : what else its pegs can do with the part, a ``model.seating.Seating``; None where that was not
        asked.
    passing, asking : of a file that is verified, what it says of where the program's tools pass, and of the
        forces that they ask for; None of all others.
    """

    type: str
    pegs: tuple[Peg, ...]
    pose: Pose
    jaw_separation: float
    quality: Mapping[str, float] = field(eq=lambda quality: tuple(sorted(quality.items())))
    direction: str | None = None
    pair: Pair | None = None
    listed: Listed | None = field(default=None, eq=False)
    seating: Any = field(default=None, eq=False)
    passing: Any = field(default=None, eq=False, repr=False)
    asking: Any = field(default=None, eq=False, repr=False)

    def __repr__(self) -> str:
        which = "Fixture" if self.listed is None else f"Fixture {self.listed.rank} of {self.listed.count}"
        kind = self.type if self.direction is None else f"{self.type} {self.direction}"
        caught = ""
        if self.seating is not None:
            opening = self.seating.capture_opening
            caught = ", never lost" if opening is None else f", caught below {opening:.3f} mm"
        return (
            f"<{which}, {kind}: {' '.join(peg.hole for peg in self.pegs)} at {self.pose.theta_deg:.3f} "
            f"degrees{caught}>"
        )

    def _repr_html_(self) -> str | None:
        shown: str | None = delegate("fixture_html")(self)
        return shown

    @property
    def travels(self) -> tuple[float, ...]:
        """How far each thing that moves has travelled, in mm: the jaw, or the clamps in their order."""
        return (self.jaw_separation,) if self.pair is None else self.pair.travels

    @property
    def placed(self) -> tuple[Peg, ...]:
        """The pegs and clamps that stand in places of their own; the ends of a contact with a wall do not."""
        return tuple(peg for peg in self.pegs if not peg.is_on_wall)

    @property
    def figures(self) -> dict[str, float]:
        """The figures of quality and, where it is known, of seating, whose warnings count as well."""
        if self.seating is None:
            return dict(self.quality)
        figures = {**self.quality, **self.seating.figures}
        return figures | {"warnings": figures.get("warnings", 0.0) + self.seating.warning_count}

    @property
    def listing(self) -> Listed:
        """Where it is listed.

        Raises
        ------
        InputError
            For a fixture that is not one of a result.
        """
        if self.listed is None:
            raise InputError(
                "this fixture is not of a result, which has the part and the toolkit: take one of a result."
            )
        return self.listed

    def refuse_others(self, workpiece: Any, toolkit: Any) -> None:
        """Refuses a part and a toolkit that it is not a fixture of.

        What is listed belongs to the part and the toolkit of its result. One that was put together otherwise,
        or changed since, has to stand on carriers and touch faces that there are.

        Parameters
        ----------
        workpiece, toolkit : a :class:`workhold.Workpiece` and what it is held in.

        Raises
        ------
        InputError
            Saying which of them is another one.
        """
        if self.listed is not None:
            result = self.listed.result
            is_part, is_toolkit = result.workpiece.is_alike(workpiece), result.toolkit == toolkit
            if (is_part and is_toolkit) or self == result[self.listed.row]:
                refuse_unless(is_part, "part")
                refuse_unless(is_toolkit, "toolkit")
                return
        names = {carrier.name for carrier in toolkit.carriers}
        refuse_unless(all(peg.carrier in names for peg in self.pegs), "toolkit")
        faces = {face.number for face in workpiece.numbered.faces}
        touched = {face for peg in self.pegs for face in (peg.face, peg.beside) if face is not None}
        refuse_unless(touched <= faces, "part")

    def draw(
        self,
        path: str | Path | None = None,
        *,
        title: str | None = None,
        unit: str = "mm",
        overwrite: bool = False,
    ) -> str:
        """The picture to set it up from: SVG text, which a notebook shows as a picture.

        Parameters
        ----------
        path : also write it into this file, whose name ends in .svg or .png.
        title : what to call the fixture; its rank if None.
        unit : of the lengths written: "mm", "cm", "m" or "inch".
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, and when the file cannot be written or replaced.

        Examples
        --------
        >>> import workhold
        >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
        >>> result = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))
        >>> "Fixture 1 of" in result[0].draw()
        True
        """
        asked = {"title": title, "unit": unit, "overwrite": overwrite}
        picture: str = delegate("fixture_picture")(self, path, **asked)
        return picture

    def save_sheet(
        self,
        path: str | Path,
        *,
        unit: str = "mm",
        clearance: float | None = None,
        result_file: str | Path | None = None,
        supports: Any = None,
        best: int = 1,
        part: str | Path | None = None,
        overwrite: bool = False,
        **asked: Any,
    ) -> None:
        """Writes the setup sheet (.pdf, .svg, .png), the set-up for CAM (.dxf, .step) or the pins (.csv).

        Parameters
        ----------
        unit : of the lengths on paper, "mm" or "inch".
        clearance : how far the cutter is to keep off the pegs of a .dxf, in mm; 1 if None.
        result_file : the file that the result was saved in; its hash then stands on the sheet.
        supports : of what :meth:`supports` returns, also the pads under the part and the clamp on top, on a
            sheet and in a .step.
        best : which of its sets of three, from 1.
        part : the STEP file of the part, for its own shape in a .step.
        overwrite : whether a file that workhold has not written may be replaced.
        asked : what else stands on the sheet. Words are ``paper`` ("a4" or "letter"), ``day``, ``part_name``
            and ``dowel``. Forces are ``jaw_force`` in N, ``jaw`` ("screw", "constant" or a stiffness),
            ``friction``, and ``loads`` instead of the result's. ``at`` is the hole of the lowest
            column and row, such as "D4". Places are ``zero`` ("corner", "centre",
            "hole 2" or x and y of the drawing) and ``machine_position`` (x, y) of hole A1. Lengths in mm are
            ``thickness``, ``peg_length`` and ``peg_height``.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, supports and files of another, values that cannot be,
            and when the file cannot be written or replaced.
        """
        asked |= {"supports": supports, "best": best, "part": part, "result_file": result_file}
        asked["overwrite"] = overwrite
        delegate("save_sheet")(self, path, unit=unit, clearance=clearance, **asked)

    def save_glb(
        self,
        path: str | Path,
        *,
        thickness: float | None = None,
        supports: Any = None,
        best: int = 1,
        part: str | Path | None = None,
        overwrite: bool = False,
    ) -> None:
        """Writes the fixture in three dimensions as a GLB file, which browsers and phones show.

        Parameters
        ----------
        thickness : of the part in mm; that of its solid, or 10, if None.
        supports : also the pads under the part and the clamp on top, of what :meth:`supports` returns.
        best : which of its sets of three, from 1.
        part : the STEP file that the part was read from, for its own shape; a prism of its outline if None.
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, supports of another or a set that is not there, and a
            file of another part. Also for a name of another kind of file, and when the file cannot be written
            or replaced.
        """
        asked = {"thickness": thickness, "supports": supports, "best": best, "part": part}
        asked["overwrite"] = overwrite
        delegate("save_glb")(self, path, **asked)

    def to_build123d(
        self, around: Any = None, *, thickness: float | None = None, supports: Any = None, best: int = 1
    ) -> Any:
        """Makes a compound of build123d: part, pegs, clamps and plates, each with its name and colour.

        Parameters
        ----------
        around : the part's own solid. The bodies then stand about it where it lies in its model, and it is
            the first of them. With None they stand in the frame of the toolkit, and the part is a prism.
        thickness : of the part in mm; that of its solid, or 10, if None.
        supports : also the pads under the part and the clamp on top, of what :meth:`supports` returns.
        best : which of its sets of three, from 1.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, a set that is not there, and a solid of another part.
            Also when build123d or the extra ``step`` is not installed.
        """
        return delegate("to_build123d")(self, around, thickness=thickness, supports=supports, best=best)

    def to_cadquery(
        self, around: Any = None, *, thickness: float | None = None, supports: Any = None, best: int = 1
    ) -> Any:
        """Makes an assembly of CadQuery with the bodies of :meth:`to_build123d`, which names the parameters.

        Raises
        ------
        InputError
            As :meth:`to_build123d`, of CadQuery.
        """
        return delegate("to_cadquery")(self, around, thickness=thickness, supports=supports, best=best)

    def supports(
        self,
        thickness: float | None = None,
        *,
        best: int | None = 3,
        loads: Any = None,
        jaw_force: float | None = None,
        **asked: Any,
    ) -> Any:
        """Where three supports hold the part up, and a clamp presses it down: the best sets of three.

        Parameters
        ----------
        thickness : of the part in mm; that of its solid if None.
        best : how many sets; None for all.
        loads : planar ones, which act at the top of the part, or ``SpatialLoad``; those of the query if None.
        jaw_force : in N; by default the one that keeps all pegs in contact.
        asked : more of a ``SupportRequest``, such as ``pad_radius``, ``tip_radius``, ``band`` and
            ``top_zones``.

        Returns
        -------
        A ``Supports``, whose ``triples`` are the sets.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, a part of which nobody says how thick it is, and values
            that cannot be.

        Examples
        --------
        >>> import workhold
        >>> plate = workhold.Workpiece.from_loops("plate", [[[0, 0, 0], [80, 0, 0], [80, 60, 0], [0, 60, 0]]])
        >>> result = workhold.design(plate, workhold.Vise(pitch=10, columns=6, peg_radius=3), best=1)
        >>> found = result[0].supports(12, best=2, pad_radius=3)
        >>> len(found.triples), found.triples[0].arm > 10
        (2, True)
        """
        return delegate("fixture_supports")(
            self, thickness, best=best, loads=loads, jaw_force=jaw_force, **asked
        )


def refuse_unless(belongs: bool, what: str) -> None:
    """Refuses what a fixture is not of."""
    if not belongs:
        raise InputError(f"this fixture is of another {what}: give the one that it was designed for.")
