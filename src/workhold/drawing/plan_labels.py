"""The labels of a plan: pegs by their holes, touched faces by their numbers, marked points, the part's turn.

Each stands where it hides least of the drawing and of the other labels.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, dist, pi, radians, sin

import numpy as np

from workhold.drawing.annotation import Label, LabelPlacer, Place, around, joined
from workhold.drawing.bench import PEG_FILL, Bench, draw_zero, force_arrow
from workhold.drawing.carriers import avoid_clamp
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.scene import BLACK, GREY, Box, LengthUnit, Scene, View, text_width
from workhold.drawing.supports_drawn import PlannedSupports
from workhold.geometry.segment import Point
from workhold.model.workpiece import Workpiece

__all__ = ["ANGLE_RADIUS", "ANGLE_REACH", "LONGEST_ARROW", "draw_labels"]

LONGEST_ARROW = 62.0
LABEL_SIZE, LABEL_HEIGHT = 15.0, 22.0
TAG_SIZE, TAG_HEIGHT = 12.0, 18.0
ANGLE_RADIUS, ANGLE_REACH = 24.0, 48.0
MARK_RADIUS = 5.0
# In denser lattices labels cannot help covering holes.
MOST_HOLES_AVOIDED = 2000


def draw_labels(
    scene: Scene,
    bench: Bench,
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
    """Labels pegs, touched faces, the part's turn and marked page points, where that hides nothing.

    Pegs are named by their holes, faces by their numbers.
    """
    center = view(bench.fixture.pose.apply(*workpiece.center))
    placer = LabelPlacer(Box(bounds.x0, bounds.y0 + 62, bounds.x1, bounds.y1 - 30))
    avoid_drawing(placer, bench, view, center)
    for box in names:
        placer.avoid_box(box)
    for (x, y), _ in marks:
        placer.avoid_box(Box(x, y, x, y).grown(MARK_RADIUS))
    if supports is not None:
        supports.avoided(placer, view)
    if path is not None:
        path.avoided(placer, view)
    pegs = bench.fixture.pegs
    numbers = list(dict.fromkeys(pegs[index].face for index in bench.touching))
    direction, angle_size = -radians(bench.fixture.pose.written_deg) / 2, (text_width(angle, 13) + 4, 16.0)
    placed = placer.place(
        [
            *(peg_label(bench, index, view) for index in bench.placed),
            *(face_tag(bench, face, view) for face in numbers),
            around(center, direction, angle_size, (26, 32, 40, 50, 64), spread(24), turn_cost=4),
            *(mark_label(point, name) for point, name in marks),
            *([] if path is None else path.labels(view, lengths)),
            *([] if supports is None else supports.labels(view)),
        ]
    )
    group, places = scene.group("labels"), iter(placed)
    for index in bench.placed:
        draw_flag(group, next(places), bench.radius(view, index), pegs[index].hole)
    for face in numbers:
        draw_tag(group, next(places), str(face))
    group.text(next(places).box.center, angle, 13, "middle", fill=GREY, halo=3)
    for _, name in marks:
        draw_mark(group, next(places), name)
    if path is not None and path.passing is not None:
        path.draw_name(group, next(places), lengths)
    if supports is not None:
        supports.draw_names(group, list(places), view)


def avoid_drawing(placer: LabelPlacer, bench: Bench, view: View, center: Point) -> None:
    """Marks where the drawing is, so that labels keep off; the part's turn is drawn around ``center``."""
    for outline in bench.outlines(view, 4.0):
        placer.avoid_ink(outline, 3.0)
        placer.avoid_walls(outline[::3])
    for index, peg in enumerate(bench.fixture.pegs):
        (x, y), radius = view((peg.x, peg.y)), bench.radius(view, index)
        placer.avoid_box(Box(x - radius, y - radius, x + radius, y + radius))
        placer.avoid_line(*force_arrow(bench, index, view, LONGEST_ARROW), price=8.0)
    turn = radians(bench.fixture.pose.written_deg)
    x, y = center
    placer.avoid_line(center, (x + ANGLE_REACH * cos(turn), y - ANGLE_REACH * sin(turn)), 8.0)
    placer.avoid_line(center, (x + ANGLE_REACH, y), 8.0)
    arc = np.linspace(0.0, turn, 24)
    placer.avoid_ink(np.column_stack([x + ANGLE_RADIUS * np.cos(arc), y - ANGLE_RADIUS * np.sin(arc)]), 3.0)
    for low, high in (axis for measured in bench.shown.measured for axis in measured.axes):
        placer.avoid_line(view(low), view(high), 0.5)
    for clamp in bench.shown.clamps:
        avoid_clamp(placer, clamp, view)
    for wall in bench.shown.walls:
        placer.avoid_box(view.box(wall.bar))
    for shown in bench.shown.carriers:
        if len(shown.columns) * len(shown.rows) < MOST_HOLES_AVOIDED:
            placer.avoid_ink([view(hole.center) for hole in shown.holes()], 2.0)


