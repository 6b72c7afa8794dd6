"""Pictures of parts and fixtures: SVG text, and PNG rendered from the same SVG.

The map from millimetres to the page is kept in the pictures: groups that show the model carry it in the
attribute ``data-model-to-page`` as an SVG matrix.
"""

from workhold.drawing.fixture_pictures import MOST_THUMBNAILS, draw_fixture, draw_thumbnails
from workhold.drawing.part_pictures import draw_features
from workhold.drawing.render import render, svg_to_png
from workhold.drawing.sheet import draw_sheet, result_sheet
from workhold.drawing.sheet_facts import SheetDetails

__all__ = [
    "MOST_THUMBNAILS",
    "SheetDetails",
    "draw_features",
    "draw_fixture",
    "draw_sheet",
    "draw_thumbnails",
    "render",
    "result_sheet",
    "svg_to_png",
]
