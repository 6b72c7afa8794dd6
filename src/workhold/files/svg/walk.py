"""The walk through a drawing's elements: what is seen, where it is, and what messages call it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from xml.etree.ElementTree import Element

from attrs import evolve, frozen

from workhold.errors import InputError, shortened
from workhold.files.budget import Budget
from workhold.files.outline.chain import Chain, Placement, counted
from workhold.files.outline.curves import CurveReader
from workhold.files.svg.document import Declared, Document, Styles, href, local_name, short
from workhold.files.svg.shapes import SHAPES
from workhold.files.svg.style import INITIAL, Style, boundaries, computed, link_of, refuse_effects
from workhold.files.svg.transforms import transform_of
from workhold.files.svg.viewport import (
    LARGEST,
    ShapeElement,
    Viewport,
    Window,
    convex,
    fitted,
    viewbox_of,
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
    """Where the walk stands.

    Parameters
    ----------
    placement : the map to mm.
    viewport : what percentages are of.
    style : the style around.
    windows : what hides parts of the drawing.
    suffix, links : the <use> elements around, for messages and against endless nesting.
    anchored : whether it is within an <a>.
    look : colour and dashes of lines, as they are written.
    """

    placement: Placement
    viewport: Viewport
    style: Style = INITIAL
    windows: tuple[Window, ...] = ()
    suffix: str = ""
    links: tuple[str, ...] = ()
    anchored: bool = False
    look: tuple[str, ...] = ("", "")


class SvgWalk:
    """Collects the chains of a document's elements, and what was left out."""

    def __init__(self, document: Document, styles: Styles, fit: float | None, budget: Budget) -> None:
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
        self.budget.spend()
        tag = local_name(element)
        if tag in SILENT:
            return
        figure = self.figure(element, nest)
        label = figure.label
        with self.budget.nested(label):
            try:
                self.visit_figure(figure, nest)
            except ArithmeticError as error:
                raise InputError(
                    f"{label} has numbers too large or too small to be reckoned with: correct them."
                ) from error

    def visit_figure(self, figure: ShapeElement, nest: ElementNesting) -> None:
        element, label = figure.element, figure.label
        tag = local_name(element)
        style = computed(figure.declarations, nest.style, self.styles, label)
        if not (style.displayed and suits(element, label)):
            self.hidden += 1
            return
        refuse_effects(figure)
        placement = nest.placement.after(transform_of(figure))
        if tag == "use":
            placement = placement.after(Placement(e=figure.length("x"), f=figure.length("y")))
        refuse_absurd(placement, label)
        look = tuple(
            figure.declarations[name][0].text if name in figure.declarations else around
            for name, around in zip(LOOKS, nest.look, strict=True)
        )
        inner = self.clipped(figure, evolve(nest, placement=placement, style=style, look=look))
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
            self.visit_view(figure, inner, (figure.length("x"), figure.length("y")), figure)
        elif tag == "use":
            self.visit_use(figure, inner)
        elif tag in SHAPES:
            self.visit_shape(figure, inner)
        else:
            self.ignored[tag] += style.shown

    def figure(self, element: Element, nest: ElementNesting) -> ShapeElement:
        """An element with its values and what messages call it."""
        label = self.document.name(element) + nest.suffix
        return ShapeElement(element, label, self.styles.of(element), nest.viewport, self.budget)

    def visit_children(self, parent: Element, nest: ElementNesting) -> None:
        """Visits the elements in a container; of a <switch>, the first that suits (SVG 2, 5.9.2)."""
        for element in parent:
            if not self.document.drawn(element):
                continue
            if local_name(parent) == "switch":
                label = self.document.name(element) + nest.suffix
                if not suits(element, label):
                    continue
                if local_name(element) in SILENT | {"a", "foreignObject"}:
                    raise InputError(
                        f"{label} is the choice of a switch, which not all programs show: remove it."
                    )
                self.visit(element, nest)
                return
            self.visit(element, nest)

    def visit_shape(self, figure: ShapeElement, nest: ElementNesting) -> None:
        """Adds the chains of a shape that is seen; refuses transforms that crush the drawing."""
        style, label = nest.style, figure.label
        if not style.shown or not (style.stroked or style.filled):
            self.hidden += 1
            return
        if style.markers and local_name(figure.element) in MARKED:
            self.ignored["marker"] += 1
        if nest.placement.flat:
            raise InputError(f"{label} has a transform that crushes it to a line: correct it.")
        found = list(self.placed(figure, nest))
        if not style.stroked and not style.even_odd and len(found) > 1:
            bounding = boundaries(found, self.budget)
            self.painted_over += len(found) - len(bounding)
            found = bounding
        self.hidden += not found
        for window in nest.windows:
            shown = {window.shows(chain, self.budget) for chain in found}
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

    def placed(self, figure: ShapeElement, nest: ElementNesting) -> Iterator[Chain]:
        """The chains of a shape in mm; of a shape without stroke, what bounds its fill."""
        for shape in SHAPES[local_name(figure.element)](figure):
            if not nest.style.stroked:
                if len(shape.bulges) == 1 and not shape.bulges[0] and not shape.curved:
                    continue  # a line has nothing to fill
                shape = shape.closed()
            chain = self.curves.chain(shape.points, shape.bulges, shape.labels, shape.curved, nest.placement)
            if chain is not None:
                yield chain

    def visit_use(self, figure: ShapeElement, nest: ElementNesting) -> None:
        """Visits what a <use> shows; refuses links to nothing, to other files and to themselves."""
        label, link = figure.label, href(figure.element)
        target = self.document.linked(link)
        if target is None:
            raise InputError(f"{label} shows '{short(link)}', which is not in the file: unlink or remove it.")
        if link in nest.links:
            raise InputError(f"{label} shows itself: unlink it.")
        self.budget.foresee(self.written_out(target))
        inner = evolve(nest, suffix=shortened(f" of {label}", LONGEST_SUFFIX), links=(*nest.links, link))
        tag = local_name(target)
        if tag in ("symbol", "svg"):
            with self.budget.nested(label):
                self.visit_target(target, figure, inner)
        else:
            self.visit(target, inner)

    def written_out(self, element: Element, depth: int = 0) -> int:
        """How many elements are visited at least where one is shown; links double it from one to the next."""
        tag = local_name(element)
        if element in self.sizes or depth > MOST_FORESEEN or may_be_hidden(element, self.styles.of(element)):
            return self.sizes.get(element, 1)
        # What shows itself is refused when it is visited.
        self.sizes[element] = 1
        shown: list[Element] = []
        if tag == "use":
            target = self.document.linked(href(element))
            shown = [] if target is None else [target]
        elif tag in CONTAINERS_FORESEEN:
            shown = [one for one in element if self.document.drawn(one)]
        self.sizes[element] = 1 + sum(self.written_out(one, depth + 1) for one in shown)
        return self.sizes[element]

    def visit_target(self, target: Element, use: ShapeElement, nest: ElementNesting) -> None:
        """Visits a symbol or nested drawing in the size that a <use> gives it (SVG 2, 5.5 and 5.6).

        Refuses a transform, size or reference point of a symbol, which programs draw differently.
        """
        own = self.figure(target, nest)
        label = own.label
        style = computed(own.declarations, nest.style, self.styles, label)
        if not (style.displayed and suits(target, label)):
            raise InputError(
                f"{label} is switched off itself, which programs take differently: switch off the use."
            )
        refuse_effects(own)
        inner = self.clipped(own, evolve(nest, style=style))
        if local_name(target) == "symbol":
            names = ["x", "y", "refX", "refY", *(n for n in ("width", "height") if use.given(n) is None)]
            if any(own.given(name) is not None for name in names):
                raise InputError(
                    f"{label} has a place or size, which programs draw differently: give them to the use."
                )
            self.visit_view(own, inner, (0.0, 0.0), use)
        else:
            self.visit_view(own, inner, (own.length("x"), own.length("y")), use)

    def visit_view(
        self, figure: ShapeElement, nest: ElementNesting, corner: tuple[float, float], sizes: ShapeElement
    ) -> None:
        """Visits the children of a nested drawing or symbol in its own viewport.

        Refuses a transform, which programs draw differently, and sizes that are not known.
        """
        element, label = figure.element, figure.label
        if transform_of(figure) != Placement():
            raise InputError(f"{label} has a transform, which programs draw differently: put it on a group.")
        box = viewbox_of(element.get("viewBox"), label, self.budget)
        sides: list[float | None] = []
        for name in ("width", "height"):
            asked = sizes.given(name)
            giver = figure if asked is None or asked.text == "auto" else sizes
            whole = figure.viewport[name == "height"]
            sides.append(whole if giver.given(name) is None else giver.length(name, default=-1.0))
        width, height = sides
        view = nest.placement.after(Placement(e=corner[0], f=corner[1]))
        if width is None or height is None:
            if box is not None:
                raise InputError(f"{label} has a viewBox, but no size: give it width and height.")
        elif not (width > 0 and height > 0):
            self.hidden += 1
            return
        elif not visible_overflow(figure.declarations):
            corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height), (0.0, 0.0))
            window = Window(tuple(map(view, corners)), f"the edge of {label}")
            nest = evolve(nest, windows=(*nest.windows, window))
        if box is not None and width is not None and height is not None:
            view = view.after(fitted(box, width, height, element.get("preserveAspectRatio", ""), label))
            width, height = box[2], box[3]
        self.visit_children(element, evolve(nest, placement=view, viewport=(width, height)))

    def clipped(self, figure: ShapeElement, nest: ElementNesting) -> ElementNesting:
        """The nest with the window of an element's ``clip-path``; refuses any but one convex polygon."""
        declarations, label, element = figure.declarations, figure.label, figure.element
        text = declarations["clip-path"][0].text if "clip-path" in declarations else "none"
        if text.lower() in ("none", "initial", "unset", ""):
            return nest
        error = InputError(
            f"{label} has the clip-path '{short(text)}', which is not one plain rectangle or convex "
            "polygon: cut the drawing itself, or release the clip."
        )
        # A drawing has two coordinate systems, outside and inside; programs differ in which of them a clip
        # path is.
        target = self.document.linked(href(element)) if local_name(element) == "use" else element
        if target is not None and local_name(target) in ("svg", "symbol"):
            raise InputError(
                f"{label} has a clip-path, which programs place differently: put it on a group around."
            )
        link = link_of(text)
        clip = None if link is None or link[1] else self.document.linked(link[0])
        if (
            clip is None
            or local_name(clip) != "clipPath"
            or clip.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse"
        ):
            raise error
        shapes = [child for child in clip if local_name(child) not in SILENT]
        placement = nest.placement
        style = INITIAL
        for outer in self.document.around(clip):
            style = computed(self.styles.of(outer), style, self.styles, label)
        for part in (clip, *shapes[:1]):
            values = self.styles.of(part)
            style = computed(values, style, self.styles, label)
            if "clip-path" in values or not (style.displayed and style.shown) or not suits(part, label):
                raise error
            own = ShapeElement(part, self.document.name(part), values, nest.viewport, self.budget)
            refuse_effects(evolve(own, label=label))
            placement = placement.after(transform_of(own))
            refuse_absurd(placement, label)
        if len(shapes) != 1 or not self.document.drawn(shapes[0]):
            raise error
        tag = local_name(shapes[0])
        outlines = list(SHAPES[tag](own)) if tag in ("rect", "polygon", "path") else []
        if len(outlines) != 1 or any(outlines[0].bulges) or not convex(outlines[0].closed().points):
            raise error
        window = Window(tuple(map(placement, outlines[0].closed().points)), f"the clip-path of {label}")
        return evolve(nest, windows=(*nest.windows, window))

    def remarks(self) -> list[str]:
        """What was left out, one sentence for each reason."""
        remarks = []
        if +self.ignored:
            kinds = ", ".join(f"{count} {kind}" for kind, count in sorted((+self.ignored).items()))
            remarks.append(f"Ignored elements that are no outline: {kinds}.")
        if self.painted_over:
            remarks.append(
                f"Left out {counted(self.painted_over, 'loop that is', 'loops that are')} painted over by "
                "the rest of the "
                "shape (fill-rule nonzero); for a hole, use the even-odd rule or turn the loop round."
            )
        if self.hidden:
            remarks.append(
                f"Left out {counted(self.hidden, 'hidden element', 'hidden elements')} (switched off, "
                "transparent, empty, or without fill and stroke); make them visible to read them."
            )
        return remarks


def refuse_absurd(placement: Placement, label: str) -> None:
    """Refuses a map to mm with which nothing can be reckoned."""
    numbers = (placement.a, placement.b, placement.c, placement.d)
    if not (
        all(abs(number) <= MOST_SCALE for number in numbers)
        and abs(placement.e) <= LARGEST
        and abs(placement.f) <= LARGEST
    ):
        raise InputError(f"{label} has a transform or size that is too large: correct it.")


def suits(element: Element, label: str) -> bool:
    """Whether an element's conditions hold (SVG 2, 5.9); refuses conditions that programs judge differently."""
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


def visible_overflow(declarations: dict[str, list[Declared]]) -> bool:
    """Whether a nested drawing shows what reaches over its edge."""
    names = ("overflow", "overflow-x", "overflow-y")
    given = [declarations[name][0].text for name in names if name in declarations]
    return bool(given) and all(text in ("visible", "auto") for text in given)


def may_be_hidden(element: Element, declarations: dict[str, list[Declared]]) -> bool:
    """Whether something says of an element that it may be taken away with all that is in it."""
    is_conditional = any(element.get(name) is not None for name in CONDITIONS)
    return is_conditional or "display" in declarations or "opacity" in declarations
