"""The walk through a drawing's elements, which collects the chains of visible shapes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from xml.etree.ElementTree import Element

from attrs import evolve, frozen

from workhold.errors import InputError, shorten_middle
from workhold.files.budget import Budget
from workhold.files.outline.chain import Chain, Placement, format_count
from workhold.files.outline.curves import CurveReader
from workhold.files.svg.document import (
    DeclaredStyles,
    DeclaredValue,
    SvgDocument,
    get_local_name,
    read_link,
    shorten_text,
)
from workhold.files.svg.shapes import SHAPES
from workhold.files.svg.style import (
    INITIAL,
    ComputedStyle,
    compute_style,
    keep_painted_boundaries,
    refuse_effects,
    split_link,
)
from workhold.files.svg.transforms import read_transform
from workhold.files.svg.viewport import (
    LARGEST,
    ClipPolygon,
    ShapeElement,
    Viewport,
    fit_viewbox,
    is_convex,
    read_viewbox,
)

__all__ = ["ElementNesting", "SvgWalk"]

CONTAINERS = {"g", "a", "switch"}
SILENT = {"defs", "symbol", "style", "title", "desc", "metadata", "clipPath", "mask", "marker", "pattern"}
SILENT |= {"filter", "linearGradient", "radialGradient", "view", "namedview"}
FEATURES = "http://www.w3.org/TR/SVG11/feature#"
# Letters that tell where a <use> is in others, and mm for a user unit.
LONGEST_SUFFIX, MOST_SCALE = 300, 1e15
# What tells cuts from other lines, as programs for lasers do.
LOOKS = ("stroke", "stroke-dasharray")
MARKED = ("path", "line", "polyline", "polygon")
# What shows all that is in it where it is linked to, and how deep that is looked at before it is visited.
CONTAINERS_FORESEEN, MOST_FORESEEN = {"g", "a", "svg", "symbol"}, 100
CONDITIONS = ("requiredExtensions", "systemLanguage", "requiredFeatures")


@frozen
class ElementNesting:
    """The state that the walk passes from an element to those inside it.

    Parameters
    ----------
    placement : the map from user units to mm.
    viewport : the size that percentages refer to.
    style : the computed style of the elements around.
    windows : polygons outside which nothing of the drawing is shown.
    suffix, links : the <use> elements around, for messages and against endless nesting.
    anchored : whether it is within an <a>.
    look : colour and dashes of lines, as they are written.
    """

    placement: Placement
    viewport: Viewport
    style: ComputedStyle = INITIAL
    windows: tuple[ClipPolygon, ...] = ()
    suffix: str = ""
    links: tuple[str, ...] = ()
    anchored: bool = False
    look: tuple[str, ...] = ("", "")


class SvgWalk:
    """A walk that collects the chains of a document's elements, and counts what was left out."""

    def __init__(
        self, document: SvgDocument, styles: DeclaredStyles, fit: float | None, budget: Budget
    ) -> None:
        self.budget = budget
        self.curves = CurveReader(fit)
        self.document = document
        self.styles = styles
        self.chains: list[Chain] = []
        self.looks: dict[str, str] = {}
        self.hidden = 0
        self.painted_over = 0
        self.ignored: Counter[str] = Counter()
        # How many elements one is, those of <use> written out, once that was asked.
        self.sizes: dict[Element, int] = {}

    def visit(self, element: Element, nest: ElementNesting) -> None:
        """Collect the chains of an element and those inside it; definitions and metadata are skipped."""
        self.budget.spend()
        tag = get_local_name(element)
        if tag in SILENT:
            return
        figure = self.make_shape_element(element, nest)
        label = figure.label
        with self.budget.count_nesting(label):
            try:
                self.visit_figure(figure, nest)
            except ArithmeticError as error:
                raise InputError(
                    f"{label} has numbers too large or too small to be reckoned with: correct them."
                ) from error

    def visit_figure(self, figure: ShapeElement, nest: ElementNesting) -> None:
        """Collect the chains of an element that has been read, or count it as hidden or ignored."""
        element, label = figure.element, figure.label
        tag = get_local_name(element)
        style = compute_style(figure.declarations, nest.style, self.styles, label)
        if not (style.displayed and suits_conditions(element, label)):
            self.hidden += 1
            return
        refuse_effects(figure)
        placement = nest.placement.compose_after(read_transform(figure))
        if tag == "use":
            placement = placement.compose_after(
                Placement(e=figure.read_length("x"), f=figure.read_length("y"))
            )
        refuse_huge_placement(placement, label)
        look = tuple(
            figure.declarations[name][0].text if name in figure.declarations else around
            for name, around in zip(LOOKS, nest.look, strict=True)
        )
        inner = self.clip_nesting(figure, evolve(nest, placement=placement, style=style, look=look))
        if element is self.document.root:
            if placement != nest.placement:
                raise InputError(
                    f"{label} has a transform, which programs draw differently: put it on a group."
                )
            self.visit_children(element, inner)
        elif tag in CONTAINERS:
            if tag == "a" and nest.anchored:
                raise InputError(f"{label} is a link within a link, which not all programs show: ungroup it.")
            self.visit_children(element, evolve(inner, anchored=nest.anchored or tag == "a"))
        elif tag == "svg":
            self.visit_view(figure, inner, (figure.read_length("x"), figure.read_length("y")), figure)
        elif tag == "use":
            self.visit_use(figure, inner)
        elif tag in SHAPES:
            self.visit_shape(figure, inner)
        else:
            self.ignored[tag] += style.shown

    def make_shape_element(self, element: Element, nest: ElementNesting) -> ShapeElement:
        """Return an element with its declared values and its name for messages."""
        label = self.document.name(element) + nest.suffix
        return ShapeElement(
            element, label, self.styles.list_declared_values(element), nest.viewport, self.budget
        )

    def visit_children(self, parent: Element, nest: ElementNesting) -> None:
        """Visit the elements in a container; in a <switch> only the first
        element whose conditions hold (SVG 2, 5.9.2).
        """
        for element in parent:
            if not self.document.is_svg_element(element):
                continue
            if get_local_name(parent) == "switch":
                label = self.document.name(element) + nest.suffix
                if not suits_conditions(element, label):
                    continue
                if get_local_name(element) in SILENT | {"a", "foreignObject"}:
                    raise InputError(
                        f"{label} is the choice of a switch, which not all programs show: remove it."
                    )
                self.visit(element, nest)
                return
            self.visit(element, nest)

    def visit_shape(self, figure: ShapeElement, nest: ElementNesting) -> None:
        """Append the chains of a shape that is seen; raise InputError for a shape that a window cuts or a
        transform makes flat.
        """
        style, label = nest.style, figure.label
        if not style.shown or not (style.stroked or style.filled):
            self.hidden += 1
            return
        if style.markers and get_local_name(figure.element) in MARKED:
            self.ignored["marker"] += 1
        if nest.placement.flat:
            raise InputError(f"{label} has a transform that crushes it to a line: correct it.")
        found = list(self.place_shape(figure, nest))
        if not style.stroked and not style.even_odd and len(found) > 1:
            bounding = keep_painted_boundaries(found, self.budget)
            self.painted_over += len(found) - len(bounding)
            found = bounding
        self.hidden += not found
        for window in nest.windows:
            shown = {window.classify_visibility(chain, self.budget) for chain in found}
            if shown == {"nothing"}:
                self.hidden += 1
                return
            if shown - {"all"}:
                raise InputError(
                    f"{label} is cut by {window.label}: cut the shape itself, or remove what cuts it."
                )
        self.chains += found
        look = " ".join(nest.look).strip().lower()
        if look:
            self.looks.update((label, look) for chain in found for label in chain.labels)

    def place_shape(self, figure: ShapeElement, nest: ElementNesting) -> Iterator[Chain]:
        """Yield the chains of a shape in mm.

        A shape without a stroke is closed, because a fill is bounded by closed loops; a single line without a
        stroke yields nothing.
        """
        for shape in SHAPES[get_local_name(figure.element)](figure):
            if not nest.style.stroked:
                if len(shape.bulges) == 1 and not shape.bulges[0] and not shape.curved:
                    continue  # a line has nothing to fill
                shape = shape.close()
            chain = self.curves.make_chain(
                shape.points, shape.bulges, shape.labels, shape.curved, nest.placement
            )
            if chain is not None:
                yield chain

    def visit_use(self, figure: ShapeElement, nest: ElementNesting) -> None:
        """Visit the elements that a <use> shows.

        Raises InputError for a link to nothing or to another file, and for a <use> that shows itself,
        directly or through another <use>.
        """
        label, link = figure.label, read_link(figure.element)
        target = self.document.find_linked(link)
        if target is None:
            raise InputError(
                f"{label} shows '{shorten_text(link)}', which is not in the file: unlink or remove it."
            )
        if link in nest.links:
            raise InputError(f"{label} shows itself: unlink it.")
        self.budget.refuse_too_many_ahead(self.count_shown_elements(target))
        inner = evolve(nest, suffix=shorten_middle(f" of {label}", LONGEST_SUFFIX), links=(*nest.links, link))
        tag = get_local_name(target)
        if tag in ("symbol", "svg"):
            with self.budget.count_nesting(label):
                self.visit_target(target, figure, inner)
        else:
            self.visit(target, inner)

    def count_shown_elements(self, element: Element, depth: int = 0) -> int:
        """Return a lower bound of the number of elements visited where an element is shown.

        Elements inside it count, and those that a <use> shows count each time.
        """
        tag = get_local_name(element)
        if (
            element in self.sizes
            or depth > MOST_FORESEEN
            or may_be_hidden(element, self.styles.list_declared_values(element))
        ):
            return self.sizes.get(element, 1)
        # What shows itself is refused when it is visited.
        self.sizes[element] = 1
        shown: list[Element] = []
        if tag == "use":
            target = self.document.find_linked(read_link(element))
            shown = [] if target is None else [target]
        elif tag in CONTAINERS_FORESEEN:
            shown = [one for one in element if self.document.is_svg_element(one)]
        self.sizes[element] = 1 + sum(self.count_shown_elements(one, depth + 1) for one in shown)
        return self.sizes[element]

    def visit_target(self, target: Element, use: ShapeElement, nest: ElementNesting) -> None:
        """Visit a symbol or nested drawing in the size that a <use> gives it (SVG 2, 5.5 and 5.6).

        Raises InputError for a transform, and for a size or reference point of a symbol that programs draw
        differently.
        """
        own = self.make_shape_element(target, nest)
        label = own.label
        style = compute_style(own.declarations, nest.style, self.styles, label)
        if not (style.displayed and suits_conditions(target, label)):
            raise InputError(
                f"{label} is switched off itself, which programs take differently: switch off the use."
            )
        refuse_effects(own)
        inner = self.clip_nesting(own, evolve(nest, style=style))
        if get_local_name(target) == "symbol":
            names = [
                "x",
                "y",
                "refX",
                "refY",
                *(n for n in ("width", "height") if use.find_given_value(n) is None),
            ]
            if any(own.find_given_value(name) is not None for name in names):
                raise InputError(
                    f"{label} has a place or size, which programs draw differently: give them to the use."
                )
            self.visit_view(own, inner, (0.0, 0.0), use)
        else:
            self.visit_view(own, inner, (own.read_length("x"), own.read_length("y")), use)

    def visit_view(
        self, figure: ShapeElement, nest: ElementNesting, corner: tuple[float, float], sizes: ShapeElement
    ) -> None:
        """Visit the children of a nested drawing or symbol in its own viewport.

        Raises InputError for a transform, which programs draw differently, and for sizes that are not known.

        Parameters
        ----------
        corner : x and y of the viewport in user units.
        sizes : the element whose width and height count; those of ``figure`` where it has none.
        """
        element, label = figure.element, figure.label
        if read_transform(figure) != Placement():
            raise InputError(f"{label} has a transform, which programs draw differently: put it on a group.")
        box = read_viewbox(element.get("viewBox"), label, self.budget)
        sides: list[float | None] = []
        for name in ("width", "height"):
            asked = sizes.find_given_value(name)
            giver = figure if asked is None or asked.text == "auto" else sizes
            whole = figure.viewport[name == "height"]
            sides.append(
                whole if giver.find_given_value(name) is None else giver.read_length(name, default=-1.0)
            )
        width, height = sides
        view = nest.placement.compose_after(Placement(e=corner[0], f=corner[1]))
        if width is None or height is None:
            if box is not None:
                raise InputError(f"{label} has a viewBox, but no size: give it width and height.")
        elif not (width > 0 and height > 0):
            self.hidden += 1
            return
        elif not shows_overflow(figure.declarations):
            corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0))
            window = ClipPolygon(tuple(map(view, corners)), f"the edge of {label}")
            nest = evolve(nest, windows=(*nest.windows, window))
        if box is not None and width is not None and height is not None:
            view = view.compose_after(
                fit_viewbox(box, width, height, element.get("preserveAspectRatio", ""), label)
            )
            width, height = box[2], box[3]
        self.visit_children(element, evolve(nest, placement=view, viewport=(width, height)))

    def clip_nesting(self, figure: ShapeElement, nest: ElementNesting) -> ElementNesting:
        """Return the nesting with the window of an element's ``clip-path`` added.

        Raises InputError for a clip path that is not one convex polygon.
        """
        declarations, label, element = figure.declarations, figure.label, figure.element
        text = declarations["clip-path"][0].text if "clip-path" in declarations else "none"
        if text.lower() in ("none", "initial", "unset", ""):
            return nest
        error = InputError(
            f"{label} has the clip-path '{shorten_text(text)}', which is not one plain rectangle or convex "
            "polygon: cut the drawing itself, or release the clip."
        )
        # A drawing has two coordinate systems, outside and inside; programs differ in which of them a clip
        # path is.
        target = (
            self.document.find_linked(read_link(element)) if get_local_name(element) == "use" else element
        )
        if target is not None and get_local_name(target) in ("svg", "symbol"):
            raise InputError(
                f"{label} has a clip-path, which programs place differently: put it on a group around."
            )
        link = split_link(text)
        clip = None if link is None or link[1] else self.document.find_linked(link[0])
        if (
            clip is None
            or get_local_name(clip) != "clipPath"
            or clip.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse"
        ):
            raise error
        shapes = [child for child in clip if get_local_name(child) not in SILENT]
        placement = nest.placement
        style = INITIAL
        for outer in self.document.list_ancestors(clip):
            style = compute_style(self.styles.list_declared_values(outer), style, self.styles, label)
        for part in (clip, *shapes[:1]):
            values = self.styles.list_declared_values(part)
            style = compute_style(values, style, self.styles, label)
            if (
                "clip-path" in values
                or not (style.displayed and style.shown)
                or not suits_conditions(part, label)
            ):
                raise error
            own = ShapeElement(part, self.document.name(part), values, nest.viewport, self.budget)
            refuse_effects(evolve(own, label=label))
            placement = placement.compose_after(read_transform(own))
            refuse_huge_placement(placement, label)
        if len(shapes) != 1 or not self.document.is_svg_element(shapes[0]):
            raise error
        tag = get_local_name(shapes[0])
        outlines = list(SHAPES[tag](own)) if tag in ("rect", "polygon", "path") else []
        if len(outlines) != 1 or any(outlines[0].bulges) or not is_convex(outlines[0].close().points):
            raise error
        window = ClipPolygon(tuple(map(placement, outlines[0].close().points)), f"the clip-path of {label}")
        return evolve(nest, windows=(*nest.windows, window))

    def list_remarks(self) -> list[str]:
        """Return sentences on what was left out, one for each reason."""
        remarks = []
        if +self.ignored:
            kinds = ", ".join(f"{count} {kind}" for kind, count in sorted((+self.ignored).items()))
            remarks.append(f"Ignored elements that are not an outline: {kinds}.")
        if self.painted_over:
            remarks.append(
                f"Left out {format_count(self.painted_over, 'loop that is', 'loops that are')} painted over by "
                "the rest of the "
                "shape (fill-rule nonzero); for a hole, use the even-odd rule or turn the loop round."
            )
        if self.hidden:
            remarks.append(
                f"Left out {format_count(self.hidden, 'hidden element', 'hidden elements')} (switched off, "
                "transparent, empty, or without fill and stroke); make them visible to read them."
            )
        return remarks


