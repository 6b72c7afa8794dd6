"""The parts of a file with their numbers, so that one of them can be chosen."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from workhold.drawing.bench import PART_FILL
from workhold.drawing.dimensions import scale_bar
from workhold.drawing.fonts import shortened, text_width
from workhold.drawing.labels import LabelPlacer, around, leader_end
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import plural
from workhold.drawing.part import outline_path, sampled_loop
from workhold.drawing.scene import BLACK, GREY, LANDSCAPE, PORTRAIT, Box, Scene, View
from workhold.geometry.intersect import bounding_box
from workhold.geometry.loop import loop_segments
from workhold.units import MILLIMETRE, Unit

__all__ = ["draw_parts"]

EDGE, HEADER, FOOTER = 32.0, 62.0, 30.0
OTHER_FILL, LEADER = "#eef0f3", "#6b4a00"
# Parts by decreasing area; specks beyond these are drawn without a number.
MOST_NUMBERS = 60


def draw_parts(
    name: str, parts: Sequence[Sequence[NDArray[np.float64]]], chosen: int, *, unit: Unit = MILLIMETRE
) -> str:
    """Draw the parts of a file where they lie, each with its number, on A4.

    Parameters
    ----------
    name : what to call the file.
    parts : for each part its loops, (N, 3) vertices in mm; part k + 1 is called by that number.
    chosen : the number of the part that is used, which has another colour.
    unit : of the lengths written.

    Returns
    -------
    str
        SVG text.
    """
    loops = [[loop_segments(vertices) for vertices in part] for part in parts]
    boxes = [bounding_box(segment) for part in loops for loop in part for segment in loop]
    bounds = Box(*(min(box[k] for box in boxes) for k in (0, 1)), *(max(box[k] for box in boxes) for k in (2, 3)))
    lengths = LengthUnit.suiting(unit, max(bounds.width, bounds.height))
    page = LANDSCAPE if bounds.width >= 0.8 * bounds.height else PORTRAIT
    drawing = Box(EDGE + 30, EDGE + HEADER + 30, page[0] - EDGE - 30, page[1] - EDGE - FOOTER - 30)
    view = View.fitting(bounds, drawing)
    scene = Scene.page(page, f"{name}: parts")
    group = scene.group("header")
    width = page[0] - 2 * EDGE
    group.text((EDGE, EDGE + 12), shortened(name, 26, width, bold=True), 26, bold=True)
    words = f"{plural(len(parts), 'part')}, numbered by decreasing area · part {chosen} is the one that is used"
    group.text((EDGE, EDGE + 40), shortened(words, 14, width), 14, fill=GREY)
    for number, part in reversed(list(enumerate(loops, start=1))):
        fill = PART_FILL if number == chosen else OTHER_FILL
        scene.group(f"part-{number}", view).path(outline_path(part, view), BLACK, 1.4, fill, fill_rule="evenodd")
    placer = LabelPlacer(drawing.grown(28))
    for part in loops:
        for loop in part:
            placer.avoid_ink(sampled_loop(loop, view, 4.0), 2.0)
    labels = []
    for number, part in enumerate(loops[:MOST_NUMBERS], start=1):
        size = (max(22.0, text_width(str(number), 15.0, bold=True) + 12), 22.0)
        # A place within the material beside the outline's first segment, or else about there.
        segment = part[0][0]
        x, y = view(segment.at(0.0))
        turns = [k * pi / 6 for k in range(12)]
        labels.append(around((x, y), 0.0, size, [4.0, 14.0, 26.0, 40.0], turns, turn_cost=0.0))
    group = scene.group("part-numbers")
    for number, place in enumerate(placer.place(labels), start=1):
        group.line([place.anchor, leader_end(place.anchor, place.box)], LEADER, 0.9)
        group.circle(place.anchor, 1.7, LEADER)
        group.rectangle(place.box, "#ffffff", LEADER, 0.9, place.box.height / 2)
        group.text(place.box.center, str(number), 15.0, "middle", bold=True)
    scale_bar(scene, (EDGE, page[1] - EDGE), view.scale, lengths)
    return scene.svg()
