"""SVG text to PDF: the same picture as vectors, with the bundled typeface embedded.

Only what :class:`workhold.drawing.scene.Scene` writes is understood: ``g``, ``rect``, ``circle``, ``path``
with the commands M, L, A and Z, and ``text`` with an anchor, a halo and a turn. Anything else is refused, so
that no picture loses a shape on its way to paper.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from contextlib import nullcontext
from datetime import UTC, date, datetime, time
from math import asin, atan2, cos, hypot, sin, tan

from fpdf import FPDF
from fpdf.drawing import DrawingContext, GraphicsStyle, PaintedPath
from fpdf.drawing_primitives import color_from_hex_string
from fpdf.enums import TextMode

from workhold.drawing.scene import UNITS_PER_MM, has_character, list_font_files, measure_text
from workhold.geometry.segment import Point

__all__ = ["convert_svg_to_pdf"]

POINTS_PER_UNIT = 72 / 25.4 / UNITS_PER_MM
FONT = "DejaVu Sans"
# What a character that the bundled typeface does not have is printed as.
UNKNOWN = "?"

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
COMMAND = re.compile(r"([A-Za-z])([^A-Za-z]*)")
TURN = re.compile(r"rotate\(([-\d.]+) ([-\d.]+) ([-\d.]+)\)")

# Attributes that change nothing on the page, or that are read where they occur.
SILENT = {"class", "data-model-to-page", "stroke-linejoin", "font-family"}
STYLE = {
    "fill",
    "fill-rule",
    "fill-opacity",
    "stroke",
    "stroke-width",
    "stroke-dasharray",
    "stroke-linecap",
    "stroke-opacity",
}


def convert_svg_to_pdf(pages: Sequence[str], created: date) -> bytes:
    """Return a PDF, as bytes, with a page for each SVG text.

    Parameters
    ----------
    pages : texts written by :meth:`workhold.drawing.scene.Scene.to_svg`.
    created : the date written in the document. The bytes depend on it and on ``pages`` alone.

    Raises
    ------
    ValueError
        For SVG with elements or attributes that :class:`workhold.drawing.scene.Scene` does not write.
    """
    pdf = FPDF(unit=POINTS_PER_UNIT)
    pdf.set_margin(0.0)
    pdf.set_auto_page_break(False)
    pdf.set_creation_date(datetime.combine(created, time(), UTC))
    pdf.set_producer("workhold")
    regular, bold = list_font_files()
    pdf.add_font(FONT, "", regular)
    pdf.add_font(FONT, "B", bold)
    for svg in pages:
        root = ET.fromstring(svg.encode("utf-8"))
        _, _, width, height = (float(word) for word in root.attrib["viewBox"].split())
        pdf.add_page(format=(width, height))
        draw_children(pdf, root)
    return bytes(pdf.output())


def draw_children(pdf: FPDF, group: ET.Element) -> None:
    """Draw the elements of a group in order; successive shapes share one drawing context."""
    shapes: list[PaintedPath] = []
    for element in group:
        tag = element.tag.rpartition("}")[2]
        if tag in ("rect", "circle", "path"):
            shapes.append(make_painted_path(tag, element.attrib))
            continue
        draw_shapes(pdf, shapes)
        shapes = []
        if tag == "g":
            refuse_unknown(tag, element.attrib, SILENT)
            draw_children(pdf, element)
        elif tag == "text":
            draw_text(pdf, element)
        elif tag == "title":
            pdf.set_title(element.text or "")
        else:
            raise ValueError(f"no way to print the SVG element {tag}")
    draw_shapes(pdf, shapes)


def draw_shapes(pdf: FPDF, shapes: list[PaintedPath]) -> None:
    """Draw painted paths in one drawing context."""
    if not shapes:
        return
    context: DrawingContext
    with pdf.drawing_context() as context:
        for path in shapes:
            context.add_item(path)


def refuse_unknown(tag: str, attributes: dict[str, str], known: set[str]) -> None:
    """Raise ValueError if an element has attributes outside ``known``, which the PDF would not show."""
    unknown = sorted(set(attributes) - known)
    if unknown:
        raise ValueError(f"no way to print the attributes {', '.join(unknown)} of the SVG element {tag}")


def make_painted_path(tag: str, attributes: dict[str, str]) -> PaintedPath:
    """Return a "rect", "circle" or "path" element as a painted path with its style."""
    path = PaintedPath()
    if tag == "rect":
        refuse_unknown(tag, attributes, STYLE | SILENT | {"x", "y", "width", "height", "rx"})
        x, y, width, height, round_by = (
            float(attributes.get(k, "0")) for k in ("x", "y", "width", "height", "rx")
        )
        corner = min(round_by, width / 2, height / 2)
        path.rectangle(x, y, width, height, corner, corner)
    elif tag == "circle":
        refuse_unknown(tag, attributes, STYLE | SILENT | {"cx", "cy", "r"})
        path.circle(*(float(attributes[k]) for k in ("cx", "cy", "r")))
    else:
        refuse_unknown(tag, attributes, STYLE | SILENT | {"d"})
        append_path_data(path, attributes["d"])
    set_style(path.style, attributes)
    return path


def append_path_data(path: PaintedPath, d: str) -> None:
    """Append SVG path data with the absolute commands M, L, A and Z to a path."""
    here = (0.0, 0.0)
    for letter, numbers in COMMAND.findall(d):
        values = [float(word) for word in NUMBER.findall(numbers)]
        match letter:
            case "M":
                path.move_to(*values)
            case "L":
                path.line_to(*values)
            case "A":
                trace_arc(path, here, values)
            case "Z":
                path.close()
                continue
            case _:
                raise ValueError(f"no way to print the SVG path command {letter}")
        here = (values[-2], values[-1])


def trace_arc(path: PaintedPath, start: Point, values: Sequence[float]) -> None:
    """Append a circular arc of at most half a turn to a path as two Bezier curves.

    ``values`` are those of the SVG command A: two equal radii, no rotation, no large arc, the direction, and
    the end point; otherwise ValueError is raised. Each curve takes half of the arc. With sweep s, its inner
    control points are 4/3 tan(s/4) radii from its ends along the tangents (A. Riskus, *Approximation of a
    cubic Bezier curve by circular arcs and vice versa*, 2006). For half a turn the curves are off by 3e-4
    radii.
    """
    radius, other, turn, large, positive, x1, y1 = values
    if radius != other or turn or large:
        raise ValueError("no way to print an SVG arc that is an ellipse's or more than half a turn")
    (x0, y0), sense = start, 1.0 if positive else -1.0
    chord = hypot(x1 - x0, y1 - y0)
    if chord == 0:
        return
    half = asin(min(chord / (2 * radius), 1.0))
    # From the middle of the chord, the middle of the arc lies on the side of its sense, y running down the
    # page.
    direction, height = atan2(y1 - y0, x1 - x0), sense * chord / 2 * tan(half / 2)
    middle = ((x0 + x1) / 2 + height * sin(direction), (y0 + y1) / 2 - height * cos(direction))
    reach = 4 / 3 * tan(half / 4) * chord / (2 * sin(half))
    ways = [
        (reach * cos(a), reach * sin(a))
        for a in (direction - sense * half, direction, direction + sense * half)
    ]
    points = [start, middle, (x1, y1)]
    for k in (0, 1):
        (x, y), (end_x, end_y) = points[k : k + 2]
        path.curve_to(
            x + ways[k][0], y + ways[k][1], end_x - ways[k + 1][0], end_y - ways[k + 1][1], end_x, end_y
        )


def set_style(style: GraphicsStyle, attributes: dict[str, str]) -> None:
    """Set a path's fill and stroke from SVG attributes."""
    style.auto_close = False
    style.stroke_join_style = "round"
    style.stroke_cap_style = attributes.get("stroke-linecap", "butt")
    fill, stroke = attributes.get("fill", "none"), attributes.get("stroke", "none")
    style.fill_color = None if fill == "none" else color_from_hex_string(fill)
    style.stroke_color = None if stroke == "none" else color_from_hex_string(stroke)
    style.intersection_rule = attributes.get("fill-rule", "nonzero")
    if "fill-opacity" in attributes:
        style.fill_opacity = float(attributes["fill-opacity"])
    if stroke != "none":
        style.stroke_width = float(attributes.get("stroke-width", "1"))
    if "stroke-opacity" in attributes:
        style.stroke_opacity = float(attributes["stroke-opacity"])
    if "stroke-dasharray" in attributes:
        style.stroke_dash_pattern = [float(word) for word in attributes["stroke-dasharray"].split()]


