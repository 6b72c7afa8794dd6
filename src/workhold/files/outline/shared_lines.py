"""The outlines of a drawing, also of neighbours that share lines, and the spots where none can be determined.

Glossary
--------
nest : outlines that share lines, as parts do that are cut apart by one common cut.
bad spot : connected lines and arcs that could be an outline in more than one way. A part with a bad spot
    cannot be read; other parts can.
frame : a nest with whole parts inside one of its outlines, as a sheet's border with its title block is.
cluster : connected lines and arcs, see ``outline.plane_map``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import pi

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.budget import Budget, OverBudgetError
from workhold.files.outline.chain import (
    Chain,
    Drawing,
    format_count,
    format_point,
    list_first_items,
    strip_segment_number,
)
from workhold.files.outline.diagnostics import surrounds_box
from workhold.files.outline.joining import JoinedChains, JoinedLoop, Junction, OpenChain, join
from workhold.files.outline.nesting import DrawnPart, MeasuredLoop, boxes_meet, choose_part, nest_loops
from workhold.files.outline.plane_map import CurveCluster, make_clusters
from workhold.files.questions import PART_NUMBER
from workhold.geometry.segment import Arc, Line, Segment, compute_box_around
from workhold.kernels.base.distance import is_inside

__all__ = ["AmbiguousSpot", "DrawnOutlines", "choose_outline", "make_outlines", "describe_bad_spots"]

# mm. Cells no wider are graph paper or letters, and no parts.
LEAST_CELL = 2.0
# A sound outline is taken beside a bad spot that is so many times as large at most: otherwise it is a detail.
MOST_LARGER = 4.0


@frozen
class AmbiguousSpot:
    """A bad spot, where an outline could go on in more than one way.

    Parameters
    ----------
    junction : the first such point.
    box : bounding box of everything connected with it: (smallest x, smallest y, largest x, largest y) in mm.
    bounds_something : whether it encloses an area, so that it can be a border.
    layer : layer of the lines that meet at the junction; "" if they are on several layers.
    """

    junction: Junction
    box: tuple[float, float, float, float]
    bounds_something: bool
    layer: str = ""

    def __str__(self) -> str:
        """Return the junction in words, with the layer."""
        return f"{self.junction}{f' on layer {self.layer!r}' if self.layer else ''}"

    @property
    def area(self) -> float:
        """Area of its box in mm²."""
        return (self.box[2] - self.box[0]) * (self.box[3] - self.box[1])


@frozen
class DrawnOutlines:
    """The outlines that a drawing's lines and arcs make.

    Parameters
    ----------
    parts : by decreasing area.
    strays : open runs of chains.
    spots : bad spots.
    remarks : sentences on joined, omitted and shared lines.
    """

    parts: tuple[DrawnPart, ...]
    strays: tuple[OpenChain, ...]
    spots: tuple[AmbiguousSpot, ...]
    remarks: tuple[str, ...]


def make_outlines(
    chains: Sequence[Chain], tolerance: float, drawing: Drawing, budget: Budget
) -> DrawnOutlines:
    """Return the outlines that chains make, in mm and without segments of zero length.

    Raises InputError if too many ends lie within the tolerance of each other.

    Parameters
    ----------
    tolerance : largest gap to close, in mm.
    drawing : the drawing that the chains are from; it gives the layers, colours and line types of segments.
    budget : work and time that may still be spent on the file.
    """
    joined = join(chains, tolerance, budget)
    remarks = list(joined.remarks)
    if joined.strays and not joined.junctions:
        joined = drop_doubled_lines(joined, tolerance, remarks)
    if not joined.junctions:
        return DrawnOutlines(nest_loops(joined.loops, budget), joined.strays, (), tuple(remarks))
    return untangle_outlines(joined, tolerance, drawing, budget, remarks)


def drop_doubled_lines(joined: JoinedChains, tolerance: float, remarks: list[str]) -> JoinedChains:
    """Return joined chains in which lines or arcs drawn on top of each other, in open chains, are kept only
    once.

    Outlines that the remaining lines close are added to the loops; ``remarks`` is extended.
    """
    chains = [stray.chain for stray in joined.strays]
    if not run_along_each_other([segment for chain in chains for segment in chain.segments], tolerance):
        return joined
    clusters = [one for one in try_to_make_clusters(chains, tolerance) if one.doubled]
    if not clusters:
        return joined
    taken = {number for one in clusters for number in one.chains}
    strays = [stray for number, stray in enumerate(joined.strays) if number not in taken]
    loops = list(joined.loops)
    for number, one in enumerate(clusters, start=1):
        loops += [evolve(face, nest=number if len(one.faces) > 1 else 0) for face in one.faces]
        strays += [make_stray(chain) for chain in one.open]
        remarks += describe_shared_lines(one)
    places = list_first_items([said for one in clusters for said in find_doubled_places(one)])
    remarks.append(f"Read lines or arcs that lie on each other as one: {places}.")
    return evolve(joined, loops=tuple(loops), strays=tuple(strays))


def untangle_outlines(
    joined: JoinedChains, tolerance: float, drawing: Drawing, budget: Budget, remarks: list[str]
) -> DrawnOutlines:
    """Return the outlines of a drawing that has junctions (points where three ends or more meet).

    Outlines that share lines become parts; spots where an outline could go on in more than one way are
    collected. Arguments are those of :func:`make_outlines`, with the chains joined; ``remarks`` is extended.
    """
    junctions = JunctionIndex.from_junctions(joined.junctions, drawing.layers)
    tangled = list(joined.tangled)
    around = compute_box_around([segment for chain in tangled for segment in chain.segments])
    near = [loop for loop in joined.loops if boxes_meet(compute_loop_box(loop), around)]
    extra = [*(stray.chain for stray in joined.strays), *map(make_chain_from_loop, near)]
    clusters = [
        one
        for one in try_to_make_clusters([*tangled, *extra], tolerance)
        if any(number < len(tangled) for number in one.chains)
    ]
    clusters.sort(key=lambda one: (one.box[0] - one.box[2]) * (one.box[3] - one.box[1]))
    loops, strays = list(joined.loops), list(joined.strays)
    spots, nests = list[AmbiguousSpot](), list[CurveCluster]()
    known = set[int]()
    for one in clusters:
        known |= one.chains
        budget.check_time()
        gone = {
            id(near[k - len(tangled) - len(joined.strays)])
            for k in one.chains
            if k >= len(tangled) + len(joined.strays)
        }
        others = [loop for loop in loops if id(loop) not in gone]
        if is_nest(one, drawing) and not lies_in_material(one, others):
            nests.append(one)
            taken = {k - len(tangled) for k in one.chains}
            strays = [
                stray
                for stray in strays
                if not any(stray is joined.strays[k] for k in taken if 0 <= k < len(joined.strays))
            ]
            loops = others + [evolve(face, nest=len(nests)) for face in one.faces]
            strays += [make_stray(chain) for chain in one.open]
        else:
            labels = {label for k in one.chains if k < len(tangled) for label in tangled[k].labels}
            spots += junctions.find_bad_spots(labels, one.box, bool(one.faces))
    for k, chain in enumerate(tangled):
        if k not in known:
            # There is too much of it to look at.
            spots += junctions.find_bad_spots(chain.labels, compute_box_around(chain.segments), True)
    parts = nest_loops(loops, budget)
    frames = {number for number in range(1, len(nests) + 1) if is_frame(number, parts)}
    if frames:
        parts = nest_loops([loop for loop in loops if loop.nest not in frames], budget)
    for number, one in enumerate(nests, start=1):
        names = list_first_items(
            list(dict.fromkeys(strip_segment_number(label) for label, _, _ in one.shared))
        )
        remarks += (
            [f"Left out a frame around the parts ({names})."]
            if number in frames
            else describe_shared_lines(one)
        )
    return DrawnOutlines(parts, tuple(strays), tuple(join_bad_spots(spots)), tuple(remarks))


def try_to_make_clusters(chains: Sequence[Chain], tolerance: float) -> list[CurveCluster]:
    """Return the result of :func:`make_clusters`; [] where there are too many segments."""
    try:
        return make_clusters(chains, tolerance)
    except OverBudgetError:
        raise
    except InputError:
        return []


def is_nest(one: CurveCluster, drawing: Drawing) -> bool:
    """Return whether a cluster of connected lines is a nest: outlines that
    share lines, as parts do that one cut separates.

    The outlines must be on one layer, larger than letters, and not a single outline with open pieces. A
    shared line that is drawn unlike all other lines of the outlines is taken for a bend or a marking, not for
    a cut: then the answer is False.
    """
    if not one.faces or (len(one.faces) == 1 and one.open):
        return False
    labels = {label for face in one.faces for label in face.labels}
    used = {drawing.layers.get(label, "").casefold() for label in labels}
    shared = {label for label, _, _ in one.shared}
    looks = {drawing.looks.get(label) for label in labels - shared}
    if looks and any(drawing.looks.get(label) not in looks for label in shared):
        return False
    size = max(max(x1 - x0, y1 - y0) for x0, y0, x1, y1 in map(compute_loop_box, one.faces))
    return len(used) == 1 and size > LEAST_CELL


def lies_in_material(one: CurveCluster, loops: Sequence[JoinedLoop]) -> bool:
    """Return whether connected lines lie inside the material of a part, so that their outlines are holes.

    ``loops`` are the outlines of the drawing; the lines are in material if an odd number of them surrounds
    the lines.
    """
    x, y, _ = one.faces[0].vertices[0]
    around = [loop for loop in loops if surrounds_box(compute_loop_box(loop), one.box)]
    return sum(is_inside(float(x), float(y), MeasuredLoop.from_loop(loop).rows) for loop in around) % 2 == 1


def is_frame(number: int, parts: Sequence[DrawnPart]) -> bool:
    """Return whether outlines that share lines are a frame, such as a sheet's border, with a whole part in one of
    their holes.

    ``number`` is the ``nest`` of the outlines. Only parts of another nest count as lying in a hole.
    """
    for part in parts:
        if part.loops[0].nest != number:
            continue
        for hole in map(MeasuredLoop.from_loop, part.loops[1:]):
            for other in parts:
                if surrounds_box(hole.box, other.bounds) and other.loops[0].nest != number:
                    x, y, _ = other.loops[0].vertices[0]
                    if is_inside(float(x), float(y), hole.rows):
                        return True
    return False


@frozen
class JunctionIndex:
    """The junctions of a drawing, found by the labels of the segments that end there.

    Parameters
    ----------
    junctions : in their order.
    first : index of the first junction of each label.
    layers : for each junction the layer of its segments; "" where they are on several.
    """

    junctions: tuple[Junction, ...]
    first: Mapping[str, int]
    layers: tuple[str, ...]

    @classmethod
    def from_junctions(cls, junctions: Sequence[Junction], layers: Mapping[str, str]) -> JunctionIndex:
        """Make the index; ``layers`` gives the layer of each segment by its label."""
        first = dict[str, int]()
        alone = list[str]()
        for number, junction in enumerate(junctions):
            used = {layers.get(label, "") for label in junction.labels}
            alone.append(used.pop() if len(used) == 1 else "")
            for label in junction.labels:
                first.setdefault(label, number)
        return cls(tuple(junctions), first, tuple(alone))

    def find_bad_spots(
        self, labels: Iterable[str], box: tuple[float, float, float, float], bounds_something: bool
    ) -> list[AmbiguousSpot]:
        """Return a list with the ambiguous spot at the first junction where a segment with one of the labels
        ends; [] if no such segment ends at a junction.

        Parameters
        ----------
        labels : labels of the segments.
        box, bounds_something : see :class:`AmbiguousSpot`.
        """
        number = min((self.first[label] for label in labels if label in self.first), default=None)
        if number is None:
            return []
        return [AmbiguousSpot(self.junctions[number], box, bounds_something, self.layers[number])]


def join_bad_spots(spots: Sequence[AmbiguousSpot]) -> list[AmbiguousSpot]:
    """Return the ambiguous spots, with those at the same junction merged
    into one, in order of first appearance.
    """
    found: dict[int, AmbiguousSpot] = {}
    for spot in spots:
        known = found.setdefault(id(spot.junction), spot)
        low, high = np.minimum(known.box, spot.box), np.maximum(known.box, spot.box)
        found[id(spot.junction)] = evolve(known, box=(*low[:2].tolist(), *high[2:].tolist()))
    return list(found.values())


def choose_outline(outlines: DrawnOutlines, number: int | str | None) -> DrawnPart:
    """Return the part with the number given; for None the largest part without an ambiguous spot in its
    material.

    Raises InputError (a) where there is no such part, (b) where an ambiguous spot lies in the material of the
    part with that number, and (c) for None, where something with an ambiguous spot is much larger than the
    part or surrounds it, so that it may be meant.
    """
    parts, spots = outlines.parts, outlines.spots
    if number is not None or not spots:
        part = choose_part(parts, number)
        for spot in spots:
            if is_spoiled(part, spot):
                raise spot.junction.refusal
        return part
    sound = [part for part in parts if not any(is_spoiled(part, spot) for spot in spots)]
    if not sound:
        raise spots[0].junction.refusal
    best = sound[0]
    for spot in spots:
        larger = [spot.area, *(part.area for part in parts if is_spoiled(part, spot))]
        around = [spot.box, *(part.bounds for part in parts if is_spoiled(part, spot))]
        if max(larger) > MOST_LARGER * best.area or any(surrounds_box(box, best.bounds) for box in around):
            said = str(spot.junction.refusal).rstrip(".")
            raise InputError(
                f"{said}. To read what lies beside it, give {PART_NUMBER} {best.number}: {best}."
            )
    return best


def is_spoiled(part: DrawnPart, spot: AmbiguousSpot) -> bool:
    """Return whether an ambiguous spot lies in the material
    of a part, where it may be the border of a hole.
    """
    if not spot.bounds_something or not boxes_meet(part.bounds, spot.box):
        return False
    x, y = spot.junction.point
    outer, *holes = (MeasuredLoop.from_loop(loop) for loop in part.loops)
    return bool(is_inside(x, y, outer.rows)) and not any(is_inside(x, y, hole.rows) for hole in holes)


def describe_bad_spots(outlines: DrawnOutlines) -> list[str]:
    """Return a sentence on the spots where an outline could go on in more than one way; [] without any."""
    if not outlines.spots:
        return []
    places = list_first_items([str(spot) for spot in outlines.spots])
    spoiled = [
        str(part.number) for part in outlines.parts if any(is_spoiled(part, spot) for spot in outlines.spots)
    ]
    cannot = f"; part {', '.join(spoiled[:10])} around cannot be read" if spoiled else ""
    count = format_count(len(outlines.spots), "place", "places")
    return [f"Left out {count} where an outline could go on in more than one way: {places}{cannot}."]


def describe_shared_lines(one: CurveCluster) -> list[str]:
    """Return a sentence on the lines that outlines share; [] for fewer than two outlines."""
    if len(one.faces) < 2:
        return []
    places = list_first_items(
        [f"{label} from {format_point(start)} to {format_point(end)}" for label, start, end in one.shared]
    )
    return [
        f"Read {len(one.faces)} outlines that share lines as separate parts: {places}; where such a line is a "
        "bend or a marking and no cut, remove it, or put it on a layer that is not chosen."
    ]


def find_doubled_places(one: CurveCluster) -> list[str]:
    """Return phrases on the lines or arcs that were drawn on top of each other, and where."""
    return [
        f"{strip_segment_number(label)} and {strip_segment_number(other)} from {format_point(start)} to {format_point(end)}"
        for label, other, start, end in one.doubled
    ]


def make_stray(chain: Chain) -> OpenChain:
    """Return an open chain with the names of its first and last entity."""
    return OpenChain(chain, strip_segment_number(chain.labels[0]), strip_segment_number(chain.labels[-1]))


def make_chain_from_loop(loop: JoinedLoop) -> Chain:
    """Return a loop as a closed chain."""
    points = [(float(x), float(y)) for x, y in loop.vertices[:, :2]]
    return Chain((*points, points[0]), tuple(loop.vertices[:, 2].tolist()), loop.labels)


def compute_loop_box(loop: JoinedLoop) -> tuple[float, float, float, float]:
    """Return the bounding box (x0, y0, x1, y1) of a loop in mm."""
    return compute_box_around(make_chain_from_loop(loop).segments)


# Radians and mm: lines and circles nearer than this are looked at as one.
NEAR_ANGLE, NEAR_PLACE = 1e-6, 1e-5


def run_along_each_other(segments: Sequence[Segment], tolerance: float) -> bool:
    """Return whether any two of some lines and arcs coincide over more
    than a tolerance in mm of their length.
    """
    lines = [one for one in segments if isinstance(one, Line)]
    if len(lines) > 1 and lines_run_along_each_other(lines, tolerance):
        return True
    arcs: dict[tuple[float, ...], list[tuple[float, float]]] = {}
    for one in segments:
        if isinstance(one, Arc):
            key = tuple(round(value / NEAR_PLACE) for value in (*one.center, one.radius))
            first = (one.mid_angle - one.half_sweep) % (2 * pi)
            spans = arcs.setdefault(key, [])
            slack = tolerance / one.radius
            for turn in (-2 * pi, 0.0):
                spans.append((first + turn + slack, first + turn + 2 * one.half_sweep - slack))
    return any(have_overlap(spans) for spans in arcs.values())


def lines_run_along_each_other(lines: Sequence[Line], tolerance: float) -> bool:
    """Return whether any two of some lines coincide over more than a tolerance in mm of their length."""
    rows = np.array([(*one.start, *one.end) for one in lines])
    rows = rows - np.tile(rows.reshape(-1, 2).mean(axis=0), 2)
    angle = np.arctan2(rows[:, 3] - rows[:, 1], rows[:, 2] - rows[:, 0]) % pi
    angle[angle > pi - NEAR_ANGLE] -= pi
    for some in group_near_values(angle, np.arange(len(rows)), NEAR_ANGLE):
        turned = float(angle[some[0]])
        c, s = np.cos(turned), np.sin(turned)
        off = c * rows[some, 1] - s * rows[some, 0]
        for same in group_near_values(off, some, NEAR_PLACE):
            along = np.sort(rows[same][:, [0, 2]] * c + rows[same][:, [1, 3]] * s, axis=1)
            if have_overlap([(low + tolerance / 2, high - tolerance / 2) for low, high in along.tolist()]):
                return True
    return False


def group_near_values(
    values: NDArray[np.float64], numbers: NDArray[np.int64], slack: float
) -> list[NDArray[np.int64]]:
    """Return groups of ``numbers`` whose values are near to each other,
    as one array per group of two and more.

    Sorted by value, neighbours within a group differ by at most ``slack``.

    Parameters
    ----------
    values, numbers : (N,) each; ``values[i]`` is the value of ``numbers[i]``.
    """
    order = np.argsort(values, kind="stable")
    breaks = np.flatnonzero(np.diff(values[order]) > slack) + 1
    return [numbers[part] for part in np.split(order, breaks) if len(part) > 1]


def have_overlap(spans: Sequence[tuple[float, float]]) -> bool:
    """Return whether two of some spans (low, high) overlap; spans with high <= low are ignored."""
    reached = -np.inf
    for low, high in sorted(spans):
        if high <= low:
            continue
        if low < reached:
            return True
        reached = max(reached, high)
    return False
