"""A fixture as the page shows it: it is zoomed, pushed and closed, and its lettering keeps its size meanwhile.

A group of the class ``kept`` keeps its size about a point of the page, ``data-at``, along both axes or those that
``data-axes`` names. What moves stands in groups of its own, see ``presenting.moving_picture``; an element of
the class ``stretches`` is a line whose second end moves alone. ``data-peg`` is the number of a peg, and an empty
group of the class ``over-part`` has room for what else lies between part and pegs.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from functools import reduce
from math import atan2, ceil, dist

from attrs import evolve

from workhold.conventions import AGREEMENT
from workhold.drawing.annotation import LabelPlacer
from workhold.drawing.bench import (
    ARROW,
    PART_FILL,
    PEG_FILL,
    RAW_FILL,
    TOUCHED,
    BenchDrawing,
    compute_force_arrow,
    find_face,
)
from workhold.drawing.plan import (
    LONGEST_ARROW,
    avoid_drawing,
    draw_flag,
    draw_tag,
    make_face_tag,
    make_gripped_face_tag,
    make_peg_label,
)
from workhold.drawing.scene import BLACK, GREY, Box, LengthUnit, Scene, View, format_number, measure_text
from workhold.fixels.carrier import make_column_letters
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Line, Point, Segment, compute_bounding_box
from workhold.model.clamps import ShownClamp
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.shown import ShownLength, ShownSetUp
from workhold.model.workpiece import Workpiece
from workhold.presenting.moving_picture import (
    add_moving_group,
    draw_ground,
    draw_peg,
    find_clamping_directions,
    measure_draw_back,
)

__all__ = ["draw_small_picture", "draw_zoomable_picture"]

# Room around the drawing for names, dimensions and arrows, page units: left, top, right, bottom; in a picture
# narrower than so much there is less.
RIM, NARROW_RIM, NARROW = (60.0, 72.0, 60.0, 56.0), (40.0, 66.0, 40.0, 46.0), 600.0
# Size of the names of columns and rows, how far they stand off their plates, and the least room for one.
AXIS_NAME, OFF_COLUMN, OFF_ROW, COLUMN_ROOM, ROW_ROOM = 14.0, 12.0, 10.0, 25.0, 20.0
# Of the words of a length to set; how far its line is from the drawing, above and at the right, and the next one
# along the same way from it.
SETTING, ABOVE, BESIDE, FARTHER, HEAD = 15.0, 34.0, 18.0, 32.0, 10.0
# Of a contact that has no peg.
DOT = 5.0


def add_fixed_size_group(scene: Scene, at: Point, axes: str = "xy", **attributes: str) -> Scene:
    """Add a group that keeps its size about a page point when the picture is zoomed along ``axes``."""
    return scene.group(
        "kept",
        None,
        data_at=f"{format_number(at[0])} {format_number(at[1])}",
        data_axes=axes,
        **attributes,
    )


def draw_zoomable_picture(
    bench: BenchDrawing, title: str, size: tuple[float, float], placed: Sequence[float] = (0.0, 0.0)
) -> str:
    """Return a fixture drawn for a frame of ``size`` (width, height) in page units.

    ``placed`` is the shift in mm from where the fixture is listed to where it is drawn. The picture has three
    attributes: ``data-model-to-page``, the map to the page from mm in the frame in which the fixture is
    listed; ``data-extent``, a box in mm of that frame; ``data-rim``, in page units.

    Returns
    -------
    str
        SVG text.
    """
    bench = evolve(bench, shown=hide_unreached_clamps(bench.shown))
    extent, page = bench.extent, Box(0.0, 0.0, *size)
    left, top, right, bottom = rim = NARROW_RIM if size[0] < NARROW else RIM
    view = View.fit_box(
        extent, Box(left, top, max(size[0] - right, left + 40), max(size[1] - bottom, top + 40))
    )
    scene = Scene.make_page(size, title)
    (dx, dy), scale = placed, view.scale
    scene.element.set("data-model-to-page", View(scale, view.left + scale * dx, view.top - scale * dy).matrix)
    ends = (extent.x0 - dx, extent.y0 - dy, extent.x1 - dx, extent.y1 - dy)
    scene.element.set("data-extent", " ".join(map(format_number, ends)))
    scene.element.set("data-rim", " ".join(map(format_number, rim)))
    draw_ground(scene, bench, view)
    scene.group("over-part")
    draw_forces(scene, bench, view)
    ways = find_clamping_directions(bench)
    for index, peg in enumerate(bench.fixture.pegs):
        group = add_moving_group(scene, view, ways.get(peg.carrier), data_peg=str(index))
        if index in bench.placed:
            draw_peg(group, bench, view, index)
        else:
            group.add_circle(view((peg.x, peg.y)), DOT, PEG_FILL, BLACK, 1.2, **{"class": "peg"})
    taken = name_holes(scene, bench, view)
    for place, measured in enumerate(bench.shown.measured):
        taken.append(draw_travel(scene, bench, view, page, place, measured))
    draw_labels(scene, bench, view, page, taken, ways)
    return ET.tostring(scene.element, encoding="unicode")


def hide_unreached_clamps(seen: ShownSetUp) -> ShownSetUp:
    """Return the visible parts with only the line of each clamp that cannot reach its tip from its hole.

    Such a clamp has no length to set. It occurs where four contacts are shown that are not a fixture.
    """
    lost = {clamp.tip for clamp in seen.clamps if not is_reached(clamp)}
    clamps = tuple(evolve(clamp, hole=None) if clamp.tip in lost else clamp for clamp in seen.clamps)
    return evolve(
        seen, clamps=clamps, measured=tuple(one for one in seen.measured if one.setting.tip not in lost)
    )


def is_reached(clamp: ShownClamp) -> bool:
    """Return whether a clamp can reach its tip from its hole within its stroke; True where hole or stroke is
    unknown.
    """
    back, travel = measure_draw_back(clamp), clamp.carrier.travel
    if back is None or travel is None or travel.most is None:
        return True
    return -AGREEMENT <= back <= travel.most - travel.least + AGREEMENT


def draw_forces(scene: Scene, bench: BenchDrawing, view: View) -> None:
    """Draw the force of each contact as an arrow whose size does not change by zooming."""
    forces = scene.group("forces")
    # Under straps nothing is known of the locators' forces.
    for index in range(len(bench.fixture.pegs) if bench.fixture.hold is None else 0):
        tail, tip = compute_force_arrow(bench, index, view, LONGEST_ARROW)
        group = add_fixed_size_group(forces, tail)
        group.add_arrow(tail, tip, "#ffffff", 5.0, 14)
        group.add_arrow(tail, tip, ARROW, 2.4, 12)


def name_holes(scene: Scene, bench: BenchDrawing, view: View) -> list[Box]:
    """Write the names of columns and rows beside their plates; return the boxes of the names visible without
    zoom.

    Names without pegs have the attribute ``data-step``: without zoom only every so many of them have room.
    """
    boxes = []
    for shown in bench.shown.carriers:
        group, plate = add_moving_group(scene, view, shown.clamping), view.map_box(shown.plate)
        x, way, anchor = (plate.x1, 1, "start") if shown.names_at == "right" else (plate.x0, -1, "end")
        pitches = (view.scale * pitch for pitch in shown.carrier.pitch)
        column_step, row_step = (
            room / pitch for room, pitch in zip((COLUMN_ROOM, ROW_ROOM), pitches, strict=True)
        )
        names = [
            (
                (view((at, 0.0))[0], plate.y0),
                (0.0, -OFF_COLUMN),
                column,
                make_column_letters(column),
                "middle",
                column_step,
            )
            for column, at in shown.named_columns
        ] + [
            ((x, view((0.0, at))[1]), (way * OFF_ROW, 0.0), row + 1, str(row + 1), anchor, row_step)
            for row, at in shown.named_rows
        ]
        used = {*map(make_column_letters, shown.used_columns), *(str(row + 1) for row in shown.used_rows)}
        for at, off, count, name, end, step in names:
            bold = name in used
            told = {} if bold else {"data_number": str(count), "data_step": format_number(step)}
            place = (at[0] + off[0], at[1] + off[1])
            text = add_fixed_size_group(group, at, **told).add_text(
                place, name, AXIS_NAME, end, bold, BLACK if bold else GREY
            )
            text.set("class", "axis-name used" if bold else "axis-name")
            if bold or count % max(1, ceil(step)) == 0:
                wide = measure_text(name, AXIS_NAME, bold)
                middle = place[0] + {"middle": 0.0, "start": wide / 2, "end": -wide / 2}[end]
                boxes.append(Box.from_center((middle, place[1]), wide, AXIS_NAME))
    return boxes


def draw_travel(
    scene: Scene, bench: BenchDrawing, view: View, page: Box, place: int, measured: ShownLength
) -> Box:
    """Draw a length to set as a dimension above the drawing or at its right; return the box of its words.

    ``place`` is the length's index, from 0, among the lengths shown.
    """
    upright, frame, others = measured.is_upright, view.map_box(bench.extent), bench.shown.measured
    nearer = sum(one.is_upright == upright for one in others[:place])
    line = frame.x1 + BESIDE + FARTHER * nearer if upright else frame.y0 - ABOVE - FARTHER * nearer
    start, end = (view(high) for _, high in measured.axes)
    start, end = ((line, start[1]), (line, end[1])) if upright else ((start[0], line), (end[0], line))
    clamping = find_clamping_directions(bench).get(measured.setting.carrier.name)
    # The distance of the line from the drawing keeps its size, its length does not.
    outer, along = ("x", "y") if upright else ("y", "x")
    group = add_fixed_size_group(scene.group("travel"), (frame.x1, frame.y0), outer)
    stretched = add_moving_group(group, view, clamping).add_line([start, end], GREY, 1.0)
    stretched.set("class", "stretches")
    for point, other, moves in ((start, end, None), (end, start, clamping)):
        tip = add_fixed_size_group(add_moving_group(group, view, moves), point, along)
        x, y = point
        tip.add_line([(x - 6, y), (x + 14, y)] if upright else [(x, y - 6), (x, y + 14)], GREY, 1.0)
        tip.add_arrow_head(point, atan2(point[1] - other[1], point[0] - other[0]), GREY, HEAD)
    words = f"{measured.setting.sign} = {LengthUnit.in_mm().format_length(measured.setting.length)}"
    wide = measure_text(words, SETTING, bold=True) + 8
    tight = upright or dist(start, end) < wide + 30
    (x, y), half = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), wide / 2
    # Words stay in the picture, and off those that run upward beside them.
    beside = tight and any(one.is_upright for one in others)
    if upright:
        x, y = x + 15, max(half, min(y, page.y1 - half))
    else:
        x, y = max(half, min(x, (frame.x1 + 12 if beside else page.x1) - half)), y - 15 * tight
    half_way = None if clamping is None else (clamping[0] / 2, clamping[1] / 2)
    inner = add_fixed_size_group(add_moving_group(group, view, half_way), (x, y), along)
    text = inner.add_text((x, y), words, SETTING, "middle", True, halo=4.0, turned=90.0 if upright else 0.0)
    text.set("class", "dimension-text")
    text.set("data-sign", measured.setting.sign)
    text.set("data-length", repr(float(measured.setting.length)))
    return Box.from_center((x, y), *((SETTING, wide) if upright else (wide, SETTING)))


def draw_labels(
    scene: Scene,
    bench: BenchDrawing,
    view: View,
    page: Box,
    taken: Sequence[Box],
    ways: dict[str, Point | None],
) -> None:
    """Write the hole names of pegs and the numbers of touched faces where they hide least.

    ``taken`` are page boxes to keep off. ``ways`` holds by carrier name the direction in which the carrier
    clamps, None for a carrier that stands still.
    """
    placer = LabelPlacer(page.grow(-1.0))
    avoid_drawing(placer, bench, view)
    for box in taken:
        placer.avoid_box(box)
    pegs = bench.fixture.pegs
    numbers = list(dict.fromkeys(pegs[index].face for index in bench.touching))
    labels = [make_peg_label(bench, index, view) for index in range(len(pegs))]
    tags = [make_face_tag(bench, face, view) for face in numbers]
    tags += [make_gripped_face_tag(bench, face, view) for face in bench.gripped]
    places = iter(placer.place([*labels, *tags]))
    # A clamp is named at its hole, which stays.
    bolted = {clamp.tip for clamp in bench.shown.clamps if clamp.hole is not None}
    for index, peg in enumerate(pegs):
        group, place = (
            add_moving_group(scene, view, None if peg in bolted else ways.get(peg.carrier)),
            next(places),
        )
        radius = bench.get_page_radius(view, index) if index in bench.placed else DOT
        flag = add_fixed_size_group(group, place.compute_leader(radius)[0])
        draw_flag(flag, place, radius, peg.hole)
        flag.element.set("class", "kept flag")
    faces = scene.group("faces")
    for face in (*numbers, *bench.gripped):
        place = next(places)
        tag = add_fixed_size_group(faces, place.anchor)
        draw_tag(tag, place, str(face))
        tag.element.set("class", "kept face-tag")


# Of a small picture, in page units: its rim, the steps of an arc, and between corners that are told apart.
SMALL, SMALL_RIM, STEP, CLOSEST = (84.0, 72.0), 4.0, 3.0, 0.4
SMALL_PEG = 2.4


def draw_small_picture(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> str:
    """Return a small picture of the part with its touched faces and pegs, to
    choose a fixture by, as SVG text.
    """
    pose = fixture.pose
    loops = [[pose.carry(segment) for segment in loop] for loop in workpiece.loop_segments]
    radii = [toolkit.find_carrier(peg.carrier).peg_radius for peg in fixture.pegs]
    boxes = [Box(*compute_bounding_box(segment)) for loop in loops for segment in loop]
    boxes += [
        Box.from_center((peg.x, peg.y), 2 * r, 2 * r) for peg, r in zip(fixture.pegs, radii, strict=True)
    ]
    view = View.fit_box(reduce(Box.unite, boxes), Box(0.0, 0.0, *SMALL).grow(-SMALL_RIM))
    scene = Scene.make_page(SMALL, "")
    outline = "".join(f"{make_polyline_path(loop, view)}Z" for loop in loops)
    scene.add_path(outline, fill=PART_FILL if workpiece.finished is None else RAW_FILL, fill_rule="evenodd")
    if workpiece.finished is not None:
        inside = [[pose.carry(segment) for segment in loop] for loop in workpiece.finished.loop_segments]
        within = "".join(f"{make_polyline_path(loop, view)}Z" for loop in inside)
        scene.add_path(within, BLACK, 0.7, PART_FILL, fill_rule="evenodd")
    hold = fixture.hold
    gripped = () if not isinstance(hold, JawHold) else (*hold.fixed.segments, *hold.moving.segments)
    for face in dict.fromkeys((*(peg.face for peg in fixture.pegs if peg.beside is None), *gripped)):
        scene.add_path(make_polyline_path([pose.carry(find_face(workpiece, face))], view), TOUCHED, 3.6)
    scene.add_path(outline, BLACK, 1.2)
    for peg, radius in zip(fixture.pegs, radii, strict=True):
        scene.add_circle(view((peg.x, peg.y)), max(radius * view.scale, SMALL_PEG), PEG_FILL)
    return ET.tostring(scene.element, encoding="unicode")


def make_polyline_path(segments: Sequence[Segment], view: View) -> str:
    """Return SVG path data of segments as a polyline.

    Points less than ``CLOSEST`` page units from the last point are left out.
    """
    points: list[Point] = []
    for segment in segments:
        count = 1 if isinstance(segment, Line) else ceil(segment.length * view.scale / STEP)
        way = segment.sign if isinstance(segment, Arc) else 1.0
        for k in range(count + 1):
            point = view(segment.compute_point(way * segment.half_extent * (2 * k / count - 1)))
            if not points or dist(point, points[-1]) >= CLOSEST:
                points.append(point)
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
