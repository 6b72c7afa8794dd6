"""The outlines of a part: that which all pegs meet, and those of carriers with heights of their own.

A solid is met by a peg that reaches from a to p as the outline U(a, p + head room). So a clamp whose tip
begins above a flange, or a wall lower than the pegs, meets an outline of its own, with bands of its own. What
is done about that is the least that is right:

- A workpiece keeps the outline of each such carrier as a workpiece of its own, without remarks. Segments are
  numbered on: after those of the workpiece come those of the first outline, and so on, in the order of the
  toolkit's carriers. So a face's number alone says of which outline it is, and nothing that passes numbers on
  has to know of outlines.
- Carriers of the same heights share one outline and its numbers.
- Contacts of a carrier lie on the touchable faces of its outline, trimmed by that outline alone. The search,
  the engines and the proof take rows of features for each of two carriers anyway. A clearance that is looked
  at once more, and a clamp's body, are held to the carrier's outline.
- The part lies flush on a wall with the hull of the wall's outline.
- A face that is avoided stands for the faces of the solid over it, which are avoided in every outline.
- The diameter, by which moments are scaled and chords are bounded, is that of all outlines together. The
  centre that moments are about stays that of the workpiece.
- A rotation of the part counts where it carries every outline onto itself.
- Half a turn does not swap jaws of different heights.

A drawing without heights is the same at all of them, and so has no such outlines.

Glossary
--------
role : the name that carriers of the same heights share, such as "clamp" for the clamps of all directions.
own outline : the outline that carriers of a role meet.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from math import hypot, pi, sin, tau
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.fixels.carrier import Heights
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.loop import Face, LoopShape, encloses, near_pairs
from workhold.geometry.segment import Arc, Segment
from workhold.model.solid import Band, SolidOutline

if TYPE_CHECKING:
    from workhold.model.workpiece import Workpiece

__all__ = [
    "NumberedOutlines",
    "met_by",
    "numbered_solid",
    "outer_count",
    "outline_diameter",
    "own_name",
    "refuse_misplaced_holes",
    "segments_diameter",
    "unlike",
    "with_own_outlines",
]

Value = TypeVar("Value")
# Distances that differ by less in proportion may be equal but for rounding.
ROUNDED = 1e-9


@frozen(eq=False)
class NumberedOutlines:
    """The segments and faces of a workpiece and of the outlines of carriers, numbered on.

    Parameters
    ----------
    segments : their places in this tuple are their numbers.
    faces : ordered by their numbers.
    bands : for every segment its band; None where it may not be touched, nothing at all without a solid.
    over : for every segment the numbers of the solid's faces over it; nothing where these are not known.
    marks : for every face the number of its outline: 0 for the workpiece itself.
    inside : the numbers of the faces of holes.
    """

    segments: tuple[Segment, ...]
    faces: tuple[Face, ...]
    bands: tuple[Band | None, ...]
    over: tuple[tuple[int, ...], ...]
    marks: tuple[int, ...]
    inside: frozenset[int]

    @classmethod
    def of(cls, outlines: Sequence[Workpiece]) -> NumberedOutlines:
        """Several outlines, the first of which the others belong to."""
        segments, faces, bands = list[Segment](), list[Face](), list[Band | None]()
        over, inside = list[tuple[int, ...]](), set[int]()
        for one in outlines:
            first = len(segments)
            inside.update(first + face.number for face in one.faces if face.number >= one.outer_count)
            faces += [
                evolve(face, number=first + face.number, segments=tuple(first + k for k in face.segments))
                for face in one.faces
            ]
            segments += one.segments
            if one.solid is not None:
                bands += one.solid.bands
                over += one.solid.faces
        marks = tuple(number for number, one in enumerate(outlines) for _ in one.faces)
        known = len(over) == len(segments)
        solids = tuple(over) if known else ()
        return cls(tuple(segments), tuple(faces), tuple(bands), solids, marks, frozenset(inside))

    def faces_over(self, segments: Iterable[int]) -> set[int]:
        """Numbers of the solid's faces over some segments."""
        return {face for segment in segments for face in self.over[segment]} if self.over else set()

    def segments_under(self, faces: Set[int]) -> list[int]:
        """Numbers of the segments with one of these faces of the solid over them."""
        return [segment for segment, over in enumerate(self.over) if not faces.isdisjoint(over)]


