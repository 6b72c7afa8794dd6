"""The plan of a fixture with its lettering: hole names, travel, labels of pegs and faces, the part's turn."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import pairwise
from math import copysign, cos, floor, pi, radians, sin
from typing import Literal

from workhold.drawing.annotation import PAST_END, dimension, dimension_box
from workhold.drawing.bench import Bench, draw_bench
from workhold.drawing.carriers import block_arrow, labelled
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.plan_labels import ANGLE_RADIUS, ANGLE_REACH, LONGEST_ARROW, draw_labels
from workhold.drawing.scene import BLACK, GREY, Box, LengthUnit, Scene, View, degrees_text, number, text_width
from workhold.drawing.supports_drawn import PlannedSupports, draw_supports
from workhold.fixels.carrier import column_letters
from workhold.geometry.segment import Point
from workhold.model.shown import ShownCarrier
from workhold.model.workpiece import Workpiece

__all__ = ["BOTTOM", "LEFT", "RIGHT", "TOP", "draw_plan"]

# Room around plates and part for row numbers, column letters, the dimension and captions, page units.
LEFT, TOP, RIGHT, BOTTOM = 48.0, 84.0, 48.0, 82.0
# Of the words of a length to set.
SETTING_SIZE = 17.0
# From the plates to the line of a dimension above them, where columns are named, or beside them, and how much
# farther a second one along the same way is, page units.
ABOVE, BESIDE, FARTHER = 42.0, 33.0, 24.0
RIM_WORD = 10.0
# Of a plan's box, what of its upper and its lower end no path is drawn in.
FREE = (62.0, 30.0)
# Between the names of carriers, page units.
CAPTION_GAP = 16.0
# Size of the names of columns and rows without and with pegs.
NAME_SIZE = (12.0, 14.0)


def draw_plan(
    scene: Scene,
    bench: Bench,
    view: View,
    workpiece: Workpiece,
    bounds: Box,
    lengths: LengthUnit,
    marks: Sequence[tuple[Point, str]] = (),
    angle: str | None = None,
    supports: PlannedSupports | None = None,
    path: PlannedPath | None = None,
) -> None:
    """Draws a bench with its lettering inside a page box, whose lowest 30 page units stay free of labels.

    Parameters
    ----------
    angle : what to write at the part's turn; its size if not given.
    marks : points in the vise frame (mm) to mark, each with its name.
    supports : what stands under the part and presses on it, to draw as well.
    path : of the program's tools, to draw as well.
    """
    frame = view.box(reduce(Box.union, (Box(*point, *point) for point, _ in marks), bench.extent))
    names = draw_hole_names(scene, bench, view, frame, supports)
    draw_bench(scene, bench, view, longest=LONGEST_ARROW)
    if path is not None:
        path.draw(scene, view, Box(bounds.x0, bounds.y0 + FREE[0], bounds.x1, bounds.y1 - FREE[1]))
    if supports is not None:
        draw_supports(scene, supports, view)
    names += draw_travel(scene, bench, view, frame, bounds, lengths)
    names += draw_captions(scene, bench, view, frame, bounds)
    center = view(bench.fixture.pose.apply(*workpiece.center))
    angle_mark(scene, center, bench.fixture.pose.written_deg, ANGLE_RADIUS, ANGLE_REACH)
    marks = [(view(point), name) for point, name in marks]
    angle = f"θ = {degrees_text(bench.fixture.pose.written_deg, 3)}" if angle is None else angle
    draw_labels(scene, bench, view, workpiece, bounds, names, marks, angle, supports, path, lengths)


def draw_hole_names(
    scene: Scene, bench: Bench, view: View, frame: Box, supports: PlannedSupports | None = None
) -> list[Box]:
    """Writes column letters above and below the plates and row numbers beside them, as on a map's rim.

    Where another plate stands there are none. Returns the boxes of the names.
    """
    group, names = scene.group("hole-names"), []
    for shown in bench.shown.carriers:
        plate = view.box(shown.plate)
        also = set() if supports is None else supports.holes_on(shown.carrier.name)
        used_rows = shown.used_rows | {row for _, row in also}
        used_columns = shown.used_columns | {column for column, _ in also}
        rows = [(row, view((0.0, y))[1]) for row, y in shown.named_rows]
        for row, y, used in labelled(rows, used_rows, 15.0):
            rim, inner, way = (
                (frame.x0, plate.x0, -1) if shown.names_at == "left" else (frame.x1, plate.x1, 1)
            )
            ruling(group, (rim, y), (inner, y))
            names.append(((rim + 10 * way, y), str(row + 1), used, "end" if way < 0 else "start"))
        columns = [(column, view((x, 0.0))[0]) for column, x in shown.named_columns]
        rims = (("top", frame.y0, plate.y0, -1), ("bottom", frame.y1, plate.y1, 1))
        for column, x, used in labelled(columns, used_columns, 17.0):
            anchor = inner_anchor(shown, column, bench.fixture.jaw_separation * view.scale)
            for side, rim, inner, way in rims:
                if side not in shown.facing:
                    ruling(group, (x, rim), (x, inner))
                    names.append(((x, rim + 14 * way), column_letters(column), used, anchor))
    boxes = write_names(group, names)
    return boxes + write_rim_words(group, frame, boxes)


def write_names(scene: Scene, names: Sequence[tuple[Point, str, bool, str]]) -> list[Box]:
    """Writes column letters and row numbers; returns their boxes.

    Those of pegs (the third entry is True) come first, and move aside where another name stands. The others
    are written where there is room.
    """
    boxes: list[Box] = []
    for at, name, used, wanted in sorted(names, key=lambda each: not each[2]):
        places = [(at, anchor) for anchor in dict.fromkeys((wanted, "end", "start") if used else (wanted,))]
        for other in boxes if used else []:
            places += [((other.x0 - 3, at[1]), "end"), ((other.x1 + 3, at[1]), "start")]
        placed = [
            (abs(place[0] - at[0]), place, anchor, name_box(place, name, used, anchor))
            for place, anchor in places
        ]
        free = [each for each in placed if all(each[3].grown(1.5).overlap(other) == 0 for other in boxes)]
        if free:
            _, place, anchor, box = min(free, key=lambda each: each[0])
            scene.text(place, name, NAME_SIZE[used], anchor, bold=used, fill=BLACK if used else GREY)
            boxes.append(box)
    return boxes


def write_rim_words(scene: Scene, frame: Box, names: list[Box]) -> list[Box]:
    """Writes "row" and "column" at the left rim where no name stands; returns the boxes of the words."""
    boxes = []
    for word, y in (("row", frame.y0 - 14), ("column", frame.y1 + 14)):
        right = frame.x0 - 5
        box = Box(right - text_width(word, RIM_WORD), y - RIM_WORD / 2, right, y + RIM_WORD / 2)
        if all(box.grown(2.0).overlap(name) == 0 for name in names):
            scene.text((right, y), word, RIM_WORD, "end", fill=GREY)
            boxes.append(box)
    return boxes


def inner_anchor(shown: ShownCarrier, column: int, gap: float) -> str:
    """The anchor of a column's letter: beside the column where plates all but meet, else on it."""
    if gap >= 20:
        return "middle"
    if "right" in shown.facing and column == shown.columns[-1]:
        return "end"
    return "start" if "left" in shown.facing and column == shown.columns[0] else "middle"


