"""A fixture: four pegs, a pose and a jaw separation, written out as holes that a machinist can count."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date
from math import atan, tan
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.fixels.carrier import JAWS, WALL, make_hole_name
from workhold.model.jaw_hold import JawHold
from workhold.model.part_bending import BendingFigures
from workhold.model.pose import Pose
from workhold.model.straps import StrapHardware, StrappedHold

if TYPE_CHECKING:
    import build123d
    import cadquery

    from workhold.bending.figures import Bending
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.elastic_material import ElasticMaterial
    from workhold.model.program import Program
    from workhold.model.requirements import Load, Zone
    from workhold.model.result import Result
    from workhold.model.support_request import Faces, SpatialLoad
    from workhold.model.support_triples import Supports
    from workhold.model.workpiece import Workpiece
    from workhold.presenting.papers import Picture
    from workhold.statics.loads import LoadCase

__all__ = ["Fixture", "ListPlace", "ClampPair", "Peg"]


@frozen
class Peg:
    """A peg in a hole.

    Parameters
    ----------
    carrier : name of the carrier of the peg: "left" or "right" for a vise.
    column, row : the hole, counted from 0.
    x, y : the peg's centre in mm, in the toolkit's frame (see :class:`Pose`), with the jaw or the clamp
        closed.
    face : number of the face it touches.
    force : contact force divided by the clamping force; with two clamps, by the sum of both at the working
        ratio. Multiply by the jaw force to get N.
    place : name of a clamp's hole or line, used instead of a hole of the carrier; None for other pegs.
    beside : number of the second face touched, if a corner lies on a wall; None otherwise.
    flat_deg : direction that the peg's flat faces, in degrees counter-clockwise from the toolkit's x axis;
        None for a peg that touches with its round side.
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
        """Whether this entry is one end of the contact with a wall, where there is no peg."""
        return self.carrier == WALL

    @property
    def touched(self) -> str:
        """Number of the face touched, as text, or the two numbers of the faces that meet at a corner.

        >>> Peg("wall", 0, 0, 12.0, 0.0, 3, 0.4, beside=4).touched
        '3/4'
        """
        return str(self.face) if self.beside is None else f"{self.face}/{self.beside}"

    @property
    def touching(self) -> str:
        """Words for the touched face or corner, such as "face 3"."""
        return (
            f"face {self.face}"
            if self.beside is None
            else f"the corner of faces {self.face} and {self.beside}"
        )

    @property
    def hole(self) -> str:
        """Name of the hole, such as ``L-B3`` (carrier's letter, column letter, row from 1),
        or ``place`` where that is given.
        """
        return self.place or make_hole_name(self.carrier, self.column, self.row)


@frozen
class ClampPair:
    """The data of the two clamps of a fixture.

    Parameters
    ----------
    travels : travel of each clamp from its hole, in mm.
    ratio : the open interval of (second clamp's force) / (first clamp's force) in which all locators are
        pressed; the upper end may be infinite.
    reactions : for each peg, its force per unit of the first clamp's force and per unit of the second's.
    count : number of pairs of clamps that hold the part with the same locators and pose and the same
        directions; only this one is listed.
    """

    travels: tuple[float, float]
    ratio: tuple[float, float]
    reactions: tuple[tuple[float, float], ...]
    count: int

    @property
    def working_ratio(self) -> float:
        """Second clamp's force over the first's at the middle of ``ratio``,
        taken between the angles atan(ratio).
        """
        return tan((atan(self.ratio[0]) + atan(self.ratio[1])) / 2)


@frozen
class ListPlace:
    """Place of a fixture in the list of its result. A pickled copy keeps only this fixture of the result.

    Parameters
    ----------
    result : the :class:`workhold.Result`.
    row : of the fixture in the result's table.
    rank, count : rank of the fixture, from 1, and number of fixtures listed.
    in_same_holes : number of other fixtures in the result that use the same holes; None until it is counted.
    """

    result: Result
    row: int
    rank: int
    count: int
    in_same_holes: int | None = None

    @property
    def others(self) -> int:
        """Number of other fixtures in the result that use the same holes."""
        return (
            int(self.result.table.count_in_same_holes(self.row))
            if self.in_same_holes is None
            else self.in_same_holes
        )

    def __reduce__(self) -> tuple[Any, ...]:
        alone = self.result.slice_rows(slice(self.row, self.row + 1))
        return ListPlace, (alone, 0, self.rank, self.count, self.others)


