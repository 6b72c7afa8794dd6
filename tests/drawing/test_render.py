"""SVG to the bytes of a file."""

from __future__ import annotations

import struct
import zlib

import pytest
from drawing_examples import example

from workhold.drawing import convert_svg_to_png, draw_features, draw_fixture, render
from workhold.drawing.scene import FOLDER, load_advance_widths, measure_text
from workhold.errors import InputError
from workhold.presenting.papers import PNG_WIDTH


def pixels(png: bytes) -> bytes:
    """The compressed image data of a PNG, unpacked."""
    data, at = b"", 8
    while at < len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        if png[at + 4 : at + 8] == b"IDAT":
            data += png[at + 8 : at + 8 + length]
        at += 12 + length
    return zlib.decompress(data)


@pytest.mark.thorough
@pytest.mark.parametrize("width", [200, 1000])
def test_png_has_the_width_asked_for_and_is_not_blank(width: int) -> None:
    """Signature, header, and more than one value among the pixels."""
    png = convert_svg_to_png(draw_fixture(*example()), width)
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    wide, high = struct.unpack(">II", png[16:24])
    assert wide == width and high == pytest.approx(width * 210 / 297, abs=1)
    assert len(set(pixels(png))) > 20


def test_pictures_and_sheets_are_wide_enough_to_be_read() -> None:
    """A picture file is 2400 pixels wide, a sheet no less."""
    strip = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 4"><rect width="9" height="4"/></svg>'
    assert struct.unpack(">I", render(strip, ".png")[16:20]) == (2400,)
    assert PNG_WIDTH >= 2400


def test_text_is_drawn_with_the_bundled_font() -> None:
    """Letters leave ink although no system font is loaded; bold ones leave other ink."""
    head = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 50" width="200" height="50" font-size="20">'
    )
    blank = convert_svg_to_png(f"{head}</svg>", 200)
    plain = convert_svg_to_png(f'{head}<text x="5" y="30" font-family="DejaVu Sans">Øθ°×±µ</text></svg>', 200)
    bold = convert_svg_to_png(
        f'{head}<text x="5" y="30" font-family="DejaVu Sans" font-weight="bold">Øθ°×±µ</text></svg>', 200
    )
    assert len({blank, plain, bold}) == 3


@pytest.mark.thorough
def test_endings_choose_the_kind() -> None:
    """.svg is the text itself, .png a picture of it, anything else is refused naming both."""
    svg = draw_features(example()[1])
    assert render(svg, ".svg").decode() == svg
    assert render(svg, ".PNG") == convert_svg_to_png(svg)
    for ending in (".pdf", ""):
        with pytest.raises(InputError, match=r"\.svg or \.png"):
            render(svg, ending)
    with pytest.raises(InputError):
        convert_svg_to_png(svg, 0)


def test_widths_are_those_of_the_font() -> None:
    """The table of widths agrees with the bundled fonts."""
    fonts = pytest.importorskip("fontTools.ttLib")
    for weight, file in (("regular", "DejaVuSans.ttf"), ("bold", "DejaVuSans-Bold.ttf")):
        font = fonts.TTFont(FOLDER / file)
        em, advances = font["head"].unitsPerEm, font["hmtx"]
        for code, glyph in font.getBestCmap().items():
            assert load_advance_widths()[weight][chr(code)] == pytest.approx(
                advances[glyph][0] / em, abs=1e-4
            )
    assert measure_text("漢", 10) == 10  # not in the font: an em wide


def test_licence_lies_beside_the_fonts() -> None:
    """The fonts may be passed on with their licence only."""
    assert "Permission is hereby granted" in (FOLDER / "LICENSE.txt").read_text()
