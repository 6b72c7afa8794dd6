"""Paths of tools on a page: cutting moves in colours for tool and height, and rapid moves dashed.

On the plan of a fixture the path is turned with the part. The move that comes nearest to what holds the part
is marked with its program line and its distance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import hypot, pi

import numpy as np
from attrs import astuple, frozen
from numpy.typing import NDArray

from workhold.drawing.annotation import Label, LabelPlacer, PlacedLabel, make_label_around
from workhold.drawing.scene import GREY, Box, LengthUnit, Scene, View, format_number, measure_text
from workhold.model.fixture import Fixture
from workhold.model.moves import Moves, compute_path_points
from workhold.model.pose import Pose
from workhold.model.program import Program
from workhold.model.program_figures import bound_tip, measure_tools
from workhold.model.result import Result
from workhold.statics.program_clearance import ToolClearance, find_nearest_passing

__all__ = [
    "COLOURS",
    "SHADES",
    "PagePaths",
    "PathStyle",
    "PlannedPath",
    "draw_paths",
    "find_heights_cut",
    "group_moves_by_look",
    "make_planned_path",
    "shade_colour",
]

Floats = NDArray[np.float64]
# A colour for each tool, in the order in which they move; they begin again after the last.
COLOURS = ("#1f6fb4", "#d1660d", "#2a8f4d", "#8a4fb0", "#c0392b", "#138a8a", "#8a6d1f", "#b8437f")
# Shades of a tool's colour by height: mixed with white above, with black below.
SHADES = 6
LIGHT, DARK = 0.6, 0.45
BAND = "0.13"
# Straight moves shorter than this, page units, are drawn together.
SHORTEST = 0.35
NEAREST = "#d0006f"
NAME, HIGH = 12.0, 17.0
# How much larger than the fixture a plan may become for the sake of what is cut beside the part.
MOST_GROWN = 1.4


@frozen(eq=False)
class PagePaths:
    """The M moves of a program on a page.

    Parameters
    ----------
    start, end : (M, 2) page points, y down.
    bulge : (M,) of the moves in the model frame, where y runs up.
    shown : (M,) whether a move is drawn.
    scale : page units per mm.
    """

    start: Floats
    end: Floats
    bulge: Floats
    shown: NDArray[np.bool_]
    scale: float

    @classmethod
    def from_moves(
        cls, moves: Moves, view: View, pose: Pose | None = None, box: Box | None = None
    ) -> PagePaths:
        """Return the moves in a view.

        Parameters
        ----------
        pose : pose of the part, in whose frame the moves are; None if the view shows the part's frame itself.
        box : page box at which straight moves are cut off, and beyond which arcs are not shown; None for no
            limit.
        """
        ends = []
        for points in (moves.start, moves.end):
            x, y = points[:, 0], points[:, 1]
            if pose is not None:
                x, y = pose.apply(x, y)
            ends.append(np.column_stack([view.left + view.scale * x, view.top - view.scale * y]))
        shown = np.ones(len(moves), dtype=bool)
        if box is not None:
            first, last = clip_to_box(ends[0], ends[1], box)
            middle = compute_path_points(ends[0], ends[1], -moves.bulge, np.full(len(moves), 0.5))
            is_arc = moves.bulge != 0.0
            arc_inside = np.all([are_in_box(points, box) for points in (*ends, middle)], axis=0)
            shown = np.where(is_arc, arc_inside, first <= last)
            start, reach = ends[0].copy(), ends[1] - ends[0]
            cut = np.flatnonzero(shown & ~is_arc & ((first > 0.0) | (last < 1.0)))
            ends[0][cut] = start[cut] + first[cut, None] * reach[cut]
            ends[1][cut] = start[cut] + last[cut, None] * reach[cut]
        return cls(ends[0], ends[1], moves.bulge, shown, view.scale)

    def make_path_data(self, rows: NDArray[np.int64]) -> str:
        """Return SVG path data of the moves with the indices ``rows``; "" for none.

        A move that starts where the previous one ended continues its line.
        """
        rows = rows[self.shown[rows]]
        middle = compute_path_points(
            self.start[rows], self.end[rows], -self.bulge[rows], np.full(len(rows), 0.5)
        )
        found: list[str] = []
        last: list[float] | None = None
        written: list[float] = []
        for one, other, half, bent in zip(
            *(values.tolist() for values in (self.start[rows], self.end[rows], middle, self.bulge[rows])),
            strict=True,
        ):
            if one != last:
                # What was passed over of a line before is its end.
                if last is not None and written != last:
                    found.append(f"L{format_page_point(last)}")
                found.append(f"M{format_page_point(one)}")
                written = one
            last = other
            if not bent:
                if one == other or hypot(other[0] - written[0], other[1] - written[1]) >= SHORTEST:
                    found.append(f"L{format_page_point(other)}")
                    written = other
                continue
            if written != one:
                found.append(f"L{format_page_point(one)}")
            chord = hypot(other[0] - one[0], other[1] - one[1])
            radius = format_number(chord * (1 + bent * bent) / (4 * abs(bent)))
            # Half a turn is drawn in two pieces, of which the direction is clear.
            for place in [other] if 4 * np.arctan(abs(bent)) <= 0.9 * pi else [half, other]:
                found.append(f"A{radius} {radius} 0 0 {0 if bent > 0 else 1} {format_page_point(place)}")
            written = other
        if last is not None and written != last:
            found.append(f"L{format_page_point(last)}")
        return "".join(found)


def format_page_point(point: Sequence[float]) -> str:
    """Return a page point as "x y" for path data."""
    return f"{format_number(point[0])} {format_number(point[1])}"


def are_in_box(points: Floats, box: Box) -> NDArray[np.bool_]:
    """Return (N,) whether page points (N, 2) are inside a box or on its rim."""
    x, y = points.T
    inside: NDArray[np.bool_] = (box.x0 <= x) & (x <= box.x1) & (box.y0 <= y) & (y <= box.y1)
    return inside


def clip_to_box(start: Floats, end: Floats, box: Box) -> tuple[Floats, Floats]:
    """Return (shares (N,), shares (N,)) at which N straight lines enter and leave a box, 0 at the start and 1
    at the end.

    ``start`` and ``end`` are (N, 2). The first share is larger than the second if a line is nowhere inside
    (Y.-D. Liang, B. A. Barsky 1984).
    """
    first, last = np.zeros(len(start)), np.ones(len(start))
    for axis, (low, high) in enumerate(((box.x0, box.x1), (box.y0, box.y1))):
        begin, reach = start[:, axis], end[:, axis] - start[:, axis]
        level = reach == 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (low - begin) / reach, (high - begin) / reach
        outside = level & ((begin < low) | (begin > high))
        first = np.where(level, first, np.maximum(first, np.minimum(one, other)))
        last = np.where(outside, -1.0, np.where(level, last, np.minimum(last, np.maximum(one, other))))
    return first, last


@frozen
class PathStyle:
    """The look of some moves.

    Parameters
    ----------
    kind : "band" as wide as the flute, "rapid" for rapid moves, "cut" for the tool's axis, "dot" for upright
        moves.
    place : index of the tool, in the order in which tools first move; -1 for rapid moves.
    tool : number of the tool; -1 for rapid moves.
    level : level of height, 0 the lowest; -1 if the look does not depend on height.
    """

    kind: str
    place: int = -1
    tool: int = -1
    level: int = -1


def group_moves_by_look(program: Program) -> Iterator[tuple[PathStyle, NDArray[np.int64]]]:
    """Yield (style, move indices) in drawing order: bands tool by tool, rapid moves, then cuts and dots,
    highest level first.
    """
    moves, figures = program.moves, measure_tools(program)
    for place, one in enumerate(figures):
        yield PathStyle("band", place, one.tool), np.flatnonzero((moves.tool == one.tool) & moves.cutting)
    flat = (moves.start[:, :2] != moves.end[:, :2]).any(axis=1)
    yield PathStyle("rapid"), np.flatnonzero(~moves.cutting & flat)
    low, high = find_heights_cut(program)
    middle = (moves.start[:, 2] + moves.end[:, 2]) / 2
    shade = np.clip(((middle - low) / max(high - low, 1e-9) * SHADES).astype(int), 0, SHADES - 1)
    for level in range(SHADES - 1, -1, -1):
        for place, one in enumerate(figures):
            own = (moves.tool == one.tool) & moves.cutting & (shade == level)
            yield PathStyle("cut", place, one.tool, level), np.flatnonzero(own & flat)
            yield PathStyle("dot", place, one.tool, level), np.flatnonzero(own & ~flat)


def draw_paths(group: Scene, program: Program, paths: PagePaths, weight: float = 1.0) -> None:
    """Draw bands as wide as the flutes, rapid moves dashed, and the paths of the tool axes at cutting moves.

    Higher levels are drawn first. Upright cutting moves are dots.
    """
    for look, rows in group_moves_by_look(program):
        colour = COLOURS[look.place % len(COLOURS)]
        match look.kind:
            case "band":
                wide = program.tools[look.tool].diameter * paths.scale
                draw_moves(group, paths, rows, colour, wide, "band", stroke_opacity=BAND)
            case "rapid":
                draw_moves(group, paths, rows, GREY, 1.0 * weight, "rapid", stroke_dasharray="6 5")
            case _:
                wide = (1.8 if look.kind == "cut" else 5.0) * weight
                draw_moves(group, paths, rows, shade_colour(colour, look.level), wide, f"cut-{look.tool}")


def draw_moves(
    group: Scene, paths: PagePaths, rows: NDArray[np.int64], colour: str, wide: float, name: str, **more: str
) -> None:
    """Draw the moves with the indices ``rows`` as one SVG path; nothing where none of them is shown.

    ``wide`` is the line width in page units and ``name`` the class.
    """
    d = paths.make_path_data(rows)
    if d:
        group.add_path(d, colour, wide, stroke_linecap="round", **{"class": name}, **more)


def find_heights_cut(program: Program) -> tuple[float, float]:
    """Return (least, greatest) height in mm of the tool tip over all cutting moves and the program's Z0."""
    cut = program.moves.cutting
    heights = np.concatenate([program.moves.start[cut, 2], program.moves.end[cut, 2], [program.z_zero]])
    return float(heights.min()), float(heights.max())


