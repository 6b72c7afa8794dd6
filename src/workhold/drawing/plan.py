"""The plan of a fixture with its lettering: hole names, travel, labels of pegs and faces, the part's turn.

Labels name pegs by their holes, touched faces by their numbers, and marked points. Each stands where it hides
least of the drawing and of the other labels.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import pairwise
from math import atan2, copysign, cos, dist, floor, pi, radians, sin
from typing import Literal

import numpy as np

from workhold.drawing.annotation import (
    PAST_END,
    Label,
    LabelPlacer,
    PlacedLabel,
    compute_dimension_box,
    draw_dimension,
    join_labels,
    make_label_around,
)
from workhold.drawing.bench import PEG_FILL, BenchDrawing, compute_force_arrow, draw_bench, draw_zero
from workhold.drawing.carriers import avoid_clamp, choose_labelled, draw_block_arrow
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.scene import (
    BLACK,
    GREY,
    Box,
    LengthUnit,
    Scene,
    View,
    format_degrees,
    format_number,
    measure_text,
)
from workhold.drawing.straps_drawn import avoid_straps
from workhold.drawing.supports_drawn import PlannedSupports, draw_supports
from workhold.fixels.carrier import make_column_letters
from workhold.geometry.segment import Arc, Point
from workhold.model.jaw_hold import JawHold
from workhold.model.shown import ShownCarrier, ShownJaws
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece

__all__ = [
    "BOTTOM",
    "LEFT",
    "LONGEST_ARROW",
    "RIGHT",
    "TOP",
    "avoid_drawing",
    "draw_flag",
    "draw_plan",
    "draw_tag",
    "make_face_tag",
    "make_gripped_face_tag",
    "make_peg_label",
]

LONGEST_ARROW = 62.0
LABEL_SIZE, LABEL_HEIGHT = 15.0, 22.0
TAG_SIZE, TAG_HEIGHT = 12.0, 18.0
ANGLE_RADIUS, ANGLE_REACH = 24.0, 48.0
MARK_RADIUS = 5.0
# In denser lattices labels cannot help covering holes.
MOST_HOLES_AVOIDED = 2000


def draw_labels(
    scene: Scene,
    bench: BenchDrawing,
    view: View,
    workpiece: Workpiece,
    bounds: Box,
    names: list[Box],
    marks: Sequence[tuple[Point, str]],
    angle: str,
    supports: PlannedSupports | None,
    path: PlannedPath | None,
    lengths: LengthUnit,
) -> None:
    """Draw the labels of pegs (hole names), touched faces (numbers), marked page points, and the part's turn.

    ``names`` are boxes of lettering that labels keep off. ``marks`` holds (page point, name). ``angle`` is
    written at the part's turn.
    """
    center = view(bench.fixture.pose.apply(*workpiece.center))
    placer = LabelPlacer(Box(bounds.x0, bounds.y0 + 62, bounds.x1, bounds.y1 - 30))
    avoid_drawing(placer, bench, view)
    avoid_turn(placer, bench, center)
    for box in names:
        placer.avoid_box(box)
    for (x, y), _ in marks:
        placer.avoid_box(Box(x, y, x, y).grow(MARK_RADIUS))
    if supports is not None:
        supports.keep_labels_off(placer, view)
    if path is not None:
        path.keep_labels_off(placer, view)
    pegs = bench.fixture.pegs
    numbers = list(dict.fromkeys(pegs[index].face for index in bench.touching))
    gripped = list(bench.gripped)
    direction, angle_size = -radians(bench.fixture.pose.written_deg) / 2, (measure_text(angle, 13) + 4, 16.0)
    placed = placer.place(
        [
            *(make_peg_label(bench, index, view) for index in bench.placed),
            *(make_face_tag(bench, face, view) for face in numbers),
            *(make_gripped_face_tag(bench, face, view) for face in gripped),
            make_label_around(
                center, direction, angle_size, (26, 32, 40, 50, 64), list_turns_around(24), turn_cost=4
            ),
            *(make_mark_label(point, name) for point, name in marks),
            *([] if path is None else path.make_labels(view, lengths)),
            *([] if supports is None else supports.make_labels(view)),
        ]
    )
    group, places = scene.group("labels"), iter(placed)
    for index in bench.placed:
        draw_flag(group, next(places), bench.get_page_radius(view, index), pegs[index].hole)
    for face in (*numbers, *gripped):
        draw_tag(group, next(places), str(face))
    group.add_text(next(places).box.center, angle, 13, "middle", fill=GREY, halo=3)
    for _, name in marks:
        draw_mark(group, next(places), name)
    if path is not None and path.passing is not None:
        path.draw_name(group, next(places), lengths)
    if supports is not None:
        supports.draw_names(group, list(places), view)


def avoid_drawing(placer: LabelPlacer, bench: BenchDrawing, view: View) -> None:
    """Mark everything drawn of a bench for the label placer to avoid."""
    for outline in bench.sample_outlines(view, 4.0):
        placer.avoid_ink(outline, 3.0)
        placer.avoid_crossing(outline[::3])
    for index, peg in enumerate(bench.fixture.pegs):
        (x, y), radius = view((peg.x, peg.y)), bench.get_page_radius(view, index)
        placer.avoid_box(Box(x - radius, y - radius, x + radius, y + radius))
        placer.avoid_line(*compute_force_arrow(bench, index, view, LONGEST_ARROW), price=8.0)
    for low, high in (axis for measured in bench.shown.measured for axis in measured.axes):
        placer.avoid_line(view(low), view(high), 0.5)
    for clamp in bench.shown.clamps:
        avoid_clamp(placer, clamp, view)
    for wall in bench.shown.walls:
        placer.avoid_box(view.map_box(wall.bar))
    if isinstance(bench.fixture.hold, StrappedHold):
        avoid_straps(placer, bench.fixture.hold, bench.toolkit, view)
    if bench.shown.jaws is not None:
        for bar in (bench.shown.jaws.fixed, bench.shown.jaws.moving):
            placer.avoid_box(view.map_box(bar))
    for shown in bench.shown.carriers:
        if len(shown.columns) * len(shown.rows) < MOST_HOLES_AVOIDED:
            placer.avoid_ink([view(hole.center) for hole in shown.list_holes()], 2.0)


def avoid_turn(placer: LabelPlacer, bench: BenchDrawing, center: Point) -> None:
    """Mark the area in which the part's turn is drawn, around a page point, for the label placer to avoid."""
    turn = radians(bench.fixture.pose.written_deg)
    x, y = center
    placer.avoid_line(center, (x + ANGLE_REACH * cos(turn), y - ANGLE_REACH * sin(turn)), 8.0)
    placer.avoid_line(center, (x + ANGLE_REACH, y), 8.0)
    arc = np.linspace(0.0, turn, 24)
    placer.avoid_ink(np.column_stack([x + ANGLE_RADIUS * np.cos(arc), y - ANGLE_RADIUS * np.sin(arc)]), 3.0)