def unlike(values: Iterable[Value]) -> Iterator[Value]:
    """The values without those that are equal to one before them."""
    known = list[Value]()
    for value in values:
        if value not in known:
            known.append(value)
            yield value


def outer_count(name: str, shapes: Sequence[LoopShape]) -> int:
    """How many loops lie in no other, or in a hole (loops are known not to meet).

    Raises
    ------
    InputError
        Where they do not come before the others.
    """
    boxes = np.array([shape.box for shape in shapes])
    around = [
        [
            other
            for _, other in near_pairs(boxes[k : k + 1], boxes)
            if other != k and encloses(shapes[other], one)
        ]
        for k, one in enumerate(shapes)
    ]
    outer = [len(others) % 2 == 0 for others in around]
    first_hole = outer.index(False) if False in outer else len(outer)
    if any(outer[first_hole:]):
        raise InputError(
            f"{name}: loop {first_hole} is a hole before an outer loop: give all outer loops first."
        )
    return first_hole


def refuse_misplaced_holes(name: str, shapes: Sequence[LoopShape]) -> None:
    """Refuses holes outside the outer loop and holes inside one another (loops are known not to meet).

    Raises
    ------
    InputError
        Naming the hole.
    """
    boxes = np.array([shape.box for shape in shapes])
    for index, hole in enumerate(shapes[1:], start=1):
        x, y = hole.segments[0].start
        if not encloses(shapes[0], hole):
            raise InputError(
                f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies outside the outer loop: the first loop "
                "must be the outline that encloses all the others."
            )
        for _, other in near_pairs(boxes[index : index + 1], boxes):
            if other not in (0, index) and encloses(shapes[other], hole):
                raise InputError(
                    f"{name}: loop {index}, at ({x:.6g}, {y:.6g}), lies inside the hole of loop {other}: "
                    "holes may not overlap; load the inner piece as a part of its own."
                )


def own_name(heights: Heights) -> str:
    """The name of an outline between two heights, which is the same for all carriers of these."""
    return f"outline from {heights[0]:g} to {heights[1]:g} mm"


def numbered_solid(workpiece: Workpiece) -> SolidOutline | None:
    """The solid with the bands and faces of all segments, numbered on; None where there is none."""
    if workpiece.solid is None or not workpiece.outlines:
        return workpiece.solid
    every = workpiece.numbered
    return evolve(workpiece.solid, bands=every.bands, faces=every.over)


def met_by(workpiece: Workpiece, toolkit: Toolkit) -> Workpiece:
    """The workpiece with the outlines of a toolkit's carriers, in their order, and no others.

    Raises
    ------
    InputError
        When the solid was read without the heights of a carrier.
    """
    wanted = {} if workpiece.solid is None else toolkit.heights
    if not wanted and not workpiece.outlines:
        return workpiece
    known: dict[str, Workpiece] = dict(workpiece.outlines)
    chosen: list[tuple[str, Workpiece]] = []
    for role, (low, high) in wanted.items():
        own = known.get(role)
        if own is None or own.solid is None or (own.solid.low, own.solid.peg_height) != (low, high):
            raise InputError(
                f"the {role} of this {toolkit.noun} touches from {low:g} to {high:g} mm, and "
                f"{workpiece.name} was read without these heights: read the file of the solid with them, as "
                "workhold design does, or in Python load(..., heights=toolkit.heights)."
            )
        chosen.append((role, own))
    outlines = tuple(chosen)
    return workpiece if outlines == workpiece.outlines else evolve(workpiece, outlines=outlines)