def spread(count: int) -> list[float]:
    """Turns all around, the small ones first, radians."""
    turns = [2 * pi * k / count for k in range(-count // 2 + 1, count // 2 + 1)]
    return sorted(turns, key=lambda turn: (abs(turn), turn))


def peg_label(bench: Bench, index: int, view: View) -> Label:
    """Candidates for the label of a peg: best away from the part, close by; that of a clamp at its hole."""
    peg = bench.fixture.pegs[index]
    nx, ny = bench.contacts[index][1]
    size = (text_width(peg.hole, LABEL_SIZE, bold=True) + 12, LABEL_HEIGHT)
    distances = [bench.radius(view, index) + gap for gap in (5, 14, 26, 42, 64, 90)]
    at = next((clamp.back for clamp in bench.shown.clamps if clamp.tip == peg), (peg.x, peg.y))
    return around(view(at), atan2(-ny, nx), size, distances, spread(24))


def mark_label(point: Point, name: str) -> Label:
    size = (text_width(name, TAG_SIZE) + 6, TAG_SIZE + 4)
    distances = [MARK_RADIUS + gap for gap in (3, 10, 20, 34, 52, 76, 110)]
    return around(point, pi / 4, size, distances, spread(24), turn_cost=2)


def face_tag(bench: Bench, face_number: int, view: View) -> Label:
    """Candidates for the number of a face: inside the part, beside the contacts on it."""
    index = next(k for k in bench.touching if bench.fixture.pegs[k].face == face_number)
    face = bench.faces[index]
    size = (max(TAG_HEIGHT, text_width(str(face_number), TAG_SIZE) + 8), TAG_HEIGHT)
    half = face.half_extent
    near = face.parameter(bench.contacts[index][0])
    labels = []
    for parameter in (share * half for share in (-0.85, -0.6, -0.35, 0.0, 0.35, 0.6, 0.85)):
        nx, ny = face.normal(parameter)
        extra = 4 * abs(parameter - near) / half
        labels.append(
            around(view(face.at(parameter)), atan2(ny, -nx), size, (7, 14, 24, 40, 60), spread(8), extra)
        )
    return joined(labels)


def draw_flag(scene: Scene, place: Place, radius: float, name: str) -> None:
    """Draws the label of a peg: a framed name, and a leader when it stands off."""
    leader = place.leader(radius)
    if dist(*leader) > 2:
        scene.line(leader, PEG_FILL, 1.4)
    scene.rectangle(place.box, "#ffffff", PEG_FILL, 1.4, 4)
    scene.text(place.box.center, name, LABEL_SIZE, "middle", bold=True)


def draw_mark(scene: Scene, place: Place, name: str) -> None:
    """Draws the sign of a zero point, a quartered disc, and its name with a leader."""
    scene.line(place.leader(), BLACK, 0.8)
    draw_zero(scene, place.anchor, MARK_RADIUS)
    scene.text(place.box.center, name, TAG_SIZE, "middle", halo=2.5)


def draw_tag(scene: Scene, place: Place, name: str) -> None:
    """Draws the number of a face in a rounded frame with a short leader to the face."""
    scene.line(place.leader(), BLACK, 0.8)
    scene.rectangle(place.box, "#ffffff", BLACK, 0.9, TAG_HEIGHT / 2)
    scene.text(place.box.center, name, TAG_SIZE, "middle")