def draw_text(pdf: FPDF, element: ET.Element) -> None:
    """Draw a text element with its anchor, halo and rotation; characters without a glyph become "?"."""
    attributes = element.attrib
    known = {"x", "y", "font-size", "font-weight", "text-anchor", "transform", "paint-order", "fill"}
    refuse_unknown("text", attributes, known | {"stroke", "stroke-width"} | SILENT)
    content = "".join(c if has_character(c) else UNKNOWN for c in element.text or "")
    if not content:
        return
    x, y, size = (float(attributes[key]) for key in ("x", "y", "font-size"))
    bold = attributes.get("font-weight") == "bold"
    x -= {"start": 0.0, "middle": 0.5, "end": 1.0}[attributes.get("text-anchor", "start")] * measure_text(
        content, size, bold
    )
    pdf.set_font(FONT, "B" if bold else "", size * POINTS_PER_UNIT)
    turn = TURN.fullmatch(attributes.get("transform", ""))
    degrees, center_x, center_y = (float(word) for word in turn.groups()) if turn else (0.0, 0.0, 0.0)
    with pdf.rotation(-degrees, center_x, center_y) if turn else nullcontext():
        if "stroke" in attributes:
            with pdf.local_context(
                text_mode=TextMode.STROKE,
                draw_color=color_from_hex_string(attributes["stroke"]),
                line_width=float(attributes["stroke-width"]),
            ):
                pdf.text(x, y, content)
        pdf.set_text_color(color_from_hex_string(attributes["fill"]))
        pdf.text(x, y, content)
