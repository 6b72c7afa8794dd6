"""The view from the side: to scale, every height in it, and nothing of the part that is not known."""

from __future__ import annotations

import re

import pytest
from attrs import evolve
from drawing_examples import example
from sheet_reading import words_of
from space_examples import (
    FLANGE,
    FOOT,
    HEAD_ROOM,
    HEIGHT,
    NAMES,
    PEG_HEIGHT,
    SOLID,
    chosen,
    faults,
    printed,
    result_of,
    sheet,
)
from svg_reading import by_class, matrix, texts, to_model

from workhold import Fixture, Peg, Plate, Pose, Workpiece
from workhold.drawing import SheetDetails
from workhold.drawing.bench import find_contact, make_bench
from workhold.drawing.scene import UNITS_PER_MM
from workhold.drawing.sheet_facts import collect_sheet_details
from workhold.drawing.sheet_writing import find_sheet_heights
from workhold.drawing.side_view import WAYS, choose_side_view, measure_peg_spread
from workhold.errors import InputError
from workhold.model.dowel_lengths import find_shortest_dowel
from workhold.units import INCH, MILLIMETRE, Unit

Box = tuple[float, float, float, float]


def side_page(pages: tuple[str, ...]) -> str:
    """The page with the view."""
    (page,) = (one for one in pages if by_class(one, "side"))
    return page


