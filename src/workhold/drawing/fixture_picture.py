"""The picture a machinist sets the vise from: one fixture on one sheet."""

from __future__ import annotations

from attrs import frozen

from workhold.drawing.bench import Bench, bench_of
from workhold.drawing.dimensions import scale_bar
from workhold.drawing.inset import draw_inset
from workhold.drawing.legend import draw_legend
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import Column, draw_peg_table, draw_settings, draw_title
from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP, draw_plan
from workhold.drawing.plates import most_holes
from workhold.drawing.scene import GREY, LANDSCAPE, PORTRAIT, Box, Scene, View
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["draw_fixture"]

EDGE = 32.0
PANEL = 326.0
SCALE_BAR = 36.0
HIGHEST_INSET = 320.0


@frozen
class Layout:
    """Where the drawing and the panel go on a page."""

    page: tuple[float, float]
    drawing: Box
    panel: Box

    def view(self, bench: Bench) -> View:
        """The largest view of a bench that leaves room for the lettering."""
        box = self.drawing
        inner = Box(box.x0 + LEFT, box.y0 + TOP, box.x1 - RIGHT, box.y1 - BOTTOM - SCALE_BAR)
        return View.fitting(bench.extent, inner)


def layout_on(page: tuple[float, float]) -> Layout:
    """A page with the panel at the right."""
    width, height = page
    split = width - EDGE - PANEL
    return Layout(page, Box(EDGE, EDGE, split - 24, height - EDGE), Box(split, EDGE, width - EDGE, height - EDGE))


def draw_fixture(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, *, title: str | None = None, unit: Unit = MILLIMETRE
) -> str:
    """Draw a fixture on an A4 sheet, landscape, or portrait when that shows it much larger.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their attribute
    ``data-model-to-page``, written as an SVG matrix.

    Parameters
    ----------
    title : what to call the fixture, such as ``Fixture 3 of 70``.
    unit : of the lengths written.

    Returns
    -------
    str
        SVG text.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    lengths = LengthUnit.suiting(unit, bench.shown.pitch)
    landscape, portrait = layout_on(LANDSCAPE), layout_on(PORTRAIT)
    layout = portrait if portrait.view(bench).scale > 1.15 * landscape.view(bench).scale else landscape
    view = layout.view(bench)
    scene = Scene.page(layout.page, f"{workpiece.name}: {title or 'Fixture'}")
    draw_plan(scene, bench, view, workpiece, layout.drawing, lengths)
    scale_bar(scene, (layout.drawing.x0, layout.drawing.y1), view.scale, lengths)
    draw_panel(scene, layout.panel, bench, view, workpiece, title, lengths)
    return scene.svg()


def draw_panel(
    scene: Scene, panel: Box, bench: Bench, view: View, workpiece: Workpiece, title: str | None, lengths: LengthUnit
) -> None:
    """Write the panel, with the part as drawn at its foot; ``view`` is that of the drawing beside it."""
    group, fixture = scene.group("panel"), bench.fixture
    group.line([(panel.x0 - 12, panel.y0), (panel.x0 - 12, panel.y1)], GREY, 0.8)
    column = Column(group, panel.x0, panel.y0, panel.width)
    draw_title(column, fixture, workpiece, bench.toolkit, title)
    draw_settings(column, fixture, bench.toolkit, lengths)
    draw_peg_table(column, fixture, bench.toolkit, lengths)
    draw_legend(column, bench.toolkit)
    if not most_holes(view, bench.shown):
        column.words("Only the holes near the pegs are drawn.", 11.5, fill=GREY)
    column.rule()
    room = Box(panel.x0, column.y, panel.x1, min(panel.y1, column.y + HIGHEST_INSET))
    draw_inset(group, room, workpiece, fixture, bench.toolkit)
