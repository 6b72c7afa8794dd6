"""The workpiece: a generalized polygon with holes (paper, section 2.1), and its diameter."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from itertools import accumulate
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, evolve, field
from numpy.typing import ArrayLike, NDArray

from workhold.conventions import READING, SHORTEST
from workhold.errors import InputError, make_encodable, refuse_kind
from workhold.fixels.carrier import WALL
from workhold.geometry.hull import HullEdge, find_hull_edges
from workhold.geometry.loop import (
    ComparisonBudget,
    Face,
    LoopShape,
    check_vertices,
    compute_signed_area,
    list_loop_faces,
    make_loop_segments,
    refuse_meeting,
    refuse_no_area,
    refuse_self_crossing,
    reverse_vertices,
)
from workhold.geometry.merged_runs import (
    describe_chords,
    find_chorded_arcs,
    merge_chords,
    put_arcs_on_one_circle,
)
from workhold.geometry.segment import Point, Segment, compute_bounding_box
from workhold.limits import convert_real, make_real_array
from workhold.model.numbered_outlines import (
    NumberedOutlines,
    count_outer_loops,
    drop_equal_values,
    refuse_misplaced_holes,
)
from workhold.model.pose import FlushContacts, Pose
from workhold.model.solid import SolidOutline

if TYPE_CHECKING:
    import shapely

    from workhold.presenting.papers import Picture

__all__ = ["Workpiece"]


def encode_loops(loops: Sequence[NDArray[np.float64]]) -> tuple[bytes, ...]:
    """Return each loop's numbers as bytes, -0.0 replaced by 0.0, so that loops can be compared and hashed."""
    return tuple((loop + 0.0).tobytes() for loop in loops)


def check_name(name: Any) -> str:
    """Return the name of a part, without characters that cannot be encoded; raise InputError if it is not
    text.
    """
    refuse_kind(name, str, "the name of a part", "give text")
    return make_encodable(name)


# What an editor need not offer: other rooms use it.
INTERNAL = frozenset(
    {
        "apply_pose",
        "as_finished",
        "every_outline",
        "find_outline",
        "flush",
        "hole_segments",
        "hull_edges",
        "is_alike",
        "loop_segments",
        "numbered",
        "outer_count",
        "outer_face_counts",
        "outer_faces",
        "outer_loops",
        "outlines",
        "pieces",
        "turned_over",
        "untouchable",
    }
)


