"""Pictures of parts and fixtures: SVG text, and PNG rendered from the same SVG.

The map from millimetres to the page is kept in the pictures: groups that show the model carry it in the
attribute ``data-model-to-page`` as an SVG matrix.
"""

from workhold.drawing.fixture_pictures import MOST_THUMBNAILS, draw_fixture, draw_thumbnails
from workhold.drawing.part_pictures import draw_features
from workhold.drawing.render import convert_svg_to_png, render
from workhold.drawing.sheet import draw_setup_sheet, draw_sheet
from workhold.drawing.sheet_facts import SheetDetails

__all__ = [
    "MOST_THUMBNAILS",
    "SheetDetails",
    "draw_features",
    "draw_fixture",
    "draw_sheet",
    "draw_thumbnails",
    "render",
    "draw_setup_sheet",
    "convert_svg_to_png",
]