def boxes(page: str, name: str) -> list[Box]:
    """The boxes, across and by height in mm, of all paths of a class in the view."""
    (group,) = by_class(page, "side")
    found = []
    for element in by_class(page, name):
        numbers = [float(word) for word in re.findall(r"-?\d+\.?\d*", element.attrib["d"])]
        points = [to_model(group, x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
        xs, ys = [x for x, _ in points], [y for _, y in points]
        found.append((min(xs), min(ys), max(xs), max(ys)))
    return found


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_view_is_true_to_the_scale_that_is_written(name: str) -> None:
    """What is drawn of part, pegs and bands is as large as their heights and places, at the scale of the title."""
    result = result_of(name)
    # The sheet has all of it in the middle of the plate.
    fixture, toolkit = collect_sheet_details(result, 1)[0], result.toolkit
    page = side_page(sheet(result))
    (title,) = (word for word in texts(page) if word.startswith("Side view"))
    paper, model = (float(word) for word in title.rpartition(" ")[2].split(":"))
    (group,) = by_class(page, "side")
    assert matrix(group)[0] == pytest.approx(UNITS_PER_MM * paper / model)
    (way,) = (one for one in WAYS if one.words in title)
    part = make_bench(fixture, SOLID, toolkit).shown.part
    (known,), (rest,) = boxes(page, "part-side"), boxes(page, "unknown")
    assert known == pytest.approx(
        (*way.project_box(part)[:1], 0.0, way.project_box(part)[1], PEG_HEIGHT + HEAD_ROOM), abs=2e-3
    )
    ends = [way.project(fixture.pose.apply(x, y)) for x, y, _ in FLANGE]
    low, high = min(*ends, way.project_box(part)[0]), max(*ends, way.project_box(part)[1])
    assert rest == pytest.approx((low, PEG_HEIGHT + HEAD_ROOM, high, HEIGHT), abs=2e-3)
    # Nothing is drawn in corners of which nobody knows; the level face on top is a line.
    assert all(float(one.attrib.get("stroke-width", "0")) == 0.0 for one in by_class(page, "unknown"))
    (upper,) = by_class(page, "upper-face")
    assert upper.attrib["stroke-dasharray"] == "7 4"
    assert re.search("level upper faces .dashed", " ".join(texts(page)))
    feet = [way.project(fixture.pose.apply(x, y)) for x, y, _ in FOOT]
    assert boxes(page, "foot-face") == [pytest.approx((min(feet), 0.0, max(feet), 0.0), abs=2e-3)]
    bench = make_bench(fixture, SOLID, toolkit)
    assert SOLID.solid is not None
    expected = []
    for index in bench.placed:
        peg = fixture.pegs[index]
        place, _ = find_contact(toolkit.find_carrier(peg.carrier).contact, (peg.x, peg.y), bench.faces[index])
        band = SOLID.solid.bands[peg.face]
        assert band is not None
        expected.append((way.project(place), band[0], way.project(place), band[1]))
    assert sorted(boxes(page, "band")) == [pytest.approx(one, abs=2e-3) for one in sorted(expected)]


@pytest.mark.thorough
@pytest.mark.parametrize("name", NAMES)
def test_pegs_stand_from_the_plate_to_their_height(name: str) -> None:
    """Each peg is as wide as it is, ends at the peg height, and sits in the plate as deep as a dowel that is sold."""
    result, lift = result_of(name, False), chosen(name)
    lifted = 0.0 if lift is None else 6.0
    page = side_page(
        sheet(
            result, thickness=HEIGHT, peg_height=9.0, plate_thickness=15.0, supports=lift, support_height=6.0
        )
    )
    (group,) = by_class(page, "side")
    red = [one for one in group if one.get("fill") == "#b3122a"]
    widths = set()
    for peg in red:
        x, y, width, height = (float(peg.attrib[key]) for key in ("x", "y", "width", "height"))
        low, high = to_model(group, x, y + height)[1], to_model(group, x, y)[1]
        assert (low, high) == pytest.approx((-lifted, 9.0 - lifted), abs=2e-3)
        widths.add(round(width / matrix(group)[0], 2))
    radii = {round(2 * one.peg_radius, 2) for one in result.toolkit.plates}
    assert widths == radii
    diameter = result.toolkit.peg_diameter
    dowel = find_shortest_dowel(diameter, 9.0)
    deep = 1.5 * diameter if dowel is None else dowel.depth
    for _, low, _, high in boxes(page, "peg-foot"):
        assert (low, high) == pytest.approx((-lifted - deep, -lifted), abs=2e-3)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(("paper", "unit"), [("a4", MILLIMETRE), ("letter", INCH)], ids=["a4", "letter"])
@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_covered_or_cut_off(name: str, paper: str, unit: Unit) -> None:
    """No word of a sheet in space lies on another or off the paper, with loads and without, in both units."""
    assert faults(sheet(result_of(name), paper=paper, unit=unit)) == []
    for loaded in (False, True):
        result, supports = result_of(name, False, loaded), chosen(name, loaded)
        pages = sheet(result, paper=paper, unit=unit, supports=supports, thickness=HEIGHT)
        assert faults(pages) == []


@pytest.mark.thorough
@pytest.mark.parametrize(("unit", "size"), [(MILLIMETRE, "{:.3f}"), (INCH, "{:.4f}")])
def test_every_height_is_in_the_pdf(unit: object, size: str) -> None:
    """Levels, dimensions and the table of the bands say the heights that went in."""
    scale = 1.0 if unit is MILLIMETRE else 25.4
    result = result_of("plate")
    words = printed(sheet(result, unit=unit, plate_thickness=15.0))
    dowel = find_shortest_dowel(result.toolkit.peg_diameter, PEG_HEIGHT)
    assert dowel is not None

    def told(length: float) -> str:
        return size.format(length / scale)

    sign = "mm" if unit is MILLIMETRE else "in"
    for wanted in (
        f"+{told(HEIGHT)} top of the part",
        f"+{told(PEG_HEIGHT + HEAD_ROOM)} head room {told(HEAD_ROOM)}",
        f"+{told(PEG_HEIGHT)} top of the pegs",
        f"{told(0.0)} the part lies here",
        f"part {told(HEIGHT)} {sign}",
        f"pegs {told(PEG_HEIGHT)} {sign}",
        f"head room above the pegs {told(HEAD_ROOM)} {sign}",
        f"Up to {told(PEG_HEIGHT + HEAD_ROOM)} {sign} the part is drawn as wide as everything that pegs can meet",
        f"{told(PEG_HEIGHT)} {sign} beside the part + {told(dowel.depth)} {sign} in the plate.",
        f"locators: dowels of {dowel.name} each sits in the plate {told(dowel.depth)} {sign}",
    ):
        assert wanted in words
    assert SOLID.solid is not None
    for peg in collect_sheet_details(result, 1)[0].pegs:
        band = SOLID.solid.bands[peg.face]
        assert band is not None and f"{peg.hole} {told(band[0])} {told(band[1])}" in words


@pytest.mark.thorough
def test_supports_lift_everything() -> None:
    """With supports of 6 mm the plate is 6 mm lower, and pegs as much longer."""
    lift = chosen("plate")
    assert lift is not None
    pages = sheet(
        result_of("plate", False), thickness=HEIGHT, peg_height=14.0, supports=lift, support_height=6.0
    )
    words = printed(pages)
    for wanted in (
        "−6.000 top of the plate",
        "supports 6.000 mm",
        "pegs 14.000 mm",
        "pegs above the plate 14.000 mm",
        "+8.000 top of the pegs",
        "Dowels of 6 × 24 mm, ISO 8734: 8.000 mm beside the part + 6.000 mm of supports + 10.000 mm in the plate",
        "3 locators 6 24.000",
        "3 supports 4 6.000",
        "1 clamp on top 5 –",
    ):
        assert wanted in words
    assert f"{lift.pads[0].hole} " in words
    with pytest.raises(InputError, match="pegs 6 mm high end below the part"):
        sheet(result_of("plate", False), thickness=HEIGHT, peg_height=6.0, supports=lift, support_height=6.0)


@pytest.mark.thorough
def test_a_drawing_without_thickness_has_no_view() -> None:
    """Nobody knows the heights; with a thickness the part is a prism, and what was assumed is said to be."""
    result = result_of("vise", False)
    assert not any(by_class(page, "side") for page in sheet(result))
    words = printed(sheet(result, thickness=12.0))
    assert "The part is drawn as a prism of its outline." in words
    assert (
        "Assumed, because no value is given: thickness of the jaws 10.000 mm; pegs as high as the part, 12.000 mm."
        in words
    )
    (known,) = boxes(side_page(sheet(result, thickness=12.0)), "part-side")
    assert known[1::2] == pytest.approx((0.0, 12.0), abs=2e-3)


def rectangle_with_pegs(*places: tuple[float, float]) -> tuple[Fixture, Workpiece, Plate]:
    """A rectangle 60 by 30 with a hole in its middle, and pegs of radius 2 at some places."""
    hole = [[27, 15, 1], [33, 15, 1]]
    part = Workpiece.from_loops("part", [[[0, 0, 0], [60, 0, 0], [60, 30, 0], [0, 30, 0]], hole])
    pegs = tuple(Peg("plate", k, 0, x, y, 0, 0.25) for k, (x, y) in enumerate(places))
    return Fixture("clamp", pegs, Pose(0.0, 0.0, 0.0), 0.0, {}, "-x"), part, Plate(pitch=20, peg_radius=2)


def test_what_stands_behind_the_part_is_hidden() -> None:
    """Seen from below: pegs before and beside the part are not, those behind it and in its hole are."""
    places = ((10.0, -2.0), (-2.0, 10.0), (50.0, 32.0), (30.0, 15.0), (62.0, 20.0), (70.0, 40.0))
    fixture, part, plate = rectangle_with_pegs(*places)
    details = SheetDetails(1, 1, sheet_day(), "", "1", thickness=10.0)
    heights = find_sheet_heights(fixture, part, plate, details)
    assert heights is not None
    view = choose_side_view(make_bench(fixture, part, plate), part, heights)
    assert view.way is WAYS[0]
    assert [one.is_hidden for one in view.contacts] == [False, False, True, True, False, False]


def sheet_day() -> object:
    """The date of a sheet."""
    from space_examples import DAY

    return DAY


def test_view_is_taken_where_pegs_stand_apart() -> None:
    """Pegs over one another in one view stand apart in the other; a wall that hides the part is looked past."""
    for places, way in (
        (((0.0, -2.0), (20.0, -2.0), (40.0, 32.0)), WAYS[0]),
        (((20.0, -2.0), (20.0, 15.0), (20.0, 32.0)), WAYS[1]),
        (((20.0, -2.0), (20.5, 15.0), (21.0, 32.0)), WAYS[1]),
    ):
        fixture, part, plate = rectangle_with_pegs(*places)
        bench = make_bench(fixture, part, plate)
        heights = find_sheet_heights(
            fixture, part, plate, SheetDetails(1, 1, sheet_day(), "", "1", thickness=10.0)
        )
        assert heights is not None and choose_side_view(bench, part, heights).way is way
        assert measure_peg_spread(bench, way)[0] == max(measure_peg_spread(bench, one)[0] for one in WAYS)
    result = result_of("fence")
    heights = find_sheet_heights(result[0], SOLID, result.toolkit, SheetDetails(1, 1, sheet_day(), "", "1"))
    assert heights is not None
    assert choose_side_view(make_bench(result[0], SOLID, result.toolkit), SOLID, heights).way is WAYS[1]


@pytest.mark.thorough
def test_pegs_other_than_those_of_the_outline_are_seen() -> None:
    """The length of pegs follows from how far they stand out, which a sheet may say anew: that of a dowel that is sold, or
    of a peg 1.5 diameters deep in its hole, or through the plate where it has no thickness."""
    result = result_of("plate")
    details = SheetDetails(1, 1, sheet_day(), "", "1", plate_thickness=12.0)
    for radius, length, is_sold in (
        (3.0, 18.0, True),
        (3.3, PEG_HEIGHT + 1.5 * 6.6, False),
        (0.0, PEG_HEIGHT + 12.0, False),
    ):
        toolkit = evolve(result.toolkit, peg_radius=radius)
        heights = find_sheet_heights(result[0], SOLID, toolkit, details)
        assert heights is not None and heights.above_plate == PEG_HEIGHT
        assert heights.peg_length == pytest.approx(length) and (heights.dowel is not None) == is_sold
        assert "plate_thickness" not in heights.assumed and ("peg_length" in heights.assumed) != is_sold
    other = find_sheet_heights(
        result[0], SOLID, result.toolkit, evolve(details, peg_height=5.0, peg_length=30.0)
    )
    assert other is not None and (other.peg_top, other.peg_length) == (5.0, 30.0)


def test_names_of_pegs_stand_below_them_in_their_order() -> None:
    """Each hole of a peg is named once below the plates, from left to right as the pegs stand."""
    fixture, workpiece, vise = example()
    from workhold.drawing import draw_sheet

    page = side_page(
        draw_sheet(fixture, workpiece, vise, SheetDetails(1, 1, sheet_day(), "", "1", thickness=8.0))
    )
    (group,) = by_class(page, "names")
    written = [element.text for element in group.iter() if element.tag.endswith("text")]
    assert sorted(name for words in written for name in str(words).split(", ")) == sorted(
        p.hole for p in fixture.pegs
    )
    places = dict(words_of(page))
    order = [places[str(words)].center[0] for words in written]
    assert order == sorted(order)
