"""SVG drawings: from bytes to chains in mm.

The outlines that the author of a drawing sees are read; what cannot be read exactly is refused by name.
svgelements resolves path data. SVG's y axis points down, a workpiece's up: the drawing is mirrored, so that
the part looks as it does on screen. The origin is the page's lower left corner, or the point x = 0, y = 0 of
the user units when the page has no size.

Glossary
--------
user unit : the plain number in an SVG attribute; its length in mm follows from the root's width, height and
    viewBox.
physical size : a root width and height in mm, cm or in (or pt, pc). Pixels are not physical size.
"""

from __future__ import annotations

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.outline.chain import Drawing, Placement
from workhold.files.outline.diagnostics import make_unit_question
from workhold.files.questions import UNIT
from workhold.files.svg.document import DeclaredStyles, read_document
from workhold.files.svg.viewport import (
    ShapeElement,
    ViewBox,
    fit_viewbox,
    is_physical_length,
    read_absolute_length,
    read_viewbox,
)
from workhold.files.svg.walk import ElementNesting, SvgWalk
from workhold.units import INCH, find_drawing_unit, find_pixels_per_inch

__all__ = ["read_svg"]


def read_svg(
    content: bytes,
    *,
    unit: str | None,
    usual_unit: str | None = None,
    fit: float | None = None,
    budget: Budget | None = None,
) -> Drawing:
    """Return the visible outlines of an SVG file as chains in mm.

    Parameters
    ----------
    unit : the length of one user unit; None to use the file's physical size.
    usual_unit : the length of one user unit for a file without a physical size, where ``unit`` is None.
    fit : largest distance in mm of lines and arcs from true curves; with None such curves are replaced
        provisionally, see ``Drawing``.
    budget : work and time that may still be spent on the file; None gives the usual budget for a file of this
        size.

    Raises
    ------
    InputError
        For files that are not SVG, unknown units, and values that make no sense.
    """
    budget = budget or Budget(LIMITS["svg"], len(content))
    document = read_document(content, budget)
    # What is written counts, and then what is shown: the same or less, but for what <use> repeats.
    budget.elements = 0
    styles = DeclaredStyles(document, budget)
    name = document.name(document.root)
    root = ShapeElement(document.root, name, styles.list_declared_values(document.root), (None, None), budget)
    box = read_viewbox(document.root.get("viewBox"), root.label, budget)
    known = make_page_placement(root, box, unit, usual_unit)
    placement, remarks = known or (Placement(d=-1.0), [])
    walk = SvgWalk(document, styles, fit, budget)
    sides = [root.find_given_value(name) for name in ("width", "height")]
    width, height = (None if side is None else read_absolute_length(side.text) for side in sides)
    viewport = (width, height) if box is None else (box[2], box[3])
    try:
        walk.visit(document.root, ElementNesting(placement, viewport))
    except InputError:
        if known is not None:
            raise
        walk.chains = []
    if known is None:
        pixels = compute_file_scales(root, 1.0, (width, height), box) or (1.0, 1.0)
        lacking = "the drawing has no physical size (width and height in mm, cm or in)"
        if is_in_pixels(root):
            lacking += ", but one in pixels"
        raise make_unit_question(lacking, walk.chains, pixels[0], is_in_pixels(root))
    if walk.hidden and not walk.chains:
        raise InputError(
            "no shape of the drawing is seen: each is switched off, transparent, or without fill and stroke."
        )
    remarks += walk.list_remarks()
    return Drawing(tuple(walk.chains), tuple(remarks), walk.curves.found, looks=walk.looks)


# Sizes are written with few digits: what differs by less than this share is meant to be the same.
FEW_DIGITS = 1e-3

Size = tuple[float | None, float | None]