def ruling(scene: Scene, rim: Point, plate: Point) -> None:
    """Draws a faint line that leads from a name at the rim to a plate that lies further in."""
    if abs(rim[0] - plate[0]) + abs(rim[1] - plate[1]) > 12:
        scene.line([rim, plate], "#9aa1aa", 0.6, stroke_dasharray="1.5 3")


def name_box(at: Point, name: str, used: bool, anchor: str) -> Box:
    """The box of a column letter or row number."""
    size = NAME_SIZE[used]
    width = text_width(name, size, used)
    left = at[0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
    return Box(left, at[1] - size / 2, left + width, at[1] + size / 2)


def draw_travel(
    scene: Scene, bench: Bench, view: View, frame: Box, bounds: Box, lengths: LengthUnit
) -> list[Box]:
    """Dimensions the lengths to set, above the plates or at their right; returns boxes of words and lines.

    All words are within the bounds. Of two lengths along the same way the second stands farther out.
    """
    group, boxes, lines = scene.group("opening"), [], []
    for place, measured in enumerate(bench.shown.measured):
        upright = measured.is_upright
        out = FARTHER * sum(one.is_upright == upright for one in bench.shown.measured[:place])
        out += BESIDE if upright else ABOVE
        start, end = (
            (frame.x1 + out, y) if upright else (x, frame.y0 - out)
            for x, y in (view(high) for _, high in measured.axes)
        )
        for x, y in (start, end):
            group.line(
                [(frame.x1 + 3, y), (x + 3, y)] if upright else [(x, frame.y0 - 23), (x, y - 3)], BLACK, 0.7
            )
        lines.append((upright, measured.setting, start, end))
    # The words come last: they are read where a line passes below them.
    for upright, setting, start, end in lines:
        words = f"{setting.sign} = {lengths.words(setting.length)}"
        # The upper right corner has room for the words of one length only, and no words may end outside the
        # drawing.
        shared = any(one.is_upright != upright for one in bench.shown.measured)
        room = text_width(words, SETTING_SIZE, bold=True) + PAST_END
        top, bottom = sorted((start[1], end[1]))
        past: Literal["upper", "lower"] | None = "upper"
        if top - room < (frame.y0 if shared else bounds.y0):
            past = "lower" if bottom + room <= bounds.y1 else None
        box = dimension(group, start, end, words, SETTING_SIZE, bold=True, past=past)
        boxes += [box, dimension_box(start, end)]
    return boxes


def draw_captions(scene: Scene, bench: Bench, view: View, frame: Box, bounds: Box) -> list[Box]:
    """Names the carriers below them, with an arrow which way one slides to clamp; returns the boxes.

    Where clamps are drawn, they and the one plate need no names.
    """
    if bench.shown.clamps:
        return []
    group = scene.group("captions")
    boxes: list[Box] = []
    y = frame.y1 + 40
    verb = "closing" if bench.toolkit.clamping > 0 else "opening"
    captions = [
        f"{'fixed' if shown.clamping is None else 'sliding'} {shown.carrier.noun}"
        + (f" ({shown.carrier.letter})" if shown.carrier.letter else "")
        for shown in bench.shown.carriers
    ]
    widths = [text_width(caption, 14) for caption in captions]
    lefts = []
    for shown, width in zip(bench.shown.carriers, widths, strict=True):
        plate = view.box(shown.plate)
        lefts.append(max(plate.x1 - 6 - width, bounds.x0) if "right" in shown.facing else plate.x0 + 6)
    for shown, caption, left, width in zip(
        bench.shown.carriers, captions, side_by_side(lefts, widths, bounds.x1), widths, strict=True
    ):
        group.text((left, y), caption, 14)
        box = Box(left, y - 8, left + width, y + 8)
        if shown.clamping is not None:
            tip = min(left, bounds.x1 - 66 - text_width(verb, 13))
            # An arrow up or down is as high as one to the side is wide.
            drop = 24 if shown.clamping[0] else 46
            block_arrow(group, (tip + 29, y + drop), shown.clamping)
            group.text((tip + 66, y + drop), verb, 13)
            box = box.union(Box(tip, y - 8, tip + 66 + text_width(verb, 13), y + 2 * drop - 10))
        boxes.append(box)
    return boxes


def side_by_side(lefts: Sequence[float], widths: Sequence[float], right: float) -> list[float]:
    """The left ends of pieces of some widths, moved apart and kept left of ``right``.
    >>> side_by_side([0.0, 10.0], [20.0, 20.0], 100.0), side_by_side([50.0, 60.0], [30.0, 30.0], 100.0)
    ([0.0, 36.0], [24.0, 70.0])
    """
    order, placed = sorted(range(len(lefts)), key=lambda k: lefts[k]), list(lefts)
    for before, k in pairwise(order):
        placed[k] = max(placed[k], placed[before] + widths[before] + CAPTION_GAP)
    end = right
    for k in reversed(order):
        placed[k] = min(placed[k], end - widths[k])
        end = placed[k] - CAPTION_GAP
    return placed


def angle_mark(scene: Scene, center: Point, theta_deg: float, radius: float, reach: float) -> None:
    """Draws the turn from the vise's x axis (a dashed line) to the part's (an arrow) around a page point."""
    x, y = center
    theta = radians(theta_deg)
    mark = scene.group("pose")
    mark.line([(x, y), (x + reach, y)], GREY, 1.0, stroke_dasharray="5 3")
    mark.arrow((x, y), (x + reach * cos(theta), y - reach * sin(theta)), GREY, 1.4, 9)
    mark.circle(center, 2.2, GREY)
    if abs(theta) * radius < 10.0:
        return
    way = copysign(1.0, theta)
    end = theta - way * 7.0 / radius  # leave room for the head
    pieces = max(1, floor(abs(end) / (pi / 2)) + 1)
    d = f"M{number(x + radius)} {number(y)}"
    for k in range(1, pieces + 1):
        a = end * k / pieces
        end_x, end_y = number(x + radius * cos(a)), number(y - radius * sin(a))
        d += f"A{number(radius)} {number(radius)} 0 0 {0 if way > 0 else 1} {end_x} {end_y}"
    mark.path(d, GREY, 1.0)
    tip = (x + radius * cos(theta), y - radius * sin(theta))
    mark.arrow_head(tip, -(theta + way * pi / 2) + way * 3.5 / radius, GREY, 7.5)
