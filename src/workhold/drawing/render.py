"""SVG text to the bytes of a picture file, and several pages as one picture."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from zlib import crc32

import resvg_py

from workhold.drawing.scene import SVG_NAMESPACE, Scene, format_number, list_font_files
from workhold.errors import InputError

__all__ = ["render", "stack_pages", "convert_svg_to_png"]

DEFAULT_WIDTH = 2400
# Bytes of a PNG's signature and first chunk, and the chunk after them that says which program made it.
HEADER = 33
SOFTWARE = b"tEXtSoftware\0workhold"
MARK = (len(SOFTWARE) - 4).to_bytes(4, "big") + SOFTWARE + crc32(SOFTWARE).to_bytes(4, "big")


def convert_svg_to_png(svg: str, width: int = DEFAULT_WIDTH) -> bytes:
    """Return SVG text rendered as a PNG ``width`` pixels wide, with the bundled fonts only.

    Raises
    ------
    InputError
        For a width that is not positive.
    """
    if width < 1:
        raise InputError(f"picture width {width} is not a positive number of pixels: give 1 or more.")
    png = bytes(
        resvg_py.svg_to_bytes(
            svg_string=svg,
            width=width,
            dpi=96,  # else lengths in mm come out as nothing
            background="#ffffff",
            skip_system_fonts=True,
            font_files=list_font_files(),
            font_family="DejaVu Sans",
            sans_serif_family="DejaVu Sans",
        )
    )
    return png[:HEADER] + MARK + png[HEADER:]


def render(svg: str, ending: str) -> bytes:
    """Return the bytes of a picture file whose name ends in ".svg" or ".png", in any case.

    Raises
    ------
    InputError
        For any other ending.
    """
    match ending.lower():
        case ".svg":
            return svg.encode("utf-8")
        case ".png":
            return convert_svg_to_png(svg)
    raise InputError(
        f"{ending or 'no ending'} is not a kind of picture workhold writes: end the file in .svg or .png."
    )


def stack_pages(pages: Sequence[str]) -> str:
    """Return SVG pages of one size as a single SVG picture, one below the other;
    a single page is returned unchanged.
    """
    if len(pages) == 1:
        return pages[0]
    ET.register_namespace("", SVG_NAMESPACE)
    roots = [ET.fromstring(page.encode("utf-8")) for page in pages]
    _, _, width, height = (float(word) for word in roots[0].attrib["viewBox"].split())
    whole = Scene.make_page(
        (width, len(pages) * height), roots[0].findtext(f"{{{SVG_NAMESPACE}}}title") or ""
    )
    text = whole.to_svg().removesuffix("</svg>\n")
    for k, root in enumerate(roots):
        root.attrib |= {
            "width": format_number(width),
            "height": format_number(height),
            "y": format_number(k * height),
        }
        text += ET.tostring(root, encoding="unicode") + "\n"
    return text + "</svg>\n"