def shade_colour(colour: str, level: int) -> str:
    """Return a tool's colour "#rrggbb" shaded for a level from 0, the lowest and darkest, to ``SHADES`` - 1.

    >>> shade_colour("#808080", 0), shade_colour("#808080", SHADES - 1)
    ('#464646', '#cccccc')
    """
    share = level / (SHADES - 1)
    parts = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    if share < 0.5:
        mixed = [part * (1 - DARK * (1 - 2 * share)) for part in parts]
    else:
        mixed = [part + (255 - part) * LIGHT * (2 * share - 1) for part in parts]
    return "#" + "".join(f"{int(part):02x}" for part in mixed)


@frozen(eq=False)
class PlannedPath:
    """A program over a fixture on its plan.

    Parameters
    ----------
    program : the machine's program for the part in the fixture.
    fixture : fixture with the pose of the part.
    passing : the nearest approach of its tools to the fixture; None if no tool comes down to it.
    peg_height : height in mm of the highest element of the fixture; None if unknown.
    """

    program: Program
    fixture: Fixture
    passing: ToolClearance | None
    peg_height: float | None = None

    def enlarge_extent(self, extent: Box) -> Box:
        """Return an extent (mm, vise frame) enlarged to contain all cutting moves with their tools.

        Returns it unchanged where that would make it more than ``MOST_GROWN`` times as large.
        """
        program = self.program
        moves, cut = program.moves, program.moves.cutting
        if not cut.any():
            return extent
        low, high = bound_tip(Moves(*(values[cut] for values in astuple(moves, recurse=False))))
        around_path = max(tool.diameter for tool in program.tools.values()) / 2
        xs, ys = self.fixture.pose.apply(
            np.array([low[0], high[0], high[0], low[0]]), np.array([low[1], low[1], high[1], high[1]])
        )
        box = Box(float(xs.min()), float(ys.min()), float(xs.max()), float(ys.max())).grow(around_path)
        union = extent.unite(box)
        small = union.width <= MOST_GROWN * extent.width and union.height <= MOST_GROWN * extent.height
        return union if small else extent

    def find_nearest_place(self) -> tuple[float, float]:
        """Return the point, on the move that comes nearest, that is nearest to the contact passed; in mm in
        the vise frame.

        ``passing`` must not be None.
        """
        assert self.passing is not None
        path, peg = self.passing.path, self.fixture.pegs[self.passing.contact]
        points = np.array([vertex[:2] for vertex in path])
        if len(path) > 1:
            share = np.linspace(0.0, 1.0, 401)
            one, other = (np.tile(points[k], (len(share), 1)) for k in (0, 1))
            points = compute_path_points(one, other, np.full(len(share), path[0][2]), share)
        x, y = self.fixture.pose.apply(points[:, 0], points[:, 1])
        # A wall is below all of the part.
        off = y if peg not in self.fixture.placed else np.hypot(x - peg.x, y - peg.y)
        nearest = int(np.argmin(off))
        return float(x[nearest]), float(y[nearest])

    def draw(self, scene: Scene, view: View, box: Box) -> None:
        """Draw the paths inside a page box, and the nearest move above them."""
        pose = self.fixture.pose
        group = scene.group("paths", view)
        draw_paths(group, self.program, PagePaths.from_moves(self.program.moves, view, pose, box), 0.8)
        if self.passing is None:
            return
        path = self.passing.path
        ends = np.array([[*path[0][:2], 0.0], [*path[-1][:2], 0.0]])
        row = (self.passing.line, self.passing.tool, True, ends[0], ends[1], path[0][2], 0.0, 0.0)
        paths = PagePaths.from_moves(Moves.from_rows([row]), view, pose, box)
        only = np.zeros(1, np.int64)
        wide = 2 * self.passing.radius * view.scale
        draw_moves(group, paths, only, NEAREST, wide, "nearest-band", stroke_opacity="0.16")
        draw_moves(group, paths, only, NEAREST, 2.6, "nearest")
        if are_in_box(np.array([view(self.find_nearest_place())]), box)[0]:
            group.add_circle(
                view(self.find_nearest_place()), 3.6, "#ffffff", NEAREST, 1.8, **{"class": "nearest-place"}
            )

    def describe_nearest_move(self, lengths: LengthUnit) -> str:
        """Return the label of the nearest move, such as "line 54, T2: 12.867 mm"."""
        assert self.passing is not None
        near = self.passing
        return f"line {near.line}, T{near.tool}: {lengths.format_length(near.distance)}"

    def keep_labels_off(self, placer: LabelPlacer, view: View) -> None:
        """Mark the nearest place for the label placer to avoid."""
        if self.passing is not None:
            x, y = view(self.find_nearest_place())
            placer.avoid_box(Box(x, y, x, y).grow(6))

    def make_labels(self, view: View, lengths: LengthUnit) -> list[Label]:
        """Return the label of the nearest move in a list; [] if no tool comes down to the fixture."""
        if self.passing is None:
            return []
        size = (measure_text(self.describe_nearest_move(lengths), NAME, bold=True) + 8, HIGH)
        turns = [2 * pi * k / 24 for k in range(24)]
        gaps = (8, 16, 28, 44, 64, 90)
        return [make_label_around(view(self.find_nearest_place()), -pi / 4, size, gaps, turns, turn_cost=1.0)]

    def draw_name(self, scene: Scene, place: PlacedLabel, lengths: LengthUnit) -> None:
        """Write the label of the nearest move at its place, with a leader."""
        scene.add_line(place.compute_leader(), NEAREST, 1.2)
        scene.add_rectangle(place.box, "#ffffff", NEAREST, 1.2, 3)
        scene.add_text(
            place.box.center, self.describe_nearest_move(lengths), NAME, "middle", bold=True, fill=NEAREST
        )


def make_planned_path(result: Result, index: int) -> PlannedPath | None:
    """Return the program of a result over the fixture with this index, from 0; None if the result has no
    program.
    """
    query = result.query
    if query.program is None:
        return None
    return PlannedPath(query.program, result[index], find_nearest_passing(result, index), query.peg_height)