def with_own_outlines(
    workpiece: Workpiece, entries: Mapping[str, Mapping[str, Any]], heights: Mapping[str, Heights]
) -> Workpiece:
    """The workpiece with the outlines of a file's entry ``outlines``.

    Parameters
    ----------
    entries : by role the loops, the bands, and where they are known the solid's faces.
    heights : by role, of the file's toolkit, in its order.

    Raises
    ------
    InputError
        For a workpiece without a solid, and outlines that cannot be, or of roles without heights.
    """
    if workpiece.solid is None:
        raise InputError("it has outlines of carriers, but no solid: leave them out.")
    others = [role for role in entries if role not in heights]
    if others:
        raise InputError(f"it has an outline of the {others[0][:40]}, which has no heights of its own.")
    own = []
    for role, (low, high) in heights.items():
        if role in entries:
            bands, faces = entries[role]["bands"], entries[role].get("solid_faces") or ()
            changed = {"bands": bands, "faces": faces, "bottom": (), "top": (), "top_heights": ()}
            solid = evolve(workpiece.solid, low=low, peg_height=high, **changed)
            outline = workpiece.from_loops(own_name((low, high)), entries[role]["loops"], solid=solid)
            own.append((role, outline))
    return evolve(workpiece, outlines=tuple(own))


def outline_diameter(workpiece: Workpiece) -> float:
    """Largest distance in mm between two points of the silhouette, and of the outlines of carriers.

    Its ends are two joints, a joint and the far side of an arc, or the far sides of two arcs. Far sides lie
    on the line through the arcs' centres.
    """
    outer = [face.segment for one in workpiece.every_outline for face in one.outer_faces]
    middle = np.array([segment.at(0.0) for segment in outer])
    reach = np.array([farthest_from_middle(segment) for segment in outer])
    apart = [np.hypot(*(middle[index:] - middle[index]).T) for index in range(len(outer))]
    best, least = 0.0, max(float(distances.max()) for distances in apart)
    for index, distances in enumerate(apart):
        # Only pairs that are far enough apart are looked at closely.
        most = (distances + reach[index] + reach[index:]) * (1.0 + ROUNDED)
        for other in index + np.flatnonzero(most >= max(best, least)):
            best = max(best, segments_diameter(outer[index], outer[other]))
    return best


def farthest_from_middle(segment: Segment) -> float:
    """Largest distance in mm between the middle of a segment and a point of it."""
    if isinstance(segment, Arc):
        return 2.0 * segment.radius * sin(min(segment.half_sweep, pi) / 2.0)
    return segment.half_extent


def segments_diameter(a: Segment, b: Segment) -> float:
    """Largest distance in mm between a point of one segment and a point of another."""
    best = max(hypot(p[0] - q[0], p[1] - q[1]) for p in (a.start, a.end) for q in (b.start, b.end))
    for arc, other in ((a, b), (b, a)):
        if isinstance(arc, Arc):
            for q in (other.start, other.end):
                if (far := far_point(arc, q)) is not None:
                    best = max(best, hypot(far[0] - q[0], far[1] - q[1]))
    if isinstance(a, Arc) and isinstance(b, Arc):
        far_a, far_b = far_point(a, b.center), far_point(b, a.center)
        if far_a is not None and far_b is not None:
            best = max(best, hypot(far_a[0] - far_b[0], far_a[1] - far_b[1]))
        opposite = abs((a.mid_angle - b.mid_angle) % tau - pi)
        if a.center == b.center and opposite <= a.half_sweep + b.half_sweep:
            best = max(best, a.radius + b.radius)
    return best


def far_point(arc: Arc, point: tuple[float, float]) -> tuple[float, float] | None:
    """The point of an arc's circle farthest from a point, if it lies on the arc."""
    dx, dy = arc.center[0] - point[0], arc.center[1] - point[1]
    distance = hypot(dx, dy)
    if distance == 0.0:
        return None
    far = (arc.center[0] + arc.radius * dx / distance, arc.center[1] + arc.radius * dy / distance)
    return far if abs(arc.parameter(far)) <= arc.half_sweep else None