# What an editor need not offer: other rooms use it.
INTERNAL = frozenset({"asking", "figures", "listed", "listing", "passing", "placed", "refuse_others"})


@frozen(repr=False)
class Fixture:
    """One way to hold the workpiece.

    Parameters
    ----------
    type : name of its arrangement; for a vise "I" with two pegs on each jaw, "II" with three on the left and
        one on the right.
    pegs : in the order of the arrangement, those of a vise's left jaw first.
    pose : pose of the workpiece in the toolkit's frame.
    travel : travel in mm of the moving carrier (a jaw, a clamp from its hole, a sliding lattice); for two
        clamps that of the first, see :attr:`travels`.
    quality : figures of merit by name.
    direction : clamping direction, such as "-x", or "-x -y" for two clamps; None for a vise.
    pair : data of the two clamps; None for fixtures without two clamps.
    listed : place in the result that lists the fixture, which is needed to draw it; None for a fixture of no
        result. It is ignored when fixtures are compared.
    seating : the other ways in which its pegs can hold the part, a ``model.seating.Seating``; None where
        seating was not asked for.
    bent : how far it bends its part, where the result or its file says so; None otherwise. :meth:`bending`
        computes it.
    hold : how friction holds it, between flat jaws without pegs, or under straps against locators; None of
        other fixtures.
    passing, asking : of a file that is verified: what the file says about where the program's tools pass, and
        about the forces that these tools need; None of other fixtures.
    """

    type: str
    pegs: tuple[Peg, ...]
    pose: Pose
    travel: float
    quality: Mapping[str, float] = field(eq=lambda quality: tuple(sorted(quality.items())))
    direction: str | None = None
    pair: ClampPair | None = None
    listed: ListPlace | None = field(default=None, eq=False)
    seating: Any = field(default=None, eq=False)
    bent: BendingFigures | None = field(default=None, eq=False)
    hold: JawHold | StrappedHold | None = None
    passing: Any = field(default=None, eq=False, repr=False)
    asking: Any = field(default=None, eq=False, repr=False)

    def __dir__(self) -> list[str]:
        return sorted(set(object.__dir__(self)) - INTERNAL)

    def __repr__(self) -> str:
        which = "Fixture" if self.listed is None else f"Fixture {self.listed.rank} of {self.listed.count}"
        if isinstance(self.hold, JawHold):
            stop = f", stop {self.hold.stop}" if self.hold.stop else ""
            on = f"parallels of {self.hold.parallels:g} mm{stop}"
            return f"<{which}, {self.type}: on {on} at {self.pose.theta_deg:.3f} degrees>"
        kind = self.type if self.direction is None else f"{self.type} {self.direction}"
        caught = ""
        if self.seating is not None:
            opening = self.seating.capture_opening
            caught = ", never lost" if opening is None else f", caught below {opening:.3f} mm"
        return (
            f"<{which}, {kind}: {' '.join(peg.hole for peg in self.pegs)} at {self.pose.theta_deg:.3f} "
            f"degrees{caught}>"
        )

    def _repr_svg_(self) -> str | None:
        return None if self.listed is None else self.draw()

    def _repr_html_(self) -> str | None:
        from workhold.presenting.notebook import render_fixture_html

        return render_fixture_html(self)

    @property
    def travels(self) -> tuple[float, ...]:
        """Travel in mm of each thing that moves: (travel,), or the travels of both clamps of a pair in their
        order.
        """
        return (self.travel,) if self.pair is None else self.pair.travels

    @property
    def jaw_separation(self) -> float | None:
        """For a vise, the distance in x, in mm, from the left jaw's last column to the right jaw's first; for
        flat jaws, the distance between them; else None.
        """
        if isinstance(self.hold, JawHold):
            return self.hold.opening
        return self.travel if {peg.carrier for peg in self.pegs} == set(JAWS) else None

    @property
    def rank(self) -> int:
        """Rank of the fixture in its result, from 1.

        Raises
        ------
        InputError
            For a fixture that is not one of a result.
        """
        return self.listing.rank

    @property
    def contact_points(self) -> NDArray[np.float64]:
        """Points (P, 2) in mm where pegs touch the part, in the toolkit's frame, in the order of the pegs.

        ``pose.inverse.apply(contact_points)`` has them in the part's frame. The forces ``peg.force`` act
        there, along minus the :attr:`normals`; without friction they balance.

        Raises
        ------
        InputError
            For a fixture that is not one of a result.

        Examples
        --------
        >>> import workhold
        >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
        >>> first = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))[0]
        >>> away = first.contact_points - [(peg.x, peg.y) for peg in first.pegs]
        >>> bool(np.allclose(away, -2 * first.normals))
        True
        """
        from workhold.statics.loads import find_touched_points

        result = self.listing.result
        points, _ = find_touched_points(self, result.workpiece, result.toolkit)
        return self.pose.apply(points)

    @property
    def normals(self) -> NDArray[np.float64]:
        """Unit normals (P, 2) of the part, out of the material,
        where pegs touch it; in the toolkit's frame, in pegs' order.

        Raises
        ------
        InputError
            For a fixture that is not one of a result.
        """
        from workhold.statics.loads import find_touched_points

        result = self.listing.result
        return self.pose.turn(find_touched_points(self, result.workpiece, result.toolkit)[1])

    def load_cases(
        self,
        loads: Load | Sequence[Load] | None = None,
        *,
        jaw_force: float | None = None,
        friction: float | None = None,
        jaw: str | float = "screw",
    ) -> tuple[LoadCase, ...]:
        """Return one load case for each load: the forces on the pegs when that load acts by itself.

        Parameters
        ----------
        loads : loads on the part; those of the query if None.
        jaw_force : force of the jaw or the clamps in N; if None that of the query, else the least force at
            which no peg lets go.
        friction : Coulomb's coefficient between pegs and part, to compute its possible help; None for none.
        jaw : kind of the jaw: "screw" (locked), "constant" (a constant force), or the ratio of the jaw's
            stiffness to that of one contact.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, and impossible values.

        Examples
        --------
        >>> import workhold
        >>> wedge = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
        >>> first = workhold.design(wedge, workhold.Vise(pitch=15, columns=1, peg_radius=2))[0]
        >>> (case,) = first.load_cases([workhold.Load(points=(15, 10), force=50)])
        >>> case.jaw_force > 0, case.keeps_contact
        (True, True)
        """
        from workhold.statics.loads import compute_load_cases

        query = self.listing.result.query
        given = query.loads if loads is None else loads
        force = query.jaw_force if jaw_force is None else jaw_force
        return compute_load_cases(self, query.workpiece, query.toolkit, given, force, friction, jaw)

    @property
    def placed(self) -> tuple[Peg, ...]:
        """Pegs and clamps that are placed by themselves; the ends of a wall's contact are left out."""
        return tuple(peg for peg in self.pegs if not peg.is_on_wall)

    @property
    def figures(self) -> dict[str, float]:
        """Figures of quality by key and, if the seating is known, its figures; "warnings" is the sum of both."""
        if self.seating is None:
            return dict(self.quality)
        figures = {**self.quality, **self.seating.figures}
        return figures | {"warnings": figures.get("warnings", 0.0) + self.seating.warning_count}

    @property
    def listing(self) -> ListPlace:
        """Place of the fixture in its result (:attr:`listed`), never None.

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

    def refuse_others(self, workpiece: Workpiece, toolkit: Toolkit) -> None:
        """Raise InputError for a part or a toolkit that this fixture does not belong to.

        A listed fixture belongs to the part and the toolkit of its result. Any other fixture, and a listed
        one that was changed, must use carriers of the toolkit and touch faces of the part.

        Parameters
        ----------
        workpiece, toolkit : a :class:`workhold.Workpiece` and its toolkit.

        Raises
        ------
        InputError
            If the part or the toolkit is another one; the message names it.
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
    ) -> Picture:
        """Return the drawing to set the fixture up from as SVG text,
        which a notebook shows as a picture; write it if asked.

        Parameters
        ----------
        path : also write it into this file, whose name ends in .svg or .png.
        title : title of the drawing; the fixture's rank if None.
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
        from workhold.presenting.papers import draw_and_save_fixture

        return draw_and_save_fixture(self, path, title=title, unit=unit, overwrite=overwrite)

    def save_sheet(
        self,
        path: str | Path,
        *,
        unit: str = "mm",
        paper: Literal["a4", "letter"] | None = None,
        day: date | None = None,
        part_name: str | None = None,
        dowel: str | None = None,
        material: str | None = None,
        bend: float | None = None,
        jaw_force: float | None = None,
        jaw: str | float = "screw",
        friction: float | None = None,
        loads: Sequence[Load] | None = None,
        at: str | None = None,
        zero: str | Sequence[float] | None = None,
        machine_position: tuple[float, float] | None = None,
        thickness: float | None = None,
        peg_length: float | None = None,
        peg_height: float | None = None,
        plate_thickness: float | None = None,
        seating: bool | None = None,
        supports: Supports | None = None,
        best: int = 1,
        support_height: float | None = None,
        clearance: float | None = None,
        part: str | Path | None = None,
        result_file: str | Path | None = None,
        overwrite: bool = False,
    ) -> None:
        """Write the setup sheet (.pdf, .svg, .png),
        the set-up for CAM (.dxf, .step) or the list of pins (.csv).

        Parameters
        ----------
        path : path of the file; its ending selects the kind of file.
        unit : unit of the lengths on paper, "mm" or "inch".
        paper : "a4" or "letter"; None is letter for lengths in inches, else A4.
        day : the date on the sheet; today if None.
        part_name : written instead of the part's own name.
        dowel : words on the pegs and their fit; if None, words on the dowels of the tolerance.
        material : material of the part, such as "aluminium-6061": the sheet then shows how far clamping bends
            the part, see :meth:`bending`.
        bend : length in mm; the sheet warns where the part bends or gives by more.
        jaw_force : in N, per clamp; that of the query if None.
        jaw : what keeps the jaw in place: "screw" (locked), "constant" (a constant force), or the jaw's
            stiffness over that of one contact.
        friction : Coulomb's coefficient, for what friction could add; None for none.
        loads : loads used instead of the result's; None for the result's.
        at : name of the hole at which the lowest column and the lowest row of the set-up meet, such as "D4";
            None for the middle of the plate.
        zero : part zero: "corner", "centre", "hole 2", or x and y of the drawing in ``unit``; its origin if
            None.
        machine_position : (x, y) of hole A1 in the machine's coordinates, in mm.
        thickness, peg_length, peg_height, plate_thickness : thickness of the part, length of the pegs, how
            far they stand out, and thickness of the plates, in mm; None leaves a line to write the value on.
        seating : whether the sheet shows where else the pegs can hold the part; None shows it where it is
            known.
        supports : a result of :meth:`supports`; a sheet or a .step then also shows the pads under the part
            and the clamp on top.
        best : number, from 1, of the set of three among ``supports``.
        support_height : height of the supports in mm; that of the toolkit's own supports if None.
        clearance : distance in mm that the cutter keeps from the pegs of a .dxf; 1 if None.
        part : STEP file of the part, for its own shape in a .step and for how far it bends.
        result_file : the file that the result was saved in; its hash then stands on the sheet.
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, supports and files of another, impossible values, and
            when the file cannot be written or replaced.
        """
        from workhold.presenting.papers import save_sheet

        save_sheet(
            self,
            path,
            unit=unit,
            clearance=clearance,
            result_file=result_file,
            supports=supports,
            best=best,
            part=part,
            overwrite=overwrite,
            paper=paper,
            day=day,
            part_name=part_name,
            dowel=dowel,
            material=material,
            bend=bend,
            jaw_force=jaw_force,
            jaw=jaw,
            friction=friction,
            loads=loads,
            at=at,
            zero=zero,
            machine_position=machine_position,
            thickness=thickness,
            peg_length=peg_length,
            peg_height=peg_height,
            plate_thickness=plate_thickness,
            seating=seating,
            support_height=support_height,
        )

    def save_glb(
        self,
        path: str | Path,
        *,
        thickness: float | None = None,
        supports: Supports | None = None,
        best: int = 1,
        part: str | Path | None = None,
        overwrite: bool = False,
    ) -> None:
        """Write the fixture in three dimensions as a GLB file, which browsers and phones show.

        Parameters
        ----------
        path : of the file, whose name ends in .glb.
        thickness : thickness of the part in mm; if None that of its solid, else 10.
        supports : a result of :meth:`supports`; the model then also shows the pads under the part and the
            clamp on top.
        best : number, from 1, of the set of three among ``supports``.
        part : the STEP file that the part was read from, for its own shape; None to show a prism of its
            outline.
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, supports of another or a set that is not there, and a
            file of another part. Also for a name of another kind of file, and when the file cannot be written
            or replaced.
        """
        from workhold.presenting.assembly import save_glb

        save_glb(
            self, path, thickness=thickness, supports=supports, best=best, part=part, overwrite=overwrite
        )

    def to_build123d(
        self,
        around: Any = None,
        *,
        thickness: float | None = None,
        supports: Supports | None = None,
        best: int = 1,
    ) -> build123d.Compound:
        """Return a build123d compound of part, pegs, clamps and plates, each with its name and colour.

        Parameters
        ----------
        around : the part's own solid, which is then the first body; the others are placed around it in its
            model. With None the bodies are in the frame of the toolkit, and the part is a prism.
        thickness : thickness of the part in mm; if None that of its solid, else 10.
        supports : a result of :meth:`supports`; its pads under the part and clamp on top are added.
        best : number, from 1, of the set of three among ``supports``.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, a set that is not there, and a solid of another part.
            Also when build123d or the extra ``step`` is not installed.
        """
        from workhold.presenting.assembly import to_build123d

        return to_build123d(self, around, thickness=thickness, supports=supports, best=best)

    def to_cadquery(
        self,
        around: Any = None,
        *,
        thickness: float | None = None,
        supports: Supports | None = None,
        best: int = 1,
    ) -> cadquery.Assembly:
        """Return a CadQuery assembly of the bodies that :meth:`to_build123d` makes;
        see there for the parameters.

        Raises
        ------
        InputError
            As :meth:`to_build123d`, with CadQuery in place of build123d.
        """
        from workhold.presenting.assembly import to_cadquery

        return to_cadquery(self, around, thickness=thickness, supports=supports, best=best)

    def supports(
        self,
        thickness: float | None = None,
        *,
        best: int | None = 3,
        loads: Sequence[Load | SpatialLoad] | None = None,
        jaw_force: float | None = None,
        pad_radius: float | None = None,
        tip_radius: float | None = None,
        pad_margin: float | None = None,
        tip_margin: float | None = None,
        head_radius: float | None = None,
        inside: float | None = None,
        band: tuple[float, float] | None = None,
        bottom: Faces | None = None,
        top: Faces | None = None,
        bottom_zones: Sequence[Zone] | None = None,
        top_zones: Sequence[Zone] | None = None,
        reach: Sequence[tuple[float, float, float, float]] | None = None,
        point: tuple[float, float] | None = None,
    ) -> Supports:
        """Return the best sets of three supports under the part,
        each with the place of a clamp that presses on top.

        Parameters
        ----------
        thickness : thickness of the part in mm; that of its solid if None.
        best : number of sets to return; None for all.
        loads : planar loads, which act at the top of the part, or ``SpatialLoad``; those of the query if
            None.
        jaw_force : in N; by default the one that keeps all pegs in contact.
        pad_radius, tip_radius : radii of the supports' pads and of the clamp's tip, in mm. For these and all
            parameters that follow, None stands for the toolkit's own value, or else the usual one.
        pad_margin, tip_margin : smallest distances in mm from a pad and from the tip to the border of its
            face.
        head_radius : radius in mm around the clamp within which nothing may rise above the clamped face.
        inside : smallest distance in mm from the clamp to each side of the supports' triangle.
        band : least and greatest height in mm at which pegs may press.
        bottom, top : faces that supports and the clamp may touch, as loops of (x, y, bulge) in mm, the outer
            one first; "outline" is the whole outline, and None what a solid says.
        bottom_zones, top_zones : zones where no pad, and where no tip, may stand, as in ``Restrictions``.
        reach : rings (x, y, least, most) in mm in which the clamp can stand.
        point : (x, y) in mm in the part's coordinates where the clamp stands.

        Returns
        -------
        A ``Supports``, whose ``triples`` are the sets.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, a part of unknown thickness, and impossible values.

        Examples
        --------
        >>> import workhold
        >>> plate = workhold.Workpiece.from_loops("plate", [[[0, 0, 0], [80, 0, 0], [80, 60, 0], [0, 60, 0]]])
        >>> result = workhold.design(plate, workhold.Vise(pitch=10, columns=6, peg_radius=3), best=1)
        >>> found = result[0].supports(12, best=2, pad_radius=3)
        >>> len(found.triples), found.triples[0].arm > 10
        (2, True)
        """
        from workhold.supports.asking import find_fixture_supports

        return find_fixture_supports(
            self,
            thickness,
            best=best,
            loads=loads,
            jaw_force=jaw_force,
            pad_radius=pad_radius,
            tip_radius=tip_radius,
            pad_margin=pad_margin,
            tip_margin=tip_margin,
            head_radius=head_radius,
            inside=inside,
            band=band,
            bottom=bottom,
            top=top,
            bottom_zones=bottom_zones,
            top_zones=top_zones,
            reach=reach,
            point=point,
        )

    def straps(
        self,
        thickness: float | None = None,
        *,
        count: int = 2,
        tip_radius: float = 6.0,
        reach: tuple[float, float] = (20.0, 60.0),
        max_force: float | None = None,
        loads: Sequence[Load | SpatialLoad] | None = None,
        friction: Mapping[str, float] | None = None,
        safety: float | None = None,
        weight: float = 0.0,
        top_zones: Sequence[Zone] = (),
        jaw_force: float | None = None,
        strap_height: float | None = None,
        over: str = "plate",
        pad_radius: float | None = None,
        pad_margin: float | None = None,
        support_height: float | None = None,
        bottom_zones: Sequence[Zone] = (),
        program: Program | None = None,
    ) -> StrappedHold:
        """Return the places of straps that hold the part down
        against the three locators with the least force.

        No side clamp presses: the part lies on the plate, and a hand pushes it against the locators until the
        straps are tight. The straps are the best of a finite set: points on rings about each hole, every 30
        degrees at three radii.

        Parameters
        ----------
        thickness : thickness of the part in mm; that of its solid if None.
        count : number of straps, 1 to 4.
        tip_radius : radius of the straps' round tips, in mm.
        reach : least and greatest distance in mm of a tip from the middle of its bolt's hole.
        max_force : rated force of a strap in N; None where it is not known.
        loads : planar loads, which act at the top of the part, or ``SpatialLoad``; those of the query if
            None.
        friction : coefficients by name, of "tip" and "plate"; usual ones for those not given.
        safety : factor on the loads; 2 if None.
        weight : weight of the part in N, which the safety factor does not multiply.
        top_zones : zones where no tip may stand, as in ``Restrictions``.
        jaw_force : force in N with which each strap presses at its tip, for the number of times that it holds
            the loads; that of the query if None.
        strap_height : how high a strap stands above the face that it presses on, in mm; six radii of its tip if
            None.
        over : "plate" where the part lies on the plate, "supports" where it lies on three supports, each tip
            over one of them.
        pad_radius, pad_margin, support_height : of the supports, in mm; those of the toolkit, or else usual ones,
            if None.
        bottom_zones : zones where no pad may stand.
        program : program whose tools must pass the straps and supports, and press on the part where their forces
            are known; that of the query if None.

        Raises
        ------
        InputError
            For a fixture that has other than three locators on one plate, a part of unknown thickness, and
            impossible values.

        Examples
        --------
        >>> import workhold
        >>> block = workhold.Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
        >>> plate = workhold.Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
        >>> first = workhold.design(block, plate, best=1)[0]
        >>> load = workhold.Load(points=(50, 30), force=300, directions=0)
        >>> held = first.straps(25, count=2, loads=[load])
        >>> len(held.straps), round(held.clamp_needed, -1)
        (2, 1500.0)
        """
        from workhold.supports.straps import PadSizes, ask_for_straps

        if over not in ("plate", "supports"):
            raise InputError(f'straps cannot press over {over!r}: choose "plate" or "supports".')
        return ask_for_straps(
            self,
            thickness,
            StrapHardware(count, tip_radius, reach, max_force, strap_height),
            loads=loads,
            friction=friction,
            safety=safety,
            weight=weight,
            zones=top_zones,
            jaw_force=jaw_force,
            pads=PadSizes(pad_radius, pad_margin, support_height) if over == "supports" else None,
            zones_below=bottom_zones,
            program=program,
        )

    def bending(
        self,
        material: str | ElasticMaterial = "aluminium-6061",
        *,
        thickness: float | None = None,
        jaw_force: float | None = None,
        jaw: str | float = "screw",
        faces: Sequence[int | str] = (),
        part: str | Path | None = None,
        supports: Supports | None = None,
        best: int = 1,
        clamp_force: float | None = None,
        straps: StrappedHold | None = None,
    ) -> Bending:
        """Return how far clamping bends the part (this springs back after the cut), and how far the part
        moves at the cutter.

        Loads and program are those of the query. Needs the extra ``bending``, and takes some seconds.

        Parameters
        ----------
        material : its name, such as "mild-steel", or Young's modulus in MPa and Poisson's ratio as
            "69000,0.33", and its yield strength in MPa where that is known, as in "69000,0.33,276".
        thickness : thickness of the part in mm; that of its solid or of the query if None.
        jaw_force : in N; if None that of the query, else the one that its loads need, else 1000 N.
        jaw : kind of the jaw, see :meth:`load_cases`.
        faces : numbers of the faces to be cut, and "top" or "bottom": only their bending counts. Empty for
            all faces.
        part : the STEP file that the part was read from; a part without a solid needs none.
        supports : pads under the part and a clamp on top: a result of :meth:`supports`.
        best : number, from 1, of the set of three among ``supports``.
        clamp_force : force in N of the clamp on top; None for the force that it needs.
        straps : straps that hold the part in place of its side clamps: a result of :meth:`straps`. ``jaw_force`` is
            then that of each strap, and None the force that they need.

        Raises
        ------
        InputError
            For a fixture that is not one of a result, a part of unknown thickness, a solid without its STEP
            file, a part that cannot be meshed, and when the extra is not installed.
        """
        from workhold.presenting.bent import compute_bending

        return compute_bending(
            self,
            material,
            thickness=thickness,
            jaw_force=jaw_force,
            jaw=jaw,
            faces=faces,
            part=part,
            supports=supports,
            best=best,
            clamp_force=clamp_force,
            straps=straps,
        )


def refuse_unless(belongs: bool, what: str) -> None:
    """Raise InputError unless ``belongs`` is true; the message says that the fixture is of another ``what``."""
    if not belongs:
        raise InputError(f"this fixture is of another {what}: give the one that it was designed for.")
