"""SVG drawings: from bytes to chains in mm.

What the author of a drawing sees is read, or refused by name; svgelements resolves path data. SVG's y axis
points down, a workpiece's up: the drawing is turned over, so that the part looks as it does on screen. The
origin is the page's lower left corner, or the point x = 0, y = 0 of the user units when the page has no size.

Glossary
--------
user unit : the plain number in an SVG attribute; what it means in mm follows from the root's width, height
    and viewBox.
physical size : a root width and height in mm, cm or in (or pt, pc). Pixels are no physical size.
"""

from __future__ import annotations

from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.outline.chain import Drawing, Placement
from workhold.files.outline.diagnostics import unit_asked
from workhold.files.svg.document import Styles, read_document
from workhold.files.svg.viewport import ShapeElement, ViewBox, absolute, millimetres, physical, viewbox_of
from workhold.files.svg.walk import ElementNesting, SvgWalk
from workhold.units import unit_named

__all__ = ["read_svg"]


def read_svg(
    content: bytes,
    *,
    unit: str | None,
    usual_unit: str | None = None,
    fit: float | None = None,
    budget: Budget | None = None,
) -> Drawing:
    """Reads the visible outlines of an SVG file.

    Parameters
    ----------
    content : the file's bytes.
    unit : what one user unit is; None to go by the file's physical size.
    usual_unit : what it is in a file without a physical size.
    fit : how far lines and arcs may be from true curves, in mm; None keeps a proposal in their place, see
        ``Drawing``.
    budget : what reading the file may still take; None is that of a file of these bytes.

    Raises
    ------
    InputError
        For files that are no SVG, unknown units, and values that make no sense.
    """
    budget = budget or Budget(LIMITS["svg"], len(content))
    document = read_document(content, budget)
    styles = Styles(document, budget)
    name = document.name(document.root)
    root = ShapeElement(document.root, name, styles.of(document.root), (None, None), budget)
    box = viewbox_of(document.root.get("viewBox"), root.label, budget)
    known = page(root, box, unit, usual_unit)
    placement, remarks = known or (Placement(d=-1.0), [])
    walk = SvgWalk(document, styles, fit, budget)
    sides = [root.given(name) for name in ("width", "height")]
    width, height = (None if side is None else absolute(side.text) for side in sides)
    viewport = (width, height) if box is None else (box[2], box[3])
    try:
        walk.visit(document.root, ElementNesting(placement, viewport))
    except InputError:
        if known is not None:
            raise
        walk.chains = []
    if known is None:
        raise unit_asked("the drawing has no physical size (width and height in mm, cm or in)", walk.chains)
    if walk.hidden and not walk.chains:
        raise InputError(
            "no shape of the drawing is seen: each is switched off, transparent, or without fill and stroke."
        )
    return Drawing(tuple(walk.chains), (*remarks, *walk.remarks()), walk.curves.found)


def page(
    root: ShapeElement, box: ViewBox | None, unit: str | None, usual_unit: str | None
) -> tuple[Placement, list[str]] | None:
    """The map from user units to mm with y up, and a remark when the user's unit overrides the file's size.

    None when the size of a user unit is not known.

    Raises InputError when the size of a user unit differs between x and y.
    """
    given = [root.given(name) for name in ("width", "height")]
    sized = any(side is not None and physical(side.text) for side in given)
    width, height = (None if side is None or not sized else millimetres(side.text) for side in given)
    scale = file_scale(root, width, height, box)
    remarks = []
    if scale is None and unit is None:
        unit = usual_unit
    if unit is not None:
        asked = unit_named(unit).millimetres
        if scale is not None and abs(scale - asked) > 1e-9 * asked:
            remarks.append(
                f"The file's size makes a user unit {scale:.6g} mm; it was read as 1 {unit} as asked."
            )
        scale = asked
    if scale is None:
        return None
    left, low = (0.0, 0.0) if box is None else (box[0], box[1] + box[3])
    if box is None and height is not None and unit is None:
        low = height / scale
    return Placement(scale, 0.0, 0.0, -scale, -scale * left, scale * low), remarks


def file_scale(
    root: ShapeElement, width: float | None, height: float | None, box: ViewBox | None
) -> float | None:
    """Millimetres per user unit by the file's own physical size in mm; None when it has none.

    Raises InputError when x and y would be scaled unequally.
    """
    if width is None and height is None:
        return None
    for size in (width, height):
        if size is not None and not size > 0:
            raise InputError("the drawing's width or height is not positive: correct it.")
    if box is None:
        return 25.4 / 96  # a user unit is a CSS pixel, 1/96 inch (CSS Values 4, section 6.2)
    scales = [size / side for size, side in ((width, box[2]), (height, box[3])) if size is not None]
    if len(scales) == 2 and abs(scales[0] - scales[1]) > 1e-9 * max(scales):
        aspect = root.element.get("preserveAspectRatio", "xMidYMid meet")
        # Sizes are written with few digits; a drawing distorted on purpose is far from square.
        if aspect.strip().startswith("none") and abs(scales[0] - scales[1]) > 1e-3 * max(scales):
            raise InputError("width, height and viewBox scale x and y unequally: make them agree.")
        return max(scales) if aspect.strip().endswith("slice") else min(scales)
    return scales[0]
