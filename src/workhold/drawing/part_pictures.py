"""Pictures to choose by number from: a part's faces, and the parts of a file."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from math import atan2, hypot, pi

import numpy as np
from numpy.typing import NDArray

from workhold.contact.features import list_contact_features
from workhold.drawing.annotation import (
    Label,
    LabelPlacer,
    PlacedLabel,
    draw_dimension,
    draw_scale_bar,
    join_labels,
    make_label_around,
)
from workhold.drawing.bench import (
    ARROW,
    PART_FILL,
    make_outline_path,
    make_segment_path,
    sample_loop,
    sample_segments,
)
from workhold.drawing.panel import format_count
from workhold.drawing.scene import (
    BLACK,
    GREY,
    LANDSCAPE,
    PORTRAIT,
    Box,
    LengthUnit,
    Scene,
    View,
    measure_text,
    shorten_text,
)
from workhold.geometry.loop import Face, make_loop_segments
from workhold.geometry.segment import Arc, Segment, compute_bounding_box
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["EDGE", "FOOTER", "HEADER", "draw_features", "draw_header", "draw_parts"]

EDGE, HEADER, FOOTER = 32.0, 62.0, 30.0
# Room around the part for numbers, and outside it for dimensions.
NUMBERS, MORE_NUMBERS = 54.0, 84.0
MANY_FACES, VERY_MANY_FACES = 30, 80
DIMENSIONS = 36.0
LEADER = "#6b4a00"


def draw_features(workpiece: Workpiece, *, peg_radius: float | None = None, unit: Unit = MILLIMETRE) -> str:
    """Return a picture of the part with numbered faces, overall size and scale, on A4; above 80 faces on A3
    or A2.

    Parameters
    ----------
    peg_radius : radius in mm of the pegs whose contact features are drawn as well; None draws none.

    Returns
    -------
    str
        SVG text; the group of class ``part`` carries the map from mm to the page, as in :func:`draw_fixture`.
    """
    bounds = Box(*workpiece.bounds)
    lengths = LengthUnit.from_typical_length(unit, max(bounds.width, bounds.height))
    page = choose_page_size(
        len(workpiece.faces), LANDSCAPE if bounds.width >= 0.8 * bounds.height else PORTRAIT
    )
    numbers = MORE_NUMBERS if len(workpiece.faces) > MANY_FACES else NUMBERS
    margin = numbers + DIMENSIONS
    drawing = Box(EDGE, EDGE + HEADER, page[0] - EDGE, page[1] - EDGE - FOOTER)
    room = Box(drawing.x0 + margin, drawing.y0 + numbers, drawing.x1 - numbers, drawing.y1 - margin)
    view = View.fit_box(bounds, room)
    scene = Scene.make_page(page, f"{workpiece.name}: faces")
    draw_header(scene, page, workpiece.name, describe_part(workpiece, bounds, peg_radius, lengths))
    draw_outline(scene, workpiece, view)
    features = list[Segment]()
    if peg_radius is not None:
        features = [feature.segment for feature in list_contact_features(workpiece, peg_radius)]
        group = scene.group("contact-features", view)
        for segment in features:
            group.add_path(make_segment_path(segment, view), ARROW, 1.4, stroke_dasharray="7 4")
    draw_numbers(scene, workpiece, view, view.map_box(bounds).grow(numbers - 6), features)
    draw_overall(scene, bounds, view, numbers, lengths)
    draw_scale_bar(scene, (EDGE, page[1] - EDGE), view.scale, lengths)
    return scene.to_svg()


def choose_page_size(faces: int, page: tuple[float, float]) -> tuple[float, float]:
    """Return (width, height) in page units for a part with this number of faces.

    It is ``page`` itself, which is A4, or for many faces A3 or A2 of the same orientation.
    """
    larger = 1.0 if faces <= VERY_MANY_FACES else 2**0.5 if faces <= 2 * VERY_MANY_FACES else 2.0
    return round(larger * page[0]), round(larger * page[1])


def draw_header(scene: Scene, page: tuple[float, float], name: str, words: str) -> None:
    """Write a name on a page, and a line of words below it, each shortened to fit."""
    group, width = scene.group("header"), page[0] - 2 * EDGE
    group.add_text((EDGE, EDGE + 12), shorten_text(name, 26, width, bold=True), 26, bold=True)
    group.add_text((EDGE, EDGE + 40), shorten_text(words, 14, width), 14, fill=GREY)


def describe_part(workpiece: Workpiece, bounds: Box, peg_radius: float | None, lengths: LengthUnit) -> str:
    """Return the line of words below the part's name: numbers of faces and holes, size, and other remarks."""
    faces, holes = len(workpiece.faces), len(workpiece.hole_segments)
    words = [format_count(faces, "face"), format_count(holes, "hole") if holes else "no holes"]
    words.append(f"{lengths.format_number(bounds.width)} × {lengths.format_length(bounds.height)}")
    if peg_radius is not None:
        size = lengths.format_short(2 * peg_radius)
        words.append(f"dashed: where the centre of a peg of Ø {size} lies when it touches a face")
    if len(workpiece.segments) > faces:
        words.append("a face drawn in pieces has the number of the first")
    return " · ".join(words)


