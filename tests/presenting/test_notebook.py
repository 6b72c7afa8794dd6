"""What a notebook shows: the tables' words are those of the command, all is escaped, bounded and runs nothing."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from math import inf, nan
from typing import Any

import attrs
import pytest

import workhold
from fakes import fake_result
from workhold import Restrictions
from workhold.cli.tables import tabulate_result
from workhold.errors import InputError
from workhold.listing.identity import make_entries
from workhold.model.quality import RANKED
from workhold.presenting.figure_words import format_figure_number
from workhold.presenting.live_picture import LivePicture
from workhold.presenting.markup import MOST_SVG, Markup, compact_svg, make_image, make_table
from workhold.presenting.notebook import MOST_ROWS, MOST_SEATS
from workhold.units import MILLIMETRE
from workhold.web.answers import describe_fixture, describe_rows

RECTANGLE = [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]]
STADIUM = [[-20, -15, 0], [20, -15, 1], [20, 15, 0], [-20, 15, 1]]
WEDGE = workhold.Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
RESULT = workhold.design(WEDGE, workhold.Vise(pitch=15, columns=1, peg_radius=2))
DENSE = workhold.design(WEDGE, workhold.Vise(pitch=7, columns=2, peg_radius=1.5), best=2)
NONE = workhold.design(
    workhold.Workpiece.from_loops("plate", RECTANGLE),
    workhold.Vise(pitch=20, columns=1, peg_radius=3),
    restrictions=Restrictions(avoid=(2,)),
)
EVIL = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>&"


class Page(HTMLParser):
    """Reads rows of tables, pictures, and the elements and attributes that there are."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.pictures: list[bytes] = []
        self.words = ""
        self.elements: set[str] = set()
        self.attributes: set[str] = set()
        self.open: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        named = dict(attrs)
        self.elements.add(tag)
        self.attributes |= set(named)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif tag == "img":
            kind, held = named["src"].split(";base64,")
            assert kind in ("data:image/svg+xml", "data:image/png")
            self.pictures.append(base64.b64decode(held))
            return
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data
        if self.open and self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data


def every_kind() -> list[Any]:
    """One of each that shows itself, of the wedge and of a part that cannot be held."""
    seated = workhold.design(WEDGE, RESULT.toolkit, seating=2, best=2)
    supports = DENSE[0].supports(thickness=8, pad_radius=1.5, inside=1.0)
    bare = DENSE[0].supports(thickness=8, pad_radius=1.5, inside=30.0)
    assert supports.triples and not bare.triples
    return [
        WEDGE,
        RESULT[0].draw(),
        RESULT,
        RESULT[0],
        seated,
        seated[0],
        seated[0].seating,
        supports,
        bare,
        NONE,
        NONE.why_none(),
    ]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("thing", every_kind(), ids=lambda thing: repr(thing)[:28])
def test_only_plain_html_is_shown(thing: Any) -> None:
    """No script, style or address elsewhere; pictures are SVG that is well formed; plain text stays short."""
    page = Page(thing._repr_html_())
    assert page.elements <= {"p", "b", "code", "table", "thead", "tbody", "tr", "th", "td", "img"}
    assert page.attributes <= {"align", "style", "nowrap", "src", "width", "alt"}
    assert set(re.findall(r'style="([^"]*)"', thing._repr_html_())) <= {
        "text-align:left",
        "text-align:right",
        "min-width:200px",
        "min-width:240px",
    }
    assert page.open == []
    for picture in page.pictures:
        root = ET.fromstring(picture)
        assert root.tag.endswith("}svg") and b"<script" not in picture and b"href" not in picture
        # Its own ground, on which black lines show in a dark page too.
        assert root.find("{*}rect").get("fill") == "#ffffff"  # type: ignore[union-attr]
    assert isinstance(thing, str) or len(repr(thing)) < 200


@pytest.mark.parametrize("result", [RESULT, fake_result(30)], ids=["wedge", "fakes"])
def test_the_table_of_a_result_is_that_of_the_command(result: workhold.Result) -> None:
    """Headings and cells are the same but for the picture, and no more rows than there is room for."""
    page, shown = Page(result._repr_html_()), make_entries(result)
    theirs = tabulate_result(result, shown, MOST_ROWS)
    headings, *rows = [[cell for k, cell in enumerate(row) if k != 1] for row in page.rows]
    assert headings == [column.removeprefix(">") for column in theirs.columns]
    assert rows == [list(row) for row in theirs.rows]
    assert len(page.pictures) == len(rows) == min(MOST_ROWS, len(shown.index))
    assert f"{len(result)} fixtures are listed" in page.words


