"""Computed styles: whether an element is seen, and which of its loops bound its paint.

A shape counts when its author sees its fill or its stroke (SVG 2, chapters 11 and 13), in whatever colour.
That follows from the computed values of ``display``, ``visibility``, ``opacity``, paints and their like.
Inside one fill, a loop in another may be painted over (SVG 2, 13.4.2).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from math import pi
from typing import TypeVar
from xml.etree.ElementTree import Element

import numpy as np
from attrs import frozen

from workhold.errors import InputError
from workhold.files.budget import Budget
from workhold.files.outline.chain import Chain, drop_zero_lengths
from workhold.files.outline.joining import make_closed_loop
from workhold.files.svg.document import DeclaredStyles, DeclaredValue, get_local_name, read_link, shorten_text
from workhold.files.svg.viewport import LENGTH, ShapeElement
from workhold.geometry.loop import LoopShape, compute_signed_area, make_loop_segments, refuse_meeting_loops
from workhold.kernels.base.distance import measure_winding

__all__ = [
    "INITIAL",
    "ComputedStyle",
    "keep_painted_boundaries",
    "compute_style",
    "split_link",
    "refuse_effects",
]

Value = TypeVar("Value")
Declarations = dict[str, list[DeclaredValue]]

HEX = re.compile(r"#(?:[0-9a-f]{3,4}|[0-9a-f]{6}|[0-9a-f]{8})$")
# Without ways back over blanks, which would take the square of their number.
URL = re.compile(
    r"""url\(\s*+(?:"([^"]*)"|'([^']*)'|([^"')\s]*+))\s*+\)\s*+(.*)$""", re.DOTALL | re.IGNORECASE
)
DISPLAYS = re.compile(
    r"(?:none|contents|inline|list-item|run-in|compact|marker|flow-root"
    r"|(?:inline-)?(?:table|flex|grid|block)|ruby|table-[a-z-]+)$"
)
PROFILE = re.compile(r"(?<!\s)\s+(?:icc|device)-[a-z]+\(.*$")
# What a paint of these kinds shows.
NONE, SEEN, CURRENT = "none", "seen", "currentcolor"
PAINT_SERVERS = ("linearGradient", "radialGradient", "pattern")
# Properties that change what is seen in ways that are not read; the values that do not.
EFFECTS = {
    "mask": "none",
    "mask-image": "none",
    "mask-border": "none",
    "filter": "none",
    "clip": "auto",
    "offset": "none",
    "offset-path": "none",
    "animation": "none",
    "animation-name": "none",
    "zoom": "1",
    "all": "",
}
MARKERS = ("marker", "marker-start", "marker-mid", "marker-end")


@frozen
class ComputedStyle:
    """Computed values that matter for an outline.

    Parameters
    ----------
    displayed : False removes the element with all that is in it (``display: none``, ``opacity: 0``).
    shown : whether ``visibility`` shows the element itself.
    fill, stroke : "none", "seen" or "currentcolor".
    fill_opaque, stroke_opaque, stroke_wide, stroke_drawn, color_opaque : whether opacity, width, a dash, and
        the alpha of ``color`` are above 0.
    even_odd : whether the fill rule is even-odd; nonzero otherwise.
    markers : whether the element carries markers.
    """

    displayed: bool = True
    shown: bool = True
    fill: str = SEEN
    stroke: str = NONE
    fill_opaque: bool = True
    stroke_opaque: bool = True
    stroke_wide: bool = True
    stroke_drawn: bool = True
    color_opaque: bool = True
    even_odd: bool = False
    markers: bool = False

    @property
    def filled(self) -> bool:
        """Whether its fill is seen."""
        return self.fill_opaque and (self.fill == SEEN or (self.fill == CURRENT and self.color_opaque))

    @property
    def stroked(self) -> bool:
        """Whether its stroke is seen."""
        seen = self.stroke == SEEN or (self.stroke == CURRENT and self.color_opaque)
        return seen and self.stroke_opaque and self.stroke_wide and self.stroke_drawn


INITIAL = ComputedStyle()