def draw_outline(scene: Scene, workpiece: Workpiece, view: View) -> None:
    """Draw the filled part, with ticks across its outline where segments meet."""
    part = scene.group("part", view)
    d = make_outline_path(workpiece.loop_segments, view)
    part.add_path(d, BLACK, 2.2, PART_FILL, fill_rule="evenodd", **{"class": "outline"})
    ticks = scene.group("joints")
    for loop in workpiece.loop_segments:
        for k, segment in enumerate(loop):
            ax, ay = segment.compute_normal(compute_first_parameter(segment))
            bx, by = loop[k - 1].compute_normal(-compute_first_parameter(loop[k - 1]))
            nx, ny = ax + bx, ay + by
            length = hypot(nx, ny)
            if length < 1e-6:
                nx, ny, length = ax, ay, 1.0
            x, y = view(segment.start)
            dx, dy = 5.5 * nx / length, -5.5 * ny / length
            ticks.add_line([(x - dx, y - dy), (x + dx, y + dy)], BLACK, 1.2)


def compute_first_parameter(segment: Segment) -> float:
    """Return the parameter at which a segment starts; it ends at the negative of that."""
    return -segment.sign * segment.half_sweep if isinstance(segment, Arc) else -segment.half_extent


def draw_numbers(
    scene: Scene, workpiece: Workpiece, view: View, bounds: Box, features: Sequence[Segment]
) -> None:
    """Write the number of every face on the side away from the material, with a leader.

    Numbers keep off the contact features ``features`` and inside the page box ``bounds``.
    """
    count = len(workpiece.faces)
    size = 15.0 if count <= MANY_FACES else 12.0
    shares = (0.0, 0.3, -0.3, 0.6, -0.6) if count <= VERY_MANY_FACES else (0.0,)
    placer = LabelPlacer(bounds)
    for loop in workpiece.loop_segments:
        placer.avoid_ink(sample_loop(loop, view, 3.0), 5.0)
        placer.avoid_crossing(sample_loop(loop, view, 12.0))
    placer.avoid_ink(sample_segments(features, view, 3.0), 0.6)
    outer = workpiece.outer_count
    places = placer.place(
        [make_number_label(face, view, size, shares, face.number < outer) for face in workpiece.faces]
    )
    group = scene.group("face-numbers")
    for place in places:
        draw_leader(group, place)
    for face, place in zip(workpiece.faces, places, strict=True):
        draw_number_beside(group, place, face.number, size)


def draw_leader(scene: Scene, place: PlacedLabel) -> None:
    """Draw the leader of a placed face number, with a dot at the face."""
    scene.add_line(place.compute_leader(), LEADER, 0.9)
    scene.add_circle(place.anchor, 1.7, LEADER)


def draw_number_beside(scene: Scene, place: PlacedLabel, number: int, size: float) -> None:
    """Write a number into the box of its placed label, with a rounded frame."""
    scene.add_rectangle(place.box, "#ffffff", LEADER, 0.9, place.box.height / 2)
    scene.add_text(place.box.center, str(number), size, "middle", bold=True)


