"""Tables and pictures as HTML for notebooks, trusted or not.

A picture is an image whose address contains its SVG: its ids cannot collide with others, and scripts in it do
not run. Its white background suits dark and light pages. Sanitizers that remove SVG from HTML do not remove
it. The HTML has no colours and no scripts of its own, so those of the page apply.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from io import StringIO

from workhold.drawing.render import convert_svg_to_png
from workhold.drawing.scene import SVG_NAMESPACE
from workhold.errors import make_printable

__all__ = [
    "LARGE",
    "MOST_SVG",
    "Markup",
    "compact_svg",
    "make_image",
    "make_paragraph",
    "escape_html",
    "make_table",
]

# Width of a page that is shown by itself, in pixels.
LARGE = 900
# Bytes of SVG above which a small picture, and a page, is one of pixels; so many pixels for each that it is
# shown wide.
MOST_SVG, MOST_PAGE, SHARP = 40_000, 150_000, 2
# Decimals of page coordinates; a page unit is a pixel or less.
DECIMALS = 1
# What children of a group inherit from it.
INHERITED = ("fill", "stroke", "stroke-width", "fill-rule", "fill-opacity", "stroke-linecap")
FRACTION = re.compile(r"-?\d+\.\d+")
# Attributes of shapes whose numbers are coordinates; a matrix keeps its own.
COORDINATES = ("d", "x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "width", "height", "stroke-width")


class Markup(str):
    """Text that is HTML already, which :func:`escape_html` leaves as it is."""

    __slots__ = ()


def escape_html(words: str) -> Markup:
    """Return a text escaped as HTML; a :class:`Markup`, which is HTML already, is returned unchanged.

    >>> escape_html("<b> & co"), escape_html(Markup("<b>"))
    ('&lt;b&gt; &amp; co', '<b>')
    """
    return words if isinstance(words, Markup) else Markup(escape(make_printable(words)))


def make_paragraph(*pieces: str) -> Markup:
    """Return an HTML paragraph of texts or markup, joined by spaces."""
    return Markup(f"<p>{' '.join(map(escape_html, pieces))}</p>")


def make_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> Markup:
    """Return an HTML table; columns whose heading begins with ``>`` are aligned right, all others left.

    The sign is not shown. The alignment is given twice, because some sanitizers remove styles and some pages
    override attributes.
    """
    ways = ["right" if heading.startswith(">") else "left" for heading in headings]

    def make_row(cells: Sequence[str], tag: str) -> str:
        """Return a table row of cells with the tag "th" or "td"."""
        made = (
            f'<{tag} align="{way}" style="text-align:{way}" nowrap>{escape_html(cell)}</{tag}>'
            for cell, way in zip(cells, ways, strict=True)
        )
        return f"<tr>{''.join(made)}</tr>"

    head = make_row([escape_html(heading.removeprefix(">")) for heading in headings], "th")
    body = "\n".join(make_row(cells, "td") for cells in rows)
    return Markup(f"<table><thead>{head}</thead>\n<tbody>{body}</tbody></table>")


def make_image(svg: str, words: str, width: int, shrinks: bool = True) -> Markup:
    """Return a picture as an HTML image, ``width`` pixels wide; ``words`` are its alternative text.

    An SVG of more than :data:`MOST_SVG` bytes is converted to PNG; for images at least :data:`LARGE` wide the
    limit is :data:`MOST_PAGE`. ``shrinks`` says whether a narrow page may show it narrower than ``width``; in
    a table it should not.
    """
    drawn, kind = compact_svg(svg).encode("utf-8"), "svg+xml"
    if len(drawn) > (MOST_PAGE if width >= LARGE else MOST_SVG):
        drawn, kind = convert_svg_to_png(svg, SHARP * width), "png"
    wide = "" if shrinks else f' style="min-width:{width}px"'
    held = b64encode(drawn).decode("ascii")
    return Markup(
        f'<img src="data:image/{kind};base64,{held}" width="{width}"{wide} alt="{escape(make_printable(words))}">'
    )


def compact_svg(svg: str) -> str:
    """Return SVG text with fewer bytes, with the same look.

    Spaces between elements and most decimals are dropped, and attributes that all children share are moved to
    their group.
    """
    ET.register_namespace("", SVG_NAMESPACE)
    root = ET.parse(StringIO(svg)).getroot()
    for element in root.iter():
        element.tail = None
        if len(element) and not (element.text or "").strip():
            element.text = None
        for name in COORDINATES:
            if name in element.attrib:
                element.set(name, FRACTION.sub(round_match, element.get(name, "")))
    for group in root.iter(f"{{{SVG_NAMESPACE}}}g"):
        hoist_attributes(group)
    return ET.tostring(root, encoding="unicode")


def round_match(match: re.Match[str]) -> str:
    """Return a matched number with ``DECIMALS`` decimals, without a trailing ".0"."""
    text = f"{float(match[0]):.{DECIMALS}f}".removesuffix(".0")
    return "0" if text == "-0" else text


def hoist_attributes(group: ET.Element) -> None:
    """Move inheritable attributes that all children of a group share from the children to the group, in
    place.
    """
    if len(group) < 2:
        return
    for name in INHERITED:
        values = {child.get(name) for child in group}
        if len(values) == 1 and None not in values and name not in group.attrib:
            group.set(name, str(values.pop()))
            for child in group:
                del child.attrib[name]
