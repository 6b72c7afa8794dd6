"""Where a drawing lies on its page, and what its pixels are."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
import resvg_py
from PIL import Image
from reading_helpers import read_svg

from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.files.part.survey import survey_part_file
from workhold.files.svg.reader import read_svg as read_chains

# Apart from each other, and without a symmetry that would hide a mirror image.
BODY = '<path d="M12 12h30l20 30h-50z"/><path d="M70 15h12v8h-12z"/>'
ILLUSTRATOR = 'x="0px" y="0px" width="425.197px" height="283.465px" viewBox="0 0 425.197 283.465"'
DRAWING = '<svg xmlns="http://www.w3.org/2000/svg" {root}>{body}</svg>'
PLATE = '<rect x="28.346" y="28.346" width="283.465" height="170.079"/>'
ALIGNED = [f"x{x}Y{y}" for x in ("Min", "Mid", "Max") for y in ("Min", "Mid", "Max")]
ASPECTS = [
    "",
    "none",
    "xMaxYMax",
    "defer xMinYMid",
    *(f"{one} {how}" for one in ALIGNED for how in ("meet", "slice")),
]


def ink(svg: str) -> np.ndarray:
    """Where the picture of a drawing, 4 pixels to the millimetre, is dark."""
    png = resvg_py.svg_to_bytes(svg_string=svg, dpi=25.4 * 4, width=800 if "200mm" in svg else 400)
    return np.asarray(Image.open(io.BytesIO(bytes(png))))[:, :, 3] >= 128


@pytest.mark.thorough
@pytest.mark.parametrize("size", [(200, 70), (100, 150)], ids=["wide", "high"])
@pytest.mark.parametrize("aspect", ASPECTS)
def test_a_drawing_lies_on_its_page_as_renderers_show_it(size: tuple[int, int], aspect: str) -> None:
    """All alignments, meet, slice and none, of a page of another shape than the viewBox: the same picture."""
    wide, high = size
    page = f'width="{wide}mm" height="{high}mm"'
    given = f'preserveAspectRatio="{aspect}"' if aspect else ""
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" {page} viewBox="-5 3 100 70" {given}>{BODY}</svg>'
    paths = " ".join(
        "M" + " ".join(f"{x!r},{high - y!r}" for x, y in chain.points)
        for chain in read_chains(svg.encode(), unit=None).chains
    )
    # resvg leaves the word out.
    shown = ink(svg.replace("defer ", ""))
    read = ink(
        f'<svg xmlns="http://www.w3.org/2000/svg" {page} viewBox="0 0 {wide} {high}"><path d="{paths}"/></svg>'
    )
    assert shown.any()
    different = shown ^ read
    core = different[1:-1, 1:-1] & different[:-2, 1:-1] & different[2:, 1:-1]
    assert not (core & different[1:-1, :-2] & different[1:-1, 2:]).any()


def test_a_page_of_another_shape_centres_the_drawing(tmp_path: Path) -> None:
    """Twice as wide as the viewBox: half the difference is left of it."""
    body = '<rect x="10" y="10" width="80" height="50"/>'
    part = read_svg(tmp_path, body, 'width="200mm" height="70mm" viewBox="0 0 100 70"').workpiece
    assert part.bounds == pytest.approx((60, 10, 140, 60))


def test_a_page_that_differs_by_its_last_digits_is_none_of_another_shape(tmp_path: Path) -> None:
    """Sizes are rounded when they are written; that moves nothing."""
    body = '<rect x="10" y="10" width="80" height="50"/>'
    part = read_svg(tmp_path, body, 'width="100.01mm" height="70mm" viewBox="0 0 100 70"').workpiece
    assert part.bounds == pytest.approx((10, 10, 90, 60))


def test_a_page_stretched_on_purpose_stretches_the_drawing(tmp_path: Path) -> None:
    """With preserveAspectRatio="none" circles become ellipses, as renderers show them."""
    root = 'width="200mm" height="70mm" viewBox="0 0 100 70" preserveAspectRatio="none"'
    part = read_svg(tmp_path, '<rect x="10" y="10" width="80" height="50"/>', root).workpiece
    assert part.bounds == pytest.approx((20, 10, 180, 60))
    with pytest.raises(InputError, match=r"circle number 1 .* true curve"):
        read_svg(tmp_path, '<circle cx="40" cy="30" r="9"/>', root)


@pytest.mark.parametrize("count", [72, 90, 96, 300, 25.4])
@pytest.mark.parametrize("way", ["unit", "usual_unit"])
def test_pixels_are_so_many_to_an_inch(tmp_path: Path, count: float, way: str) -> None:
    """The page is in pixels, and its viewBox in whatever it is; the corner of the page is the origin."""
    for root, per_unit in (
        (ILLUSTRATOR, 1.0),
        ('width="850.394px" height="566.93px" viewBox="0 0 425.197 283.465"', 2.0),
        ('width="425.197px" height="283.465px"', 1.0),
        ('viewBox="0 0 425.197 283.465"', 1.0),
        ('width="425.197" height="283.465" viewBox="0 0 425.197 283.465"', 1.0),
    ):
        path = tmp_path / "drawn.svg"
        path.write_text(DRAWING.format(root=root, body=PLATE))
        loaded = read_workpiece(path, **{way: f"px{count:g}"})
        mm = 25.4 / count * per_unit
        assert loaded.workpiece.bounds == pytest.approx(
            (28.346 * mm, 85.04 * mm, 311.811 * mm, 255.119 * mm), rel=1e-12
        )
        assert loaded.remarks == ()


def test_a_drawing_in_pixels_asks_how_many_make_an_inch(tmp_path: Path) -> None:
    """With its size in each; a unit of length is taken as asked, with a remark."""
    with pytest.raises(
        InputError, match="but one in pixels: with 72, 90 or 96 to the inch it is 100, 80 or 75 mm"
    ) as asked:
        read_svg(tmp_path, PLATE, ILLUSTRATOR)
    assert "say which with unit px72, px90 or px96, or with unit mm" in str(asked.value)
    loaded = read_svg(tmp_path, PLATE, ILLUSTRATOR, unit="mm")
    assert loaded.workpiece.bounds[2] == pytest.approx(311.811)
    assert "give unit px72, px90 or px96" in loaded.remarks[0]
    with pytest.raises(InputError, match="does not say how many make an inch: use px72"):
        read_svg(tmp_path, PLATE, ILLUSTRATOR, unit="px")


def test_pixels_of_a_drawing_of_which_nothing_is_said(tmp_path: Path) -> None:
    """They are offered after the units of length, with the size in each."""
    with pytest.raises(
        InputError,
        match="or with unit px72, px90 or px96 for pixels: with 72, 90 or 96 to the inch it is 100, 80",
    ):
        read_svg(tmp_path, PLATE, 'viewBox="0 0 425.197 283.465"')


def test_a_survey_tells_the_size_in_pixels(tmp_path: Path) -> None:
    """A page can show what each count to the inch would make of a drawing."""
    path = tmp_path / "drawn.svg"
    path.write_text(DRAWING.format(root='width="850px" height="566px" viewBox="0 0 425 283"', body=PLATE))
    seen = survey_part_file(path)
    assert seen.asked == ("unit",)
    assert seen.size == pytest.approx((283.465, 170.079))
    assert seen.pixels == pytest.approx((566.93, 340.158))
    assert survey_part_file(path, unit="mm").pixels is None
