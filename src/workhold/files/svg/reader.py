"""SVG drawings: from bytes to chains in mm.

The tree is walked here, so that every message can name its element; svgelements reads path data. SVG's y axis points
down, a workpiece's up: the drawing is turned over, so that the part looks as it does on screen, with the page's lower
left corner as the origin (or the point x = 0, y = 0 of the user units when the page has no size).

Glossary
--------
user unit : the plain number in an SVG attribute; what it means in mm follows from the root's width, height and viewBox.
physical size : a root width and height in mm, cm or in (or pt, pc). Pixels are no physical size.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from xml.etree import ElementTree
from xml.parsers import expat

from attrs import evolve, frozen

from workhold.errors import InputError
from workhold.files.outline.chain import Chain, Drawing, counted
from workhold.files.outline.placement import Placement
from workhold.files.svg.shapes import SHAPES, Shape, length, local_name, named, numbers, physical_length, transform_of
from workhold.files.svg.style import hidden_selectors, is_hidden, is_invisible
from workhold.model.units import unit_named

__all__ = ["read_svg"]

DEEPEST = 200
MOST_ELEMENTS = 1_000_000
CONTAINERS = {"svg", "g", "a", "switch"}
SILENT = {"defs", "symbol", "style", "title", "desc", "metadata", "clipPath", "mask", "marker", "pattern", "filter"}
SILENT |= {"linearGradient", "radialGradient", "script", "view", "namedview"}
SVG_SPACE = "{http://www.w3.org/2000/svg}"
LINK = "{http://www.w3.org/1999/xlink}href"

Element = ElementTree.Element


def read_svg(content: bytes, *, unit: str | None, usual_unit: str | None = None) -> Drawing:
    """Read the visible outlines of an SVG file.

    Parameters
    ----------
    content : the file's bytes.
    unit : what one user unit is; None to go by the file's physical size.
    usual_unit : what it is in a file without a physical size.

    Raises
    ------
    InputError
        For files that are no SVG, unknown units, Bézier curves, ellipses, and values that make no sense.
    """
    check_xml(content)
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError(f"the file is not valid XML ({error}): export it again.") from error
    if local_name(root) != "svg":
        raise InputError(f"this is XML, but not an SVG drawing (its root is <{local_name(root)[:40]}>).")
    placement, remarks = page(root, unit, usual_unit)
    walk = SvgWalk(root)
    walk.visit_children(root, Nest(placement))
    return Drawing(tuple(walk.chains), (*remarks, *walk.remarks()))


def check_xml(content: bytes) -> None:
    """Refuse XML that is broken, nested without end, or declares entities (which can blow up to any size).

    Raises
    ------
    InputError
        With line and column where XML is broken.
    """
    parser = expat.ParserCreate()
    depth = 0

    def started(name: str, _: object) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise InputError(f"<{name[:40]}> is nested more than {DEEPEST} levels deep: save a plain SVG.")

    def ended(_: str) -> None:
        nonlocal depth
        depth -= 1

    def declared(*_: object) -> None:
        raise InputError("the SVG file declares XML entities, which are not read: save it as plain SVG.")

    parser.StartElementHandler = started
    parser.EndElementHandler = ended
    parser.EntityDeclHandler = declared
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code) or "broken"
        raise InputError(
            f"the file is not valid XML ({reason} at line {error.lineno}, column {error.offset + 1}): export it again."
        ) from error
    except (ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"the file's text encoding is not usable ({error}): save it as UTF-8.") from error


def page(root: Element, unit: str | None, usual_unit: str | None) -> tuple[Placement, list[str]]:
    """The map from user units to mm with y up, and a remark when the user's unit overrides the file's size.

    Raises
    ------
    InputError
        When the size of a user unit is not known, or differs between x and y.
    """
    width, height = physical_length(root.get("width")), physical_length(root.get("height"))
    box = viewbox(root)
    scale = file_scale(root, width, height, box)
    remarks = []
    if scale is None and unit is None:
        unit = usual_unit
    if unit is not None:
        asked = unit_named(unit).millimetres
        if scale is not None and abs(scale - asked) > 1e-9 * asked:
            remarks.append(f"The file's size makes a user unit {scale:.6g} mm; it was read as 1 {unit} as asked.")
        scale = asked
    if scale is None:
        raise InputError(
            "the drawing has no physical size (width and height in mm, cm or in): give the size of its user unit with "
            "--unit mm (or inch, cm, m)."
        )
    left, low = 0.0, 0.0
    if box is not None:
        left, low = box[0], box[1] + box[3]
    elif height is not None:
        low = height / scale if unit is None else 0.0
    return Placement(scale, 0.0, 0.0, -scale, -scale * left, scale * low), remarks


def viewbox(root: Element) -> tuple[float, float, float, float] | None:
    """The root's viewBox.

    Raises
    ------
    InputError
        When it is not four numbers with a positive size.
    """
    text = root.get("viewBox")
    if text is None:
        return None
    values = numbers(text, "the viewBox")
    if len(values) != 4 or not (values[2] > 0 and values[3] > 0):
        raise InputError(f"the viewBox '{text[:60]}' is not usable: it must be x y width height.")
    return values[0], values[1], values[2], values[3]


def file_scale(
    root: Element, width: float | None, height: float | None, box: tuple[float, float, float, float] | None
) -> float | None:
    """Millimetres per user unit by the file's own physical size in mm; None when it has none.

    Raises
    ------
    InputError
        When x and y would be scaled unequally.
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
        aspect = root.get("preserveAspectRatio", "xMidYMid meet")
        # Sizes are written with few digits; a drawing distorted on purpose is far from square.
        if aspect.strip().startswith("none") and abs(scales[0] - scales[1]) > 1e-3 * max(scales):
            raise InputError("width, height and viewBox scale x and y unequally: make them agree.")
        return max(scales) if aspect.strip().endswith("slice") else min(scales)
    return scales[0]