def list_turns_around(count: int) -> list[float]:
    """Return ``count`` equally spaced angles in radians, above -pi up to pi, sorted by size with 0 first."""
    turns = [2 * pi * k / count for k in range(-count // 2 + 1, count // 2 + 1)]
    return sorted(turns, key=lambda turn: (abs(turn), turn))


def make_peg_label(bench: BenchDrawing, index: int, view: View) -> Label:
    """Return the label of a peg's hole name, with its candidate places.

    The cheapest are close to the peg, on the side away from the part. A clamp's label stands at the clamp's
    hole.
    """
    peg = bench.fixture.pegs[index]
    nx, ny = bench.contacts[index][1]
    size = (measure_text(peg.hole, LABEL_SIZE, bold=True) + 12, LABEL_HEIGHT)
    distances = [bench.get_page_radius(view, index) + gap for gap in (5, 14, 26, 42, 64, 90)]
    at = next((clamp.back for clamp in bench.shown.clamps if clamp.tip == peg), (peg.x, peg.y))
    return make_label_around(view(at), atan2(-ny, nx), size, distances, list_turns_around(24))


def make_mark_label(point: Point, name: str) -> Label:
    """Return the label of a marked page point, in all directions around it."""
    size = (measure_text(name, TAG_SIZE) + 6, TAG_SIZE + 4)
    distances = [MARK_RADIUS + gap for gap in (3, 10, 20, 34, 52, 76, 110)]
    return make_label_around(point, pi / 4, size, distances, list_turns_around(24), turn_cost=2)


def make_face_tag(bench: BenchDrawing, face_number: int, view: View) -> Label:
    """Return the label of a touched face's number. Places for it are inside the part, and cost least beside
    the face's contacts.
    """
    index = next(k for k in bench.touching if bench.fixture.pegs[k].face == face_number)
    face = bench.faces[index]
    size = (max(TAG_HEIGHT, measure_text(str(face_number), TAG_SIZE) + 8), TAG_HEIGHT)
    half = face.half_extent
    near = face.find_parameter(bench.contacts[index][0])
    labels = []
    for parameter in (share * half for share in (-0.85, -0.6, -0.35, 0.0, 0.35, 0.6, 0.85)):
        nx, ny = face.compute_normal(parameter)
        extra = 4 * abs(parameter - near) / half
        labels.append(
            make_label_around(
                view(face.compute_point(parameter)),
                atan2(ny, -nx),
                size,
                (7, 14, 24, 40, 60),
                list_turns_around(8),
                extra,
            )
        )
    return join_labels(labels)


def make_gripped_face_tag(bench: BenchDrawing, face_number: int, view: View) -> Label:
    """Return the label with the number of a face that a flat jaw touches.

    It is best placed inside the part, beside the middle of the face; places farther off cost more.
    """
    face = bench.gripped[face_number]
    hold = bench.fixture.hold
    assert isinstance(hold, JawHold)
    is_below = face_number in hold.fixed.segments
    x = face.center[0] if isinstance(face, Arc) else face.middle[0]
    y, turn = (0.0, -pi / 2) if is_below else (hold.opening, pi / 2)
    size = (max(TAG_HEIGHT, measure_text(str(face_number), TAG_SIZE) + 8), TAG_HEIGHT)
    return make_label_around(view((x, y)), turn, size, (9, 16, 26, 42, 60), list_turns_around(8))


def draw_flag(scene: Scene, place: PlacedLabel, radius: float, name: str) -> None:
    """Write a peg's hole name at its place, with a leader that ends at the rim of the peg, ``radius`` page
    units from its centre.
    """
    leader = place.compute_leader(radius)
    if dist(*leader) > 2:
        scene.add_line(leader, PEG_FILL, 1.4)
    scene.add_rectangle(place.box, "#ffffff", PEG_FILL, 1.4, 4)
    scene.add_text(place.box.center, name, LABEL_SIZE, "middle", bold=True)


def draw_mark(scene: Scene, place: PlacedLabel, name: str) -> None:
    """Draw the sign of a zero point at a mark's anchor, with its name at its place."""
    scene.add_line(place.compute_leader(), BLACK, 0.8)
    draw_zero(scene, place.anchor, MARK_RADIUS)
    scene.add_text(place.box.center, name, TAG_SIZE, "middle", halo=2.5)


def draw_tag(scene: Scene, place: PlacedLabel, name: str) -> None:
    """Write a face's number at its place, with a leader."""
    scene.add_line(place.compute_leader(), BLACK, 0.8)
    scene.add_rectangle(place.box, "#ffffff", BLACK, 0.9, TAG_HEIGHT / 2)
    scene.add_text(place.box.center, name, TAG_SIZE, "middle")


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
    bench: BenchDrawing,
    view: View,
    workpiece: Workpiece,
    bounds: Box,
    lengths: LengthUnit,
    marks: Sequence[tuple[Point, str]] = (),
    angle: str | None = None,
    supports: PlannedSupports | None = None,
    path: PlannedPath | None = None,
) -> None:
    """Draw a bench with its lettering inside a page box, whose lowest 30 page units stay free of labels.

    Parameters
    ----------
    marks : (point in the vise frame in mm, name) of each point to mark.
    angle : words at the part's turn; None writes the size of the turn.
    supports : supports and the clamp on top, to draw as well.
    path : the paths of the program's tools, to draw as well.
    """
    frame = view.map_box(reduce(Box.unite, (Box(*point, *point) for point, _ in marks), bench.extent))
    names = draw_hole_names(scene, bench, view, frame, supports)
    draw_bench(scene, bench, view, longest=LONGEST_ARROW)
    if path is not None:
        path.draw(scene, view, Box(bounds.x0, bounds.y0 + FREE[0], bounds.x1, bounds.y1 - FREE[1]))
    if supports is not None:
        draw_supports(scene, supports, view)
    names += draw_travel(scene, bench, view, frame, bounds, lengths)
    names += draw_captions(scene, bench, view, frame, bounds)
    center = view(bench.fixture.pose.apply(*workpiece.center))
    draw_angle_mark(scene, center, bench.fixture.pose.written_deg, ANGLE_RADIUS, ANGLE_REACH)
    marks = [(view(point), name) for point, name in marks]
    angle = f"θ = {format_degrees(bench.fixture.pose.written_deg, 3)}" if angle is None else angle
    draw_labels(scene, bench, view, workpiece, bounds, names, marks, angle, supports, path, lengths)


def draw_hole_names(
    scene: Scene, bench: BenchDrawing, view: View, frame: Box, supports: PlannedSupports | None = None
) -> list[Box]:
    """Write column letters above and below the plates and row numbers beside
    them; return the boxes of the names.

    ``frame`` is the page box of plates and part. Nothing is written on a side with another plate.
    """
    group, names = scene.group("hole-names"), []
    if not bench.shown.carriers:
        return []
    for shown in bench.shown.carriers:
        plate = view.map_box(shown.plate)
        also = set() if supports is None else supports.list_holes_on(shown.carrier.name)
        used_rows = shown.used_rows | {row for _, row in also}
        used_columns = shown.used_columns | {column for column, _ in also}
        rows = [(row, view((0.0, y))[1]) for row, y in shown.named_rows]
        for row, y, used in choose_labelled(rows, used_rows, 15.0):
            rim, inner, way = (
                (frame.x0, plate.x0, -1) if shown.names_at == "left" else (frame.x1, plate.x1, 1)
            )
            draw_ruling(group, (rim, y), (inner, y))
            names.append(((rim + 10 * way, y), str(row + 1), used, "end" if way < 0 else "start"))
        columns = [(column, view((x, 0.0))[0]) for column, x in shown.named_columns]
        rims = (("top", frame.y0, plate.y0, -1), ("bottom", frame.y1, plate.y1, 1))
        for column, x, used in choose_labelled(columns, used_columns, 17.0):
            anchor = choose_letter_anchor(shown, column, bench.fixture.travel * view.scale)
            for side, rim, inner, way in rims:
                if side not in shown.facing:
                    draw_ruling(group, (x, rim), (x, inner))
                    names.append(((x, rim + 14 * way), make_column_letters(column), used, anchor))
    boxes = write_names(group, names)
    return boxes + write_rim_words(group, frame, boxes)


def write_names(scene: Scene, names: Sequence[tuple[Point, str, bool, str]]) -> list[Box]:
    """Write column letters and row numbers; return their page boxes.

    ``names`` holds (page point, name, has a peg, SVG anchor). Names with pegs are written first, and moved
    aside from other names. The others are left out if there is no room.
    """
    boxes: list[Box] = []
    for at, name, used, wanted in sorted(names, key=lambda each: not each[2]):
        places = [(at, anchor) for anchor in dict.fromkeys((wanted, "end", "start") if used else (wanted,))]
        for other in boxes if used else []:
            places += [((other.x0 - 3, at[1]), "end"), ((other.x1 + 3, at[1]), "start")]
        placed = [
            (abs(place[0] - at[0]), place, anchor, compute_name_box(place, name, used, anchor))
            for place, anchor in places
        ]
        free = [
            each
            for each in placed
            if all(each[3].grow(1.5).compute_overlap_area(other) == 0 for other in boxes)
        ]
        if free:
            _, place, anchor, box = min(free, key=lambda each: each[0])
            scene.add_text(place, name, NAME_SIZE[used], anchor, bold=used, fill=BLACK if used else GREY)
            boxes.append(box)
    return boxes


def write_rim_words(scene: Scene, frame: Box, names: list[Box]) -> list[Box]:
    """Write "row" and "column" at the left rim of the frame; return the boxes of the words.

    A word is left out if one of ``names`` is in its place.
    """
    boxes = []
    for word, y in (("row", frame.y0 - 14), ("column", frame.y1 + 14)):
        right = frame.x0 - 5
        box = Box(right - measure_text(word, RIM_WORD), y - RIM_WORD / 2, right, y + RIM_WORD / 2)
        if all(box.grow(2.0).compute_overlap_area(name) == 0 for name in names):
            scene.add_text((right, y), word, RIM_WORD, "end", fill=GREY)
            boxes.append(box)
    return boxes


def choose_letter_anchor(shown: ShownCarrier, column: int, gap: float) -> str:
    """Return the SVG anchor of a column's letter: "start", "middle" or "end".

    It is "middle" but at the columns beside a gap between plates that is narrower than 20 page units: there
    the letter is moved away from the gap. ``gap`` is the distance between the plates in page units.
    """
    if gap >= 20:
        return "middle"
    if "right" in shown.facing and column == shown.columns[-1]:
        return "end"
    return "start" if "left" in shown.facing and column == shown.columns[0] else "middle"


def draw_ruling(scene: Scene, rim: Point, plate: Point) -> None:
    """Draw a faint dotted line from a name at the rim to its plate, if they
    are more than 12 page units apart.
    """
    if abs(rim[0] - plate[0]) + abs(rim[1] - plate[1]) > 12:
        scene.add_line([rim, plate], "#9aa1aa", 0.6, stroke_dasharray="1.5 3")


def compute_name_box(at: Point, name: str, used: bool, anchor: str) -> Box:
    """Return the page box of a column letter or row number; ``used`` tells whether a peg stands there."""
    size = NAME_SIZE[used]
    width = measure_text(name, size, used)
    left = at[0] - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
    return Box(left, at[1] - size / 2, left + width, at[1] + size / 2)


def draw_travel(
    scene: Scene, bench: BenchDrawing, view: View, frame: Box, bounds: Box, lengths: LengthUnit
) -> list[Box]:
    """Draw the lengths to set as dimensions, above the plates or at their right; return the boxes of words
    and lines.

    All words are within ``bounds``. The second of two lengths in the same direction is drawn farther out.
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
            group.add_line(
                [(frame.x1 + 3, y), (x + 3, y)] if upright else [(x, frame.y0 - 23), (x, y - 3)], BLACK, 0.7
            )
        lines.append((upright, measured.setting, start, end))
    # The words come last: they are read where a line passes below them.
    for upright, setting, start, end in lines:
        words = f"{setting.sign} = {lengths.format_length(setting.length)}"
        # The upper right corner has room for the words of one length only, and no words may end outside the
        # drawing.
        shared = any(one.is_upright != upright for one in bench.shown.measured)
        room = measure_text(words, SETTING_SIZE, bold=True) + PAST_END
        top, bottom = sorted((start[1], end[1]))
        past: Literal["upper", "lower"] | None = "upper"
        if top - room < (frame.y0 if shared else bounds.y0):
            past = "lower" if bottom + room <= bounds.y1 else None
        box = draw_dimension(group, start, end, words, SETTING_SIZE, bold=True, past=past)
        boxes += [box, compute_dimension_box(start, end)]
    return boxes


def draw_captions(scene: Scene, bench: BenchDrawing, view: View, frame: Box, bounds: Box) -> list[Box]:
    """Write the names of the carriers below them, with an arrow in the direction of closing; return their
    boxes.

    Writes nothing and returns [] where clamps are drawn.
    """
    if bench.shown.clamps:
        return []
    if bench.shown.jaws is not None:
        return draw_jaw_captions(scene.group("captions"), bench.shown.jaws, view)
    group = scene.group("captions")
    boxes: list[Box] = []
    y = frame.y1 + 40
    verb = "closing" if bench.toolkit.clamping > 0 else "opening"
    captions = [
        f"{'fixed' if shown.clamping is None else 'sliding'} {shown.carrier.noun}"
        + (f" ({shown.carrier.letter})" if shown.carrier.letter else "")
        for shown in bench.shown.carriers
    ]
    widths = [measure_text(caption, 14) for caption in captions]
    lefts = []
    for shown, width in zip(bench.shown.carriers, widths, strict=True):
        plate = view.map_box(shown.plate)
        lefts.append(max(plate.x1 - 6 - width, bounds.x0) if "right" in shown.facing else plate.x0 + 6)
    for shown, caption, left, width in zip(
        bench.shown.carriers, captions, place_side_by_side(lefts, widths, bounds.x1), widths, strict=True
    ):
        group.add_text((left, y), caption, 14)
        box = Box(left, y - 8, left + width, y + 8)
        if shown.clamping is not None:
            tip = min(left, bounds.x1 - 66 - measure_text(verb, 13))
            # An arrow up or down is as high as one to the side is wide.
            drop = 24 if shown.clamping[0] else 46
            draw_block_arrow(group, (tip + 29, y + drop), shown.clamping)
            group.add_text((tip + 66, y + drop), verb, 13)
            box = box.unite(Box(tip, y - 8, tip + 66 + measure_text(verb, 13), y + 2 * drop - 10))
        boxes.append(box)
    return boxes


def draw_jaw_captions(scene: Scene, jaws: ShownJaws, view: View) -> list[Box]:
    """Write the names of two flat jaws and a work stop, with an arrow in the
    direction of closing; return their boxes.
    """
    boxes = list[Box]()
    for name, bar in (("fixed jaw", jaws.fixed), ("moving jaw", jaws.moving)):
        page = view.map_box(bar)
        size = min(15.0, 0.6 * page.height)
        middle = (page.x0 + page.x1) / 2, (page.y0 + page.y1) / 2
        scene.add_text(middle, name, size, "middle")
        boxes.append(Box.from_center(middle, measure_text(name, size), size))
    page = view.map_box(jaws.moving)
    tip = page.x1 - 40, (page.y0 + page.y1) / 2
    draw_block_arrow(scene, tip, (0.0, -1.0), 0.7)
    boxes.append(Box.from_center(tip, 40, 60))
    if jaws.stop is not None:
        page = view.map_box(jaws.stop)
        at = (page.x0 + page.x1) / 2, page.y0 - 10
        scene.add_text(at, "work stop", 12, "middle", halo=3)
        boxes.append(Box.from_center(at, measure_text("work stop", 12), 12))
        boxes.append(page)
    return boxes


def place_side_by_side(lefts: Sequence[float], widths: Sequence[float], right: float) -> list[float]:
    """Return the left ends of pieces of these widths, moved so that ``CAPTION_GAP`` is free between them.

    ``lefts`` are the wanted left ends. All pieces end left of ``right``.

    >>> place_side_by_side([0.0, 10.0], [20.0, 20.0], 100.0)
    [0.0, 36.0]
    >>> place_side_by_side([50.0, 60.0], [30.0, 30.0], 100.0)
    [24.0, 70.0]
    """
    order, placed = sorted(range(len(lefts)), key=lambda k: lefts[k]), list(lefts)
    for before, k in pairwise(order):
        placed[k] = max(placed[k], placed[before] + widths[before] + CAPTION_GAP)
    end = right
    for k in reversed(order):
        placed[k] = min(placed[k], end - widths[k])
        end = placed[k] - CAPTION_GAP
    return placed


def draw_angle_mark(scene: Scene, center: Point, theta_deg: float, radius: float, reach: float) -> None:
    """Draw the part's turn about a page point: from the vise's x axis (a dashed line) to the part's x axis
    (an arrow).

    ``radius`` of the arc and ``reach`` of the axes are in page units.
    """
    x, y = center
    theta = radians(theta_deg)
    mark = scene.group("pose")
    mark.add_line([(x, y), (x + reach, y)], GREY, 1.0, stroke_dasharray="5 3")
    mark.add_arrow((x, y), (x + reach * cos(theta), y - reach * sin(theta)), GREY, 1.4, 9)
    mark.add_circle(center, 2.2, GREY)
    if abs(theta) * radius < 10.0:
        return
    way = copysign(1.0, theta)
    end = theta - way * 7.0 / radius  # leave room for the head
    pieces = max(1, floor(abs(end) / (pi / 2)) + 1)
    d = f"M{format_number(x + radius)} {format_number(y)}"
    for k in range(1, pieces + 1):
        a = end * k / pieces
        end_x, end_y = format_number(x + radius * cos(a)), format_number(y - radius * sin(a))
        d += f"A{format_number(radius)} {format_number(radius)} 0 0 {0 if way > 0 else 1} {end_x} {end_y}"
    mark.add_path(d, GREY, 1.0)
    tip = (x + radius * cos(theta), y - radius * sin(theta))
    mark.add_arrow_head(tip, -(theta + way * pi / 2) + way * 3.5 / radius, GREY, 7.5)