def test_a_result_says_how_many_entries_are_not_shown() -> None:
    result = fake_result(30)
    assert f"{MOST_ROWS} of {len(make_entries(result).index)} entries shown" in result._repr_html_()
    few = fake_result(2)
    assert "shown" not in Page(few._repr_html_()).words and "2 fixtures are listed" in few._repr_html_()


def test_a_fixture_shows_its_figures_with_units() -> None:
    """Every figure that is known has a row, with its unit and which way is better."""
    fixture = RESULT[0]
    page = Page(fixture._repr_html_())
    rows = {row[0]: row[1:4] for row in page.rows[1:]}
    assert len(rows) == len(fixture.figures)
    assert rows["location error"] == [f"{fixture.quality['location_error']:.4f}", "mm", "less"]
    assert rows["closure margin"][2] == "more"
    assert b"Fixture 1 of" in page.pictures[0]


@pytest.mark.thorough
def test_where_no_edge_is_none_is_said() -> None:
    """The figure then stands for no edge, and is a length that nobody can measure on the part."""
    for loop, words in ((STADIUM, "none"), (RECTANGLE[0], None)):
        part = workhold.Workpiece.from_loops("part", [loop])
        result = workhold.design(
            part, workhold.Plate(pitch=20, peg_radius=3, clamp_radius=5, clamps=2), best=2
        )
        expected = words or f"{result[0].quality['edge_distance']:.4f}"
        rows = {row[0]: row for row in Page(result[0]._repr_html_()).rows}
        assert rows["edge distance"][1] == expected
        head, first, *_ = (row for row in Page(result._repr_html_()).rows if row)
        (place,) = (k for k, name in enumerate(head) if name.startswith("edge distance"))
        assert (first[place] == "none") == (words == "none")
        (live,) = (
            row for row in LivePicture.from_result(result, 0, 200.0).figures if row[0] == "edge distance"
        )
        assert live[1] == (words or f"{expected} mm")
        answer = describe_fixture(result[0], part, result.toolkit)
        assert answer["edgeless"] == (words == "none")
        assert answer["quality"]["edge_distance"] == result[0].quality["edge_distance"]
        (row,) = describe_rows(result.table.take(slice(0, 1)), part, result.toolkit, [1])
        assert row["rank"] == 1 and row.items() <= {"rank": 1, **answer}.items()


def test_figures_of_a_plate_speak_of_its_clamp() -> None:
    plate = workhold.Plate(pitch=15, peg_radius=2, columns=6, rows=6)
    first = workhold.design(WEDGE, plate, best=1)[0]
    words = [row[0] for row in Page(first._repr_html_()).rows]
    assert "clamp amplification" in words and "jaw" not in Page(first._repr_html_()).words


def test_no_fixture_says_why() -> None:
    """The result has its reasons, and on asking the rules, the nearest miss and what helps."""
    shown = Page(NONE._repr_html_())
    assert "No fixture of plate in a vise" in shown.words and str(NONE.notes[0]) in shown.words
    why = NONE.why_none()
    page = Page(why._repr_html_())
    assert "The last contacts were removed by: closure." in page.words
    assert ["touching face 2 too", "8"] in page.rows and "Nearest miss: 2 pegs" in page.words
    assert len(page.pictures) == 1


def test_why_there_is_none_is_asked_of_none_only() -> None:
    with pytest.raises(InputError, match="there are fixtures"):
        RESULT.why_none()
    with pytest.raises(InputError, match="it is not proven that there is no fixture"):
        attrs.evolve(NONE, complete=False).why_none()
    assert "why_none" not in attrs.evolve(NONE, complete=False)._repr_html_()


