"""PDF from the pictures' SVG: the same shapes, real text in an embedded typeface, the same bytes always."""

from __future__ import annotations

from datetime import date
from math import cos, hypot, radians, sin

import pypdfium2
import pytest
from drawing_examples import diamond, example

from workhold.drawing import SheetDetails, draw_features, draw_fixture, draw_sheet, draw_thumbnails
from workhold.drawing.pdf import convert_svg_to_pdf, trace_arc
from workhold.drawing.scene import BLACK, Box, Scene, View, measure_text

DAY = date(2026, 3, 31)
DETAILS = SheetDetails(number=1, count=2, day=DAY, result_hash="ab" * 32, version="1.2.3")
# Pixels for a page unit (a quarter of a millimetre) when a page is looked at.
PIXELS = 2.0


def pixels(scene: Scene) -> list[list[int]]:
    """The grey values of a printed page, two pixels for each page unit."""
    document = pypdfium2.PdfDocument(convert_svg_to_pdf([scene.to_svg()], DAY))
    picture = document[0].render(scale=PIXELS / (72 / 101.6), grayscale=True).to_numpy()
    return [[int(value) for value in row] for row in picture.reshape(picture.shape[0], -1)]


def dark_box(scene: Scene) -> tuple[float, float, float, float]:
    """Left, upper, right, lower end of all that is dark, in page units."""
    dark = [(x, y) for y, row in enumerate(pixels(scene)) for x, value in enumerate(row) if value < 128]
    xs, ys = [x for x, _ in dark], [y for _, y in dark]
    return min(xs) / PIXELS, min(ys) / PIXELS, (max(xs) + 1) / PIXELS, (max(ys) + 1) / PIXELS


def empty() -> Scene:
    """A white page of 100 by 60 page units."""
    return Scene.make_page((100.0, 60.0), "test")


@pytest.mark.thorough
def test_sheet_holds_its_words_as_text() -> None:
    """Every page can be searched for what stands on it, and the document has its title."""
    pages = draw_sheet(*diamond(), DETAILS)
    document = pypdfium2.PdfDocument(convert_svg_to_pdf(pages, DAY))
    assert len(document) == len(pages)
    words = "".join(page.get_textpage().get_text_bounded() for page in document)
    for wanted in ("L-A1", "R-A3", "diamond", "2026-03-31", "θ", "workhold 1.2.3"):
        assert wanted in words
    assert document.get_metadata_value("Title") == "diamond: setup sheet of fixture 1"
    assert document.get_metadata_value("CreationDate").startswith("D:20260331")


@pytest.mark.thorough
@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_page_has_the_size_of_the_paper(paper: str) -> None:
    """A4 is 595.3 by 841.9 points, Letter 612 by 792."""
    details = SheetDetails(number=1, count=1, day=DAY, result_hash="0" * 64, version="1", paper=paper)
    document = pypdfium2.PdfDocument(convert_svg_to_pdf(draw_sheet(*diamond(), details), DAY))
    expected = {"a4": (595.276, 841.890), "letter": (612.0, 792.0)}[paper]
    assert sorted(document[0].get_size()) == pytest.approx(sorted(expected), abs=0.02)


@pytest.mark.thorough
def test_typefaces_are_embedded() -> None:
    """Every font has its program in the file, so that it looks the same everywhere."""
    content = convert_svg_to_pdf(draw_sheet(*diamond(), DETAILS), DAY)
    assert content.count(b"/FontFile2") == 2 and b"/Helvetica" not in content


@pytest.mark.thorough
def test_bytes_depend_on_picture_and_day_only() -> None:
    """Twice the same; another day gives another file."""
    pages = draw_sheet(*example(), DETAILS)
    assert convert_svg_to_pdf(pages, DAY) == convert_svg_to_pdf(pages, DAY)
    assert convert_svg_to_pdf(pages, DAY) != convert_svg_to_pdf(pages, date(2026, 4, 1))


@pytest.mark.thorough
def test_all_pictures_can_be_printed() -> None:
    """Whatever the pictures are made of is understood."""
    fixture, workpiece, vise = example()
    for svg in (
        draw_fixture(fixture, workpiece, vise),
        draw_features(workpiece, peg_radius=3.0),
        draw_thumbnails([fixture], workpiece, vise, ["1"]),
    ):
        assert len(pypdfium2.PdfDocument(convert_svg_to_pdf([svg], DAY))) == 1