def make_number_label(face: Face, view: View, size: float, shares: Sequence[float], outer: bool) -> Label:
    """Return the label of a face's number, with its candidate places.

    A place along the outward normal is cheapest; turned, farther away or inside the material costs more.
    Leaders start at the parameters ``shares`` times the face's half extent, 0 being its middle. In a hole
    (``outer`` False) a place inside the material costs less than on the outer loop.
    """
    height = size + 6
    width = max(height, measure_text(str(face.number), size, bold=True) + 10)
    turns = [0.0, *(sign * k * pi / 12 for k in range(1, 6) for sign in (1, -1))]
    distances = [size * k for k in (0.7, 1.1, 1.7, 2.4, 3.2, 4.2)]
    labels = []
    for share in shares:
        parameter = share * face.segment.half_extent
        nx, ny = face.segment.compute_normal(parameter)
        anchor = view(face.segment.compute_point(parameter))
        extra, inward = 12.0 * abs(share), 90.0 if outer else 25.0
        labels.append(make_label_around(anchor, atan2(-ny, nx), (width, height), distances, turns, extra))
        labels.append(
            make_label_around(
                anchor, atan2(ny, -nx), (width, height), distances[:4], turns[:7], extra + inward
            )
        )
    return join_labels(labels)


def draw_overall(scene: Scene, bounds: Box, view: View, numbers: float, lengths: LengthUnit) -> None:
    """Draw the dimensions of the part's overall width and height, below and at the left."""
    group = scene.group("overall")
    box = view.map_box(bounds)
    y = box.y1 + numbers + 22
    for x in (box.x0, box.x1):
        group.add_line([(x, box.y1 + 10), (x, y + 4)], GREY, 0.6)
    draw_dimension(group, (box.x0, y), (box.x1, y), lengths.format_length(bounds.width))
    x = box.x0 - numbers - 8
    for y in (box.y0, box.y1):
        group.add_line([(box.x0 - 10, y), (x - 4, y)], GREY, 0.6)
    draw_dimension(group, (x, box.y1), (x, box.y0), lengths.format_length(bounds.height))


OTHER_FILL = "#eef0f3"
# Parts by decreasing area; smaller ones are drawn without a number.
MOST_NUMBERS = 60


def draw_parts(
    name: str, parts: Sequence[Sequence[NDArray[np.float64]]], chosen: int, *, unit: Unit = MILLIMETRE
) -> str:
    """Return a picture of the parts of a file at their places, each with its number, on A4, as SVG text.

    Parameters
    ----------
    parts : for each part its loops, (N, 3) vertices in mm; the part at index k has the number k + 1.
    chosen : the number of the part that is used; it is drawn in another colour.

    Returns
    -------
    str
        SVG text.
    """
    loops = [[make_loop_segments(vertices) for vertices in part] for part in parts]
    segments = (segment for part in loops for loop in part for segment in loop)
    bounds = reduce(Box.unite, (Box(*compute_bounding_box(segment)) for segment in segments))
    lengths = LengthUnit.from_typical_length(unit, max(bounds.width, bounds.height))
    page = LANDSCAPE if bounds.width >= 0.8 * bounds.height else PORTRAIT
    drawing = Box(EDGE, EDGE + HEADER, page[0] - EDGE, page[1] - EDGE - FOOTER).grow(-30)
    view = View.fit_box(bounds, drawing)
    scene = Scene.make_page(page, f"{name}: parts")
    words = f"{format_count(len(parts), 'part')}, numbered by decreasing area"
    draw_header(scene, page, name, f"{words} · part {chosen} is the one that is used")
    for number, part in reversed(list(enumerate(loops, start=1))):
        fill = PART_FILL if number == chosen else OTHER_FILL
        scene.group(f"part-{number}", view).add_path(
            make_outline_path(part, view), BLACK, 1.4, fill, fill_rule="evenodd"
        )
    placer = LabelPlacer(drawing.grow(28))
    for part in loops:
        for loop in part:
            placer.avoid_ink(sample_loop(loop, view, 4.0), 2.0)
    labels = []
    for number, part in enumerate(loops[:MOST_NUMBERS], start=1):
        size = (max(22.0, measure_text(str(number), 15.0, bold=True) + 12), 22.0)
        # A place within the material beside the outline's first segment, or else about there.
        anchor, turns = view(part[0][0].compute_point(0.0)), [k * pi / 6 for k in range(12)]
        labels.append(make_label_around(anchor, 0.0, size, [4.0, 14.0, 26.0, 40.0], turns, turn_cost=0.0))
    group = scene.group("part-numbers")
    for number, place in enumerate(placer.place(labels), start=1):
        draw_leader(group, place)
        draw_number_beside(group, place, number, 15.0)
    draw_scale_bar(scene, (EDGE, page[1] - EDGE), view.scale, lengths)
    return scene.to_svg()
