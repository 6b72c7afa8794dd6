"""Pictures of parts and fixtures: SVG text, and PNG rendered from the same SVG.

The map from millimetres to the page is kept in the pictures: groups that show the model carry it in the attribute
``data-model-to-page`` as an SVG matrix.
"""

from holdfast.drawing.features_picture import draw_features
from holdfast.drawing.fixture_picture import draw_fixture
from holdfast.drawing.render import render, svg_to_png
from holdfast.drawing.sheet import draw_sheet
from holdfast.drawing.sheet_details import SheetDetails
from holdfast.drawing.thumbnails import MOST_THUMBNAILS, draw_thumbnails

__all__ = [
    "MOST_THUMBNAILS",
    "SheetDetails",
    "draw_features",
    "draw_fixture",
    "draw_sheet",
    "draw_thumbnails",
    "render",
    "svg_to_png",
]