@define(frozen=True, slots=False, repr=False)
class Workpiece:
    """A prismatic part, known by its silhouette. Build it with :meth:`from_loops` or :func:`workhold.load`.

    Parts of the same name and the same loops are equal.

    Parameters
    ----------
    name : the user's name of the part.
    loops : (N, 3) read-only arrays of x, y (mm) and bulge; the outer loop first and counter-clockwise, then
        the holes, clockwise. A solid that pegs meet in several pieces has an outer loop for each, before all
        holes.
    remarks : changes made to the loops given, one sentence each.
    departure : largest distance in mm of the outline from the drawn one, if curves were read as lines and
        arcs.
    solid : position of the solid and bands of the segments, for an outline by height; None for a prism.
    outlines : by role, the outlines that carriers with heights of their own meet, see ``model.own_outlines``.
    finished : the finished part, if this is the raw block around it (``model.raw_block``); else None.

    Examples
    --------
    >>> from workhold import Workpiece
    >>> plate = Workpiece.from_loops("plate", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    >>> [face.number for face in plate.faces]
    [0, 1, 2, 3]
    """

    name: str = field(converter=check_name)
    loops: tuple[NDArray[np.float64], ...] = field(eq=encode_loops)
    remarks: tuple[str, ...] = field(default=(), eq=False)
    departure: float = 0.0
    solid: SolidOutline | None = None
    outlines: tuple[tuple[str, Workpiece], ...] = ()
    finished: Workpiece | None = None

    def __attrs_post_init__(self) -> None:
        refuse_kind(self.loops, Sequence, "the loops", "give a tuple of arrays")
        if self.solid is not None:
            self.solid.check_segment_count(sum(len(loop) for loop in self.loops))
        for loop in self.loops:
            refuse_kind(loop, np.ndarray, "a loop", "give an array (N, 3) of vertices: x, y and bulge")
            loop.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # What was worked out stays behind, and the arrays are read-only again on the other side.
        kept = (self.name, self.loops, (), self.departure, self.solid, self.outlines, self.finished)
        return Workpiece, kept

    @classmethod
    def from_loops(
        cls,
        name: str,
        loops: Sequence[ArrayLike],
        labels: Sequence[Sequence[str]] | None = None,
        departure: float = 0.0,
        solid: SolidOutline | None = None,
    ) -> Workpiece:
        """Return a part made of loops of (x, y, bulge) vertices in mm,
        checked and turned so that material is on the left.

        Parameters
        ----------
        name : the user's name of the part.
        loops : the outer loop first, then any holes; each (N, 3), run in either direction. With a solid,
            there may be several outer loops before the holes.
        labels : for every loop, a name for each of its segments in messages (such as ``LINE 2F``).
        departure : largest distance of these loops from the drawn curves, in mm; below ``READING`` it counts
            as 0.
        solid : the part's solid, with a band for every segment in the order of these loops; None for a prism.

        Raises
        ------
        InputError
            For open or degenerate loops, numbers that are not finite, segments of zero length, loops that
            cross or touch, holes outside the outer loop or inside one another. Also for holes that come
            before an outer loop.
        """
        try:
            loops = list(loops)
        except TypeError as error:
            raise InputError(
                f"{name} has no list of loops: give at least an outer loop in a list."
            ) from error
        if not loops:
            raise InputError(f"{name} has no loop: give at least an outer loop.")

        def describe_segment(loop: int, k: int) -> str:
            """Return a name for segment k of a loop for messages, with its label if there are labels."""
            # Labels follow the loop as drawn, so a message before turning must not use later numbers.
            label = f" ({labels[loop][k]})" if labels else ""
            return f"{name}: loop {loop}, segment {k}{label}"

        comparisons = ComparisonBudget(name)
        straightened = rounded = 0
        used: list[NDArray[np.float64]] = []
        drawn: list[LoopShape] = []
        for index, loop in enumerate(loops):
            place = partial(describe_segment, index)
            vertices = check_vertices(loop, f"{name}: loop {index}", place)
            straightened += int((np.asarray(loop)[:, 2] != vertices[:, 2]).sum())
            segments = make_loop_segments(vertices)
            vertices, changed = put_arcs_on_one_circle(vertices, segments)
            rounded += changed
            shape = LoopShape.from_segments(make_loop_segments(vertices) if changed else segments)
            refuse_self_crossing(shape, place, comparisons)
            refuse_no_area(shape, f"{name}: loop {index}")
            used.append(vertices)
            drawn.append(shape)
        refuse_meeting(drawn, describe_segment, comparisons)
        pieces = 1
        if solid is None:
            refuse_misplaced_holes(name, drawn, comparisons)
        else:
            pieces = count_outer_loops(name, drawn)
        order: list[int] = []
        turned: set[int] = set()
        for index, shape in enumerate(drawn):
            numbers = range(len(order), len(order) + len(used[index]))
            if (compute_signed_area(shape.segments) > 0) != (index < pieces):
                used[index] = reverse_vertices(used[index])
                order += reversed(numbers)
                turned.update(numbers)
            else:
                order += numbers
        if solid is not None:
            solid = solid.check_segment_count(len(order)).reorder(order, turned)
        return cls(
            name, tuple(used), describe_arc_changes(straightened, rounded), check_departure(departure), solid
        )

    @classmethod
    def from_points(
        cls, name: str, outline: ArrayLike, holes: Sequence[ArrayLike] = (), *, fit: float | None = None
    ) -> Workpiece:
        """Return a part made of corners; chords within 0.001 mm of an arc are replaced by the arc.

        Parameters
        ----------
        name : the user's name of the part.
        outline : (N, 2) corners in mm, run in either direction; the first may be repeated at the end.
        holes : corners (N, 2) of each hole.
        fit : largest distance in mm of chords from the arc that replaces them, if 0.001 mm is too fine; the
            part's ``departure`` then has the actual distance.

        Raises
        ------
        InputError
            As :meth:`from_loops`, and for a fit that is not a positive length.

        Examples
        --------
        Of a polygon of shapely, the corners are those of its rings: ``Workpiece.from_points("part",
        polygon.exterior.coords, [ring.coords for ring in polygon.interiors])``.

        >>> from math import cos, pi, sin
        >>> from workhold import Workpiece
        >>> circle = [(10 * cos(k * pi / 180), 10 * sin(k * pi / 180)) for k in range(361)]
        >>> plate = Workpiece.from_points("plate", [(-30, -20), (30, -20), (30, 20), (-30, 20)], [circle])
        >>> len(plate.faces), round(plate.faces[-1].segment.radius, 6), plate.departure < 0.0004
        (5, 10.0, True)
        """
        if fit is not None and not (isfinite(convert_real(fit, "the fit")) and fit > 0):
            raise InputError(f"the fit {fit} is not usable: give a length above 0, in mm.")
        loops, away, chorded = [], 0.0, []
        for index, points in enumerate([outline, *holes]):
            merged = merge_chords(to_vertices(points, f"{name}: loop {index}"), fit)
            loops.append(merged.vertices)
            away = max(away, merged.departure)
            left = find_chorded_arcs(merged.vertices)
            chorded += [left] if left is not None and (fit is None or left.fit > fit) else []
        part = cls.from_loops(name, loops, departure=away)
        return evolve(part, remarks=(*part.remarks, *describe_chords(chorded, "fit")))

    def is_alike(self, other: Workpiece) -> bool:
        """Return whether another part equals this one apart from its name."""
        return self is other or (isinstance(other, Workpiece) and evolve(other, name=self.name) == self)

    def __dir__(self) -> list[str]:
        return sorted(set(object.__dir__(self)) - INTERNAL)

    def __repr__(self) -> str:
        faces, holes, (x0, y0, x1, y1) = len(self.faces), len(self.loops) - self.pieces, self.bounds
        inside = f", {holes} hole{'s' * (holes != 1)}" if holes else ""
        size = f"{x1 - x0:.6g} x {y1 - y0:.6g} mm"
        return f"<Workpiece {self.name}: {faces} face{'s' * (faces != 1)}{inside}, {size}>"

    def _repr_svg_(self) -> str:
        return self.draw()

    def _repr_html_(self) -> str:
        from workhold.presenting.notebook import render_workpiece_html

        return render_workpiece_html(self)

    def draw(
        self,
        path: str | Path | None = None,
        *,
        peg_radius: float | None = None,
        unit: str = "mm",
        overwrite: bool = False,
    ) -> Picture:
        """Return a drawing of the part with its faces numbered as SVG text,
        which a notebook shows; write it if asked.

        Parameters
        ----------
        path : also write it into this file, whose name ends in .svg or .png.
        peg_radius : in mm; also draw the curves on which the centre of such a peg lies when it touches a
            face.
        unit : of the lengths written: "mm", "cm", "m" or "inch".
        overwrite : whether a file that workhold has not written may be replaced.

        Raises
        ------
        InputError
            For a unit that is not known, and when the file cannot be written or replaced.
        """
        from workhold.presenting.papers import draw_and_save_workpiece

        return draw_and_save_workpiece(self, path, peg_radius=peg_radius, unit=unit, overwrite=overwrite)

    def to_shapely(self, tolerance: float = 0.01) -> shapely.Polygon | shapely.MultiPolygon:
        """Return the part as a shapely polygon in mm, in its own frame; a multipolygon if it has several
        pieces.

        Parameters
        ----------
        tolerance : largest distance in mm of chords from the arcs that they replace; their ends lie on the
            arcs.

        Raises
        ------
        InputError
            For a tolerance that is not a positive length, and if shapely is not installed.
        """
        from workhold.presenting.data import to_shapely

        return to_shapely(self, tolerance)

    @cached_property
    def loop_segments(self) -> tuple[tuple[Segment, ...], ...]:
        """Segments of each loop, in the order of its vertices."""
        return tuple(make_loop_segments(vertices) for vertices in self.loops)

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """All segments, loop by loop; a segment's index is its number."""
        return tuple(segment for loop in self.loop_segments for segment in loop)

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """All faces, in the order of their numbers; a face has the number of its first segment."""
        faces: list[Face] = []
        number = 0
        for loop in self.loop_segments:
            bands = None if self.solid is None else self.solid.bands[number : number + len(loop)]
            faces += list_loop_faces(loop, number, bands)
            number += len(loop)
        return tuple(faces)

    @cached_property
    def every_outline(self) -> tuple[Workpiece, ...]:
        """The part itself, then the outlines of carriers with heights of their own, without repeats."""
        return tuple(drop_equal_values([self, *(own for _, own in self.outlines)]))

    @cached_property
    def numbered(self) -> NumberedOutlines:
        """Segments and faces of :attr:`every_outline`; the numbers of each outline continue after those of
        the previous one.
        """
        return NumberedOutlines.from_outlines(self.every_outline)

    def find_outline(self, role: str) -> tuple[Workpiece, int]:
        """Return (outline, offset): the own outline that carriers of a role meet, or else the part itself.

        ``offset`` is the number that its first segment has in :attr:`numbered`.
        """
        every, own = self.every_outline, dict(self.outlines).get(role, self)
        return own, sum(len(one.segments) for one in every[: every.index(own)])

    @cached_property
    def untouchable(self) -> frozenset[int]:
        """Numbers of the faces that no peg, clamp or wall may touch: those with a segment without a band."""
        if self.solid is None:
            return frozenset()
        bands = self.solid.bands
        return frozenset(f.number for f in self.faces if any(bands[k] is None for k in f.segments))

    @cached_property
    def pieces(self) -> int:
        """Number of outer loops, which come first: 1, except for a solid that pegs meet in several pieces."""
        areas = [compute_signed_area(loop) for loop in self.loop_segments[1:]]
        return 1 + next((k for k, area in enumerate(areas) if area <= 0), len(areas))

    @cached_property
    def outer_count(self) -> int:
        """Number of segments of the outer loops; faces with lower numbers than this belong to them."""
        return sum(len(loop) for loop in self.loops[: self.pieces])

    @property
    def outer_loops(self) -> tuple[NDArray[np.float64], ...]:
        """Vertices of the outer loops, each (N, 3)."""
        return self.loops[: self.pieces]

    @property
    def outer_faces(self) -> tuple[Face, ...]:
        """Faces of the outer loops."""
        return tuple(face for face in self.faces if face.number < self.outer_count)

    @property
    def outer_face_counts(self) -> list[int]:
        """Number of faces of each outer loop."""
        ends = [0, *accumulate(len(loop) for loop in self.loops[: self.pieces])]
        return list(np.diff(np.searchsorted([face.number for face in self.outer_faces], ends)).tolist())

    @property
    def hole_segments(self) -> tuple[tuple[Segment, ...], ...]:
        """Segments of each hole."""
        return self.loop_segments[self.pieces :]

    @cached_property
    def hull_edges(self) -> tuple[HullEdge, ...]:
        """Straight edges of the convex hull of the outline that walls meet;
        they name faces by their index in it.
        """
        own, _ = self.find_outline(WALL)
        return find_hull_edges([face.segment for face in own.outer_faces], own.outer_face_counts)

    @cached_property
    def flush(self) -> FlushContacts:
        """Contacts of the part lying on a wall, one for each hull edge."""
        own, first = self.find_outline(WALL)
        return FlushContacts.from_hull_edges(self.hull_edges, [first + face.number for face in own.faces])

    @cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """(smallest x, smallest y, largest x, largest y) in mm, in the part's frame."""
        outer = self.segments[: self.outer_count]
        boxes = np.array([compute_bounding_box(segment) for segment in outer])
        low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @property
    def as_finished(self) -> Workpiece:
        """The finished part: of a raw block the part inside it, else the part itself."""
        return self if self.finished is None else self.finished

    @cached_property
    def turned_over(self) -> Workpiece:
        """The part mirrored, x to -x in its own frame, as a prism with faces numbered anew."""
        loops = (reverse_vertices(loop * np.array([-1.0, 1.0, -1.0])) for loop in self.loops)
        return Workpiece(self.name, tuple(loops), departure=self.departure)

    def apply_pose(self, pose: Pose) -> Workpiece:
        """Return the workpiece moved into the toolkit's frame by a pose: its loops, and the loops of its own
        outlines.
        """
        loops = (np.column_stack([*pose.apply(loop[:, 0], loop[:, 1]), loop[:, 2]]) for loop in self.loops)
        own = tuple((role, one.apply_pose(pose)) for role, one in self.outlines)
        return Workpiece(self.name, tuple(loops), (), self.departure, self.solid, own)

    @property
    def center(self) -> Point:
        """Centre (x, y) in mm of the bounding box, the point that moments are taken about."""
        x0, y0, x1, y1 = self.bounds
        return (x0 + x1) / 2, (y0 + y1) / 2