def test_shapes_stand_where_the_picture_has_them() -> None:
    """A rectangle, a circle and an arc keep their places to half a page unit."""
    scene = empty()
    scene.add_rectangle(Box(10, 20, 40, 35), BLACK)
    assert dark_box(scene) == pytest.approx((10, 20, 40, 35), abs=0.5)
    scene = empty()
    scene.add_circle((60, 30), 12, BLACK)
    assert dark_box(scene) == pytest.approx((48, 18, 72, 42), abs=0.5)
    scene = empty()
    scene.add_path("M40 40A20 20 0 0 1 80 40Z", fill=BLACK)  # the upper half of a disc
    assert dark_box(scene) == pytest.approx((40, 20, 80, 40), abs=0.5)


@pytest.mark.parametrize("sense", [0, 1])
@pytest.mark.parametrize("degrees", [5.0, 60.0, 90.0, 120.0, 180.0])
def test_arcs_are_round(sense: int, degrees: float) -> None:
    """Every point of the curves that stand for an arc is one radius from its centre, to 3e-4 of it."""
    center, radius = (50.0, 30.0), 20.0
    ends = [radians(200.0), radians(200.0 + (degrees if sense else -degrees))]
    (x0, y0), (x1, y1) = ((center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in ends)
    path = Curves((x0, y0))
    trace_arc(path, (x0, y0), [radius, radius, 0, 0, sense, x1, y1])  # type: ignore[arg-type]
    assert path.points and path.points[-1] == pytest.approx((x1, y1))
    assert all(hypot(x - center[0], y - center[1]) == pytest.approx(radius, rel=3e-4) for x, y in path.points)


class Curves:
    """Notes points of cubic curves, in place of a path."""

    def __init__(self, start: tuple[float, float]) -> None:
        self.points: list[tuple[float, float]] = []
        self.start = start

    def curve_to(self, x1: float, y1: float, x2: float, y2: float, x3: float, y3: float) -> None:
        """Ten points along the curve."""
        x0, y0 = self.start
        for k in range(1, 10):
            t = k / 10
            a, b, c, d = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3
            self.points.append((a * x0 + b * x1 + c * x2 + d * x3, a * y0 + b * y1 + c * y2 + d * y3))
        self.start = (x3, y3)
        self.points.append(self.start)


def test_text_stands_where_the_picture_has_it() -> None:
    """A line of text that ends at 90 does, and is as wide and as high as the layout thinks."""
    scene = empty()
    scene.add_text((90, 30), "HHH", 20, "end")
    left, upper, right, lower = dark_box(scene)
    assert right == pytest.approx(90 - 0.1 * 20, abs=1.0)  # an H has a tenth of an em on its side
    assert left == pytest.approx(90 - measure_text("HHH", 20) + 0.1 * 20, abs=1.0)
    assert lower - upper == pytest.approx(0.729 * 20, abs=1.0)


def test_a_hole_stays_open() -> None:
    """The even-odd rule is kept: the middle of a ring is white."""
    scene = empty()
    scene.add_path("M10 10L50 10L50 50L10 50ZM20 20L40 20L40 40L20 40Z", fill=BLACK, fill_rule="evenodd")
    assert pixels(scene)[int(30 * PIXELS)][int(30 * PIXELS)] > 250


def test_unknown_letters_are_printed_as_question_marks() -> None:
    """A letter that the typeface lacks leaves a sign and no error."""
    scene = empty()
    scene.add_text((10, 30), "a部b", 10)
    document = pypdfium2.PdfDocument(convert_svg_to_pdf([scene.to_svg()], DAY))
    assert document[0].get_textpage().get_text_bounded() == "a?b"


@pytest.mark.parametrize("what", ["ellipse", "image"])
def test_what_would_be_lost_is_refused(what: str) -> None:
    """Elements and attributes that the printer does not know are errors, not gaps."""
    scene = empty()
    scene.add(what, {})
    with pytest.raises(ValueError, match=what):
        convert_svg_to_pdf([scene.to_svg()], DAY)
    scene = empty()
    scene.add_rectangle(Box(0, 0, 1, 1), BLACK).set("filter", "blur")
    with pytest.raises(ValueError, match="filter"):
        convert_svg_to_pdf([scene.to_svg()], DAY)


def test_groups_keep_their_views() -> None:
    """The map to millimetres is not a style and is passed over."""
    scene = empty()
    scene.group("part", View(1.0, 0.0, 0.0)).add_circle((50, 30), 5, BLACK)
    assert dark_box(scene) == pytest.approx((45, 25, 55, 35), abs=0.5)