def make_page_placement(
    root: ShapeElement, box: ViewBox | None, unit: str | None, usual_unit: str | None
) -> tuple[Placement, list[str]] | None:
    """Return (1) the map from user units to mm with y up, and (2) a list with a remark if ``unit`` overrides
    the file's size, otherwise [].

    None when the size of a user unit is not known. ``box`` is the root's viewBox.
    """
    given = [root.find_given_value(name) for name in ("width", "height")]
    sized = any(side is not None and is_physical_length(side.text) for side in given)
    if not sized:
        unit = usual_unit if unit is None else unit
    asked = None if unit is None else find_drawing_unit(unit)
    an_inch = 96.0  # CSS Values 4, 6.2
    pixels = None if sized else find_pixels_per_inch(unit)
    if pixels is not None and any(side is not None and read_absolute_length(side.text) for side in given):
        # It is the size of the pixel that was asked for, in which the file gives its own.
        an_inch, asked, sized = pixels, None, True
    lengths = (None if side is None or not sized else read_absolute_length(side.text) for side in given)
    width, height = (None if side is None else side * INCH.millimetres / an_inch for side in lengths)
    scales = compute_file_scales(root, INCH.millimetres / an_inch, (width, height), box) if sized else None
    if asked is not None:
        return make_uniform_placement(asked.millimetres, box), remark_on_unit(
            root, scales, unit or "", asked.millimetres
        )
    if scales is None:
        return None
    left, low = (0.0, 0.0) if box is None else (box[0], box[1] + box[3])
    if box is None and height is not None:
        low = height / scales[1]
    placement = Placement(scales[0], 0.0, 0.0, -scales[1], -scales[0] * left, scales[1] * low)
    if box is None or width is None or height is None or are_scales_equal(width / box[2], height / box[3]):
        return placement, []
    # Where the page has another shape than the drawing, this is where the drawing lies on it.
    aspect = fit_viewbox(box, width, height, root.element.get("preserveAspectRatio", ""), root.label)
    return Placement(d=-1.0, f=height).compose_after(aspect), []


def make_uniform_placement(scale: float, box: ViewBox | None) -> Placement:
    """Return the map of user units of ``scale`` mm, with y
    up and the lower left corner of the viewBox as origin.
    """
    left, low = (0.0, 0.0) if box is None else (box[0], box[1] + box[3])
    return Placement(scale, 0.0, 0.0, -scale, -scale * left, scale * low)


def remark_on_unit(
    root: ShapeElement, scales: tuple[float, float] | None, unit: str, millimetres: float
) -> list[str]:
    """Return a list with a remark when a unit that was asked for is not the file's; [] otherwise.

    ``scales`` are the file's own mm per user unit in x and y, or None; ``millimetres`` is the mm per user
    unit that was asked for.
    """
    if scales is not None and max(abs(scale - millimetres) for scale in scales) > 1e-9 * millimetres:
        return [f"The file's size makes a user unit {scales[0]:.6g} mm; it was read as 1 {unit} as asked."]
    if is_in_pixels(root) and scales is None:
        return [
            f"The file's size is in pixels; a user unit was read as 1 {unit} as asked. Where 72, 90 or 96 "
            f"pixels are an inch, give {UNIT} px72, px90 or px96."
        ]
    return []


def is_in_pixels(root: ShapeElement) -> bool:
    """Return whether the root's width or height is written in px."""
    given = (root.find_given_value(name) for name in ("width", "height"))
    return any(side is not None and side.text.lower().endswith("px") for side in given)


def are_scales_equal(one: float, other: float) -> bool:
    """Return whether two positive scales agree to
    ``FEW_DIGITS``, the precision of the sizes that give them.
    """
    return abs(one - other) <= FEW_DIGITS * max(one, other)


def compute_file_scales(
    root: ShapeElement, pixel: float, size: Size, box: ViewBox | None
) -> tuple[float, float] | None:
    """Return the millimetres per user unit in x and y, from
    the page's size in mm; None if the page has no size.

    ``pixel`` is a user unit in mm where there is no viewBox. Raises InputError for a size that is not
    positive.
    """
    if size == (None, None):
        return None
    for side in size:
        if side is not None and not side > 0:
            raise InputError("the drawing's width or height is not positive: correct it.")
    if box is None:
        return pixel, pixel
    scales = [side / whole for side, whole in zip(size, box[2:], strict=True) if side is not None]
    if len(scales) == 2 and abs(scales[0] - scales[1]) > 1e-9 * max(scales):
        aspect = root.element.get("preserveAspectRatio", "xMidYMid meet").strip()
        if aspect.startswith("none") and not are_scales_equal(scales[0], scales[1]):
            return scales[0], scales[1]
        return (max(scales) if aspect.endswith("slice") else min(scales),) * 2
    return scales[0], scales[0]