def to_vertices(points: ArrayLike, loop: str) -> NDArray[np.float64]:
    """Return the corners (N, 2) of a loop as checked vertices
    (N, 3) with bulge 0, without a repeated first corner.

    Raises InputError for anything else; ``loop`` names the loop in messages.
    """
    try:
        array = make_real_array(points, f"{loop}: a coordinate")
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{loop} is not a list of corners [x, y]: give two numbers for every corner."
        ) from error
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{loop} is not a list of corners [x, y]: give two numbers for every corner.")
    if len(array) > 1 and np.hypot(*(array[0] - array[-1])) < SHORTEST:
        array = array[:-1]
    rows = np.column_stack([array, np.zeros(len(array))])
    return check_vertices(rows, loop, lambda k: f"{loop}, corner {k}")


def check_departure(value: float) -> float:
    """Return the departure of an outline in mm, 0.0 where it is less than :data:`READING`.

    Raises InputError for a value that is not 0 or more.
    """
    if not (isfinite(convert_real(value, "the departure of the outline")) and value >= 0):
        raise InputError(f"the departure {value} of the outline is not a length: give 0 or more, in mm.")
    return 0.0 if value < READING else float(value)


def describe_arc_changes(straightened: int, rounded: int) -> tuple[str, ...]:
    """Return sentences with the numbers of arcs that were replaced by lines and that were moved onto one
    circle with a neighbour.
    """
    remarks = []
    if straightened:
        arcs, taken = (
            ("1 arc that is", "one") if straightened == 1 else (f"{straightened} arcs that are", "lines")
        )
        line = f"{READING:g} mm, or a millionth of its length, from a line"
        remarks.append(f"{arcs} nowhere farther than {line} taken for {taken}.")
    if rounded:
        circle = f"{READING:g} mm from one circle with their neighbours"
        remarks.append(f"{rounded} arcs that are nowhere farther than {circle} put on it.")
    return tuple(remarks)