def refuse_huge_placement(placement: Placement, label: str) -> None:
    """Raise InputError for a map to mm with factors or shifts too large for arithmetic."""
    numbers = (placement.a, placement.b, placement.c, placement.d)
    if not (
        all(abs(number) <= MOST_SCALE for number in numbers)
        and abs(placement.e) <= LARGEST
        and abs(placement.f) <= LARGEST
    ):
        raise InputError(f"{label} has a transform or size that is too large: correct it.")


def suits_conditions(element: Element, label: str) -> bool:
    """Return whether an element's conditions hold (SVG 2, 5.9);
    raise InputError where programs judge them differently.
    """
    if element.get("requiredExtensions") is not None:
        return False
    if element.get("systemLanguage") is not None:
        raise InputError(
            f"{label} is shown in some languages only (systemLanguage): keep one, without the condition."
        )
    if not all(name.startswith(FEATURES) for name in element.get("requiredFeatures", "").split()):
        raise InputError(
            f"{label} is shown by some programs only (requiredFeatures): remove it, or the condition."
        )
    return True


def shows_overflow(declarations: dict[str, list[DeclaredValue]]) -> bool:
    """Return whether a nested drawing shows what reaches beyond its edge, from its declared ``overflow``."""
    names = ("overflow", "overflow-x", "overflow-y")
    given = [declarations[name][0].text for name in names if name in declarations]
    return bool(given) and all(text in ("visible", "auto") for text in given)


def may_be_hidden(element: Element, declarations: dict[str, list[DeclaredValue]]) -> bool:
    """Return whether an element has a condition, a ``display`` or an ``opacity``,
    any of which may hide it and everything in it.
    """
    is_conditional = any(element.get(name) is not None for name in CONDITIONS)
    return is_conditional or "display" in declarations or "opacity" in declarations