@frozen
class Nest:
    """Where the walk stands: the map to mm, whether visibility is off, and the names of the <use> elements around."""

    placement: Placement
    invisible: bool = False
    suffix: str = ""
    links: tuple[str, ...] = ()


class SvgWalk:
    """Collects the chains of a document's elements, and what was left out."""

    def __init__(self, root: Element) -> None:
        self.by_id = {element.get("id", ""): element for element in root.iter() if element.get("id")}
        self.hidden_selectors = hidden_selectors(root)
        self.chains: list[Chain] = []
        self.hidden = 0
        self.ignored: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()
        self.count = 0

    def visit_children(self, parent: Element, nest: Nest) -> None:
        """Visit the elements in a container."""
        for element in parent:
            if isinstance(element.tag, str) and (element.tag.startswith(SVG_SPACE) or "}" not in element.tag):
                self.visit(element, nest)

    def visit(self, element: Element, nest: Nest) -> None:
        """Collect one element and those inside it.

        Raises
        ------
        InputError
            For an element that is refused, naming it.
        """
        self.count += 1
        if self.count > MOST_ELEMENTS:
            raise InputError(
                f"the drawing has more than {MOST_ELEMENTS} elements once <use> is written out: simplify it."
            )
        tag = local_name(element)
        if tag in SILENT:
            return
        if is_hidden(element, self.hidden_selectors, tag):
            self.hidden += 1
            return
        self.counts[tag] += 1
        name = named(element, tag, self.counts[tag])
        label = name + nest.suffix
        placement = nest.placement.after(transform_of(element, label))
        inner = evolve(nest, placement=placement, invisible=is_invisible(element, nest.invisible))
        if tag in CONTAINERS:
            if tag == "svg":
                raise InputError(f"{label} is a drawing nested in the drawing, which is not read: ungroup it first.")
            self.visit_children(element, inner)
        elif tag == "use":
            self.visit_use(element, inner, name)
        elif tag in SHAPES:
            if inner.invisible:
                self.hidden += 1
            else:
                self.add(SHAPES[tag](element, label), placement, label)
        else:
            self.ignored[tag] += 1

    def visit_use(self, element: Element, nest: Nest, name: str) -> None:
        """Visit what a <use> shows.

        Raises
        ------
        InputError
            For links to nothing, to other files, to themselves, and to symbols with a viewBox.
        """
        label = name + nest.suffix
        link = element.get("href") or element.get(LINK) or ""
        target = self.by_id.get(link[1:]) if link.startswith("#") else None
        if target is None:
            raise InputError(f"{label} shows '{link[:60]}', which is not in the file: unlink or remove it.")
        if link in nest.links or len(nest.links) >= DEEPEST:
            raise InputError(f"{label} shows itself: unlink it.")
        if target.get("viewBox"):
            raise InputError(f"{label} shows a symbol with a viewBox of its own, which is not read: unlink it first.")
        shift = Placement(e=length(element, "x", label), f=length(element, "y", label))
        inner = evolve(
            nest,
            placement=nest.placement.after(shift),
            suffix=f" of {name}{nest.suffix}",
            links=(*nest.links, link),
        )
        if local_name(target) == "symbol":
            self.visit_children(target, inner)
        else:
            self.visit(target, inner)

    def add(self, shapes: Iterator[Shape], placement: Placement, label: str) -> None:
        """Add the chains of one element.

        Raises
        ------
        InputError
            For transforms that crush the drawing or make arcs elliptical.
        """
        if placement.flat:
            raise InputError(f"{label} has a transform that crushes it to a line: correct it.")
        for shape in shapes:
            if any(shape.bulges) and not placement.keeps_circles:
                x, y = shape.points[0]
                raise InputError(
                    f"{label} at ({x:.6g}, {y:.6g}) has arcs that its transform turns into ellipses: scale x and y "
                    "equally, without skew."
                )
            points = tuple(placement(point) for point in shape.points)
            self.chains.append(Chain(points, placement.bulges(shape.bulges), shape.labels))

    def remarks(self) -> list[str]:
        """What was left out, one sentence for each reason."""
        remarks = []
        if self.ignored:
            kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(self.ignored.items()))
            remarks.append(f"Ignored elements that are no outline: {kinds}.")
        if self.hidden:
            remarks.append(
                f"Left out {counted(self.hidden, 'hidden element', 'hidden elements')}; make them visible to read them."
            )
        return remarks