def compute_style(
    declarations: Declarations, around: ComputedStyle, styles: DeclaredStyles, label: str
) -> ComputedStyle:
    """Return the style of an element inside one with the style ``around``.

    Raises InputError for values that are not supported and decide whether the element is seen.
    """

    def get_value(name: str, parse: Callable[[str], Value | None], inherited: Value, initial: Value) -> Value:
        """Return the first valid declared value of a property, or else the inherited one."""
        for given in declarations.get(name, ()):
            text = given.text.lower() if "url(" not in given.text.lower() else given.text
            if text in ("inherit", "unset", "revert") or (name == "color" and text == CURRENT):
                return inherited
            if text == "initial":
                return initial
            parsed = parse(text)
            if parsed is not None:
                return parsed
            if "(" in text or text == "revert-layer":
                raise InputError(
                    f"{label} has {name}: {shorten_text(text)}, which is not read: write a plain value."
                )
        return inherited

    def parse_paint(text: str) -> str | None:
        """Return "none", "seen" or "currentcolor" for a paint; None for a text that is not a paint."""
        return resolve_paint(text, styles)

    display = get_value("display", lambda text: text if DISPLAYS.match(text) else None, "inline", "inline")
    if display == "contents":
        raise InputError(f"{label} has display: contents, which is not read: remove it.")
    return ComputedStyle(
        displayed=display != "none" and get_value("opacity", is_positive_opacity, True, True),
        shown=get_value(
            "visibility", {"visible": True, "hidden": False, "collapse": False}.get, around.shown, True
        ),
        fill=get_value("fill", parse_paint, around.fill, INITIAL.fill),
        stroke=get_value("stroke", parse_paint, around.stroke, INITIAL.stroke),
        fill_opaque=get_value("fill-opacity", is_positive_opacity, around.fill_opaque, True),
        stroke_opaque=get_value("stroke-opacity", is_positive_opacity, around.stroke_opaque, True),
        stroke_wide=get_value("stroke-width", is_positive_width, around.stroke_wide, True),
        stroke_drawn=get_value("stroke-dasharray", is_dash_pattern, around.stroke_drawn, True),
        color_opaque=get_value("color", is_opaque, around.color_opaque, True),
        even_odd=get_value("fill-rule", {"evenodd": True, "nonzero": False}.get, around.even_odd, False),
        markers=any(get_value(name, lambda text: text != "none", around.markers, False) for name in MARKERS),
    )


def refuse_effects(figure: ShapeElement) -> None:
    """Raise InputError for masks, filters and other effects that cut, move or hide what is drawn."""
    for name, harmless in EFFECTS.items():
        text = figure.declarations[name][0].text if name in figure.declarations else harmless
        usual = () if name == "all" else ("normal", "initial", "unset", "inherit")
        if text.lower() not in (harmless, *usual):
            raise InputError(
                f"{figure.label} has the {name} '{shorten_text(text)}', which is not read: remove it, or draw its "
                "effect."
            )


def is_positive_opacity(text: str) -> bool | None:
    """Return whether an opacity is above 0; None for a text that is not an opacity."""
    match = LENGTH.match(text)
    return None if match is None or match.group(2) not in ("", "%") else float(match.group(1)) > 0


def is_positive_width(text: str) -> bool | None:
    """Return whether a stroke's width is above 0; None for a text that is not a width."""
    match = LENGTH.match(text)
    return None if match is None or float(match.group(1)) < 0 else float(match.group(1)) > 0


def is_dash_pattern(text: str) -> bool | None:
    """Return whether a pattern of dashes and gaps has a
    dash of some length; None when it is not a pattern.
    """
    words = text.replace(",", " ").split()
    if text == "none" or len(words) % 2:
        words *= 2
    sizes = [text == "none" or is_positive_width(word) for word in words]
    return None if not sizes or None in sizes else any(sizes[::2])


def is_opaque(text: str) -> bool | None:
    """Return whether a colour is not fully transparent; None for a text that is not a colour."""
    text = PROFILE.sub("", text)
    if HEX.match(text):
        return len(text) in (4, 7) or int(text[1:], 16) % (16 if len(text) == 5 else 256) > 0
    from tinycss2.color4 import parse_color

    try:
        color = parse_color(text)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):  # of what is not a colour
        return None
    return None if color is None or color == CURRENT else color.alpha > 0