def test_seats_are_bounded_and_counted() -> None:
    """The widget has more seats than there is room for."""
    vise = workhold.Vise(pitch=8, columns=2, peg_radius=2)
    (seating,) = workhold.seatings(workhold.design(workhold.load("widget"), vise, best=1))
    page = Page(seating._repr_html_())
    seats = [row for row in page.rows if len(row) == 6][1:]
    assert len(seats) == MOST_SEATS < len(seating.seats)
    assert f"{MOST_SEATS} of {len(seating.seats)} seats shown" in page.words


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("closure_margin", nan, "-"),
        ("capture_opening", inf, "any"),
        ("reading", inf, "none"),
        ("capture_opening", 1.2345, "1.23"),
        ("location_error", 0.12345, "0.1235"),
        ("tilt", -1e-9, "0.000"),
    ],
)
def test_figures_are_written_with_their_decimals(key: str, value: float, words: str) -> None:
    """What is not known is a dash, and what has no end is said in a word."""
    figure = next(one for one in RANKED if one.key == key)
    assert format_figure_number(figure, value, MILLIMETRE) == words


def test_a_part_shows_its_faces() -> None:
    (picture,) = Page(WEDGE._repr_html_()).pictures
    assert picture.decode() == compact_svg(WEDGE.draw())


def test_a_fixture_of_no_result_is_shown_as_words() -> None:
    assert attrs.evolve(RESULT[0], listed=None)._repr_html_() is None


def test_all_text_is_escaped() -> None:
    """A part's name is nowhere markup, in the page or in a picture."""
    named = workhold.Workpiece.from_loops(EVIL, WEDGE.loops)
    result = workhold.design(named, DENSE.toolkit, best=2)
    for thing in (result, result[0], result[0].supports(thickness=8, pad_radius=1.5, inside=1.0)):
        page = Page(thing._repr_html_())
        assert "script" not in page.elements and "onerror" not in page.attributes
        assert b"<script" not in b"".join(page.pictures)
        # A fixture's name stands in its picture only.
        assert ("<script>alert(1)</script>" in page.words) == (not isinstance(thing, workhold.Fixture))


def test_pictures_of_one_page_share_no_ids() -> None:
    """Each picture is an image of its own, and none has ids at all."""
    html = RESULT._repr_html_() + RESULT[0]._repr_html_()
    assert "<svg" not in html and " id=" not in html


@pytest.mark.thorough
def test_what_is_shown_is_small() -> None:
    """Also of a part with thousands of segments, whose pictures are of pixels."""
    assert len(RESULT._repr_html_()) < 100_000
    teeth = [(30 + 2 * (k % 2)) * 1.0 for k in range(4000)]
    import numpy as np

    angles = np.linspace(0, 2 * np.pi, len(teeth), endpoint=False)
    outline = [[r * np.cos(a), r * np.sin(a), 0.0] for r, a in zip(teeth, angles, strict=True)]
    gear = workhold.Workpiece.from_loops("gear", [outline])
    result = fake_result(8)
    page = attrs.evolve(result, query=attrs.evolve(result.query, workpiece=gear))._repr_html_()
    assert len(page) < 500_000 and "data:image/png" in page


@pytest.mark.thorough
def test_a_picture_is_the_same_picture_in_fewer_bytes() -> None:
    """The compact one draws the same pixels but for rounding, and numbers of a map stay exact."""
    from workhold.drawing import convert_svg_to_png

    drawn = RESULT[0].draw()
    small = compact_svg(drawn)
    assert len(small) < 0.9 * len(drawn)
    maps = [re.findall(r'data-model-to-page="([^"]*)"', text) for text in (drawn, small)]
    assert maps[0] == maps[1] != []
    from io import BytesIO

    import numpy as np
    from PIL import Image

    before, after = (
        np.asarray(Image.open(BytesIO(convert_svg_to_png(text, 600))).convert("L"), float)
        for text in (drawn, small)
    )
    assert np.abs(before - after).mean() < 0.5


def test_a_table_escapes_what_is_not_markup() -> None:
    made = make_table((">a<b",), [("<i>",), (Markup("<b>x</b>"),)])
    assert (
        '<th align="right" style="text-align:right" nowrap>a&lt;b</th>' in made
        and "&lt;i&gt;" in made
        and "<b>x</b>" in made
    )


def test_a_large_picture_is_one_of_pixels() -> None:
    drawn = RESULT[0].draw()
    assert "svg+xml" in make_image(drawn, "words", 100)
    padded = drawn.replace("</svg>", f"<desc>{'x' * MOST_SVG}</desc></svg>")
    assert "data:image/png" in make_image(padded, 'a "word"', 100) and "&quot;word&quot;" in make_image(
        padded, 'a "word"', 100
    )