def split_link(text: str) -> tuple[str, str] | None:
    """Return the target of ``url(...)``, and the text
    after it; None when the text does not begin with a url.
    """
    match = URL.match(text)
    if match is None:
        return None
    return next(part for part in match.groups()[:3] if part is not None), match.group(4)


def resolve_paint(text: str, styles: DeclaredStyles) -> str | None:
    """Return "none", "seen" or "currentcolor" for a paint;
    None for a text that is not a paint (SVG 2, 13.2).
    """
    if text in (NONE, CURRENT):
        return text
    if text in ("context-fill", "context-stroke"):
        return NONE
    link = split_link(text)
    if link is None:
        seen = is_opaque(text)
        return None if seen is None else SEEN if seen else NONE
    server = styles.document.find_linked(link[0])
    if server is not None and get_local_name(server) in PAINT_SERVERS:
        return SEEN if shows_paint(server, styles) else NONE
    return resolve_paint(link[1].lower() or NONE, styles)


def shows_paint(server: Element, styles: DeclaredStyles, deepest: int = 50) -> bool:
    """Return whether a gradient has a visible stop, or a pattern has content; both may have it themselves or
    through a link.

    ``deepest`` limits the number of links that are followed.
    """
    if server not in styles.painted:
        content = [
            child
            for child in server
            if (get_local_name(child) == "stop") == (get_local_name(server) != "pattern")
        ]
        linked = styles.document.find_linked(read_link(server))
        styles.painted[server] = (
            any(
                get_local_name(child) != "stop"
                or all(
                    is_positive_opacity(d.text) is not False
                    for d in styles.list_declared_values(child)["stop-opacity"][:1]
                )
                for child in content
            )
            if content
            else linked is not None and deepest > 0 and shows_paint(linked, styles, deepest - 1)
        )
    return styles.painted[server]


def keep_painted_boundaries(chains: Sequence[Chain], budget: Budget) -> list[Chain]:
    """Return the chains that have paint on exactly one side, when all of
    them are filled together by the nonzero rule.

    There is paint where the winding number, the sum of the signed turns of all loops around a point, is not
    zero. A loop that meets others is kept, so that it is refused later with its place.
    """
    clean = [drop_zero_lengths([chain]).chains for chain in chains]
    known = [k for k, found in enumerate(clean) if found and len(found[0].bulges) > 1]
    shapes = []
    for k in known:
        budget.count_steps(len(clean[k][0].bulges))
        shapes.append(LoopShape.from_segments(make_loop_segments(make_closed_loop(clean[k][0]).vertices)))
    turns = [int(np.sign(compute_signed_area(shape.segments))) for shape in shapes]
    boxes = np.array([shape.box for shape in shapes]).reshape(-1, 4)
    over = set()
    for at, (k, shape) in enumerate(zip(known, shapes, strict=True)):
        x0, y0, x1, y1 = shape.box
        around = (boxes[:, 0] <= x0) & (boxes[:, 1] <= y0) & (boxes[:, 2] >= x1) & (boxes[:, 3] >= y1)
        around[at] = False
        near = np.flatnonzero(around).tolist()
        rows = np.concatenate([shapes[m].rows for m in near] or [shape.rows[:0]])
        budget.count_steps(len(near) + len(rows) // 16)
        outside = round(measure_winding(*shape.segments[0].start, rows) / (2 * pi))
        if outside and outside + turns[at] and not any(loops_meet(shape, shapes[m], budget) for m in near):
            over.add(k)
    return [chain for k, chain in enumerate(chains) if k not in over]


def loops_meet(one: LoopShape, other: LoopShape, budget: Budget) -> bool:
    """Return whether two loops touch or cross."""
    budget.count_steps(len(one.segments) + len(other.segments))
    try:
        refuse_meeting_loops(one, other, str, str)
    except InputError:
        return True
    return False
