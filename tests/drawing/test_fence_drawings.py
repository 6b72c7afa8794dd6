"""A fence in pictures, on the setup sheet, in DXF and STEP: a bar that the part lies on, and where things are told from."""

from __future__ import annotations

import re
from io import StringIO
from math import isinf

import ezdxf
import pytest
from attrs import evolve
from sheet_reading import collisions
from svg_reading import texts

from workhold import Fence, Restrictions, Result, Workpiece, design
from workhold.cli.seat_command import tabulate_seats
from workhold.drawing import draw_fixture, draw_setup_sheet
from workhold.drawing.bench import find_contact
from workhold.drawing.scene import LengthUnit
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.seats import draw_seats
from workhold.files.dxf.writer import make_setup_dxf
from workhold.files.result.fixture_text import write_pin_list, write_result_csv
from workhold.fixels.contacts import ROUND_PIN, WALL_END
from workhold.geometry.segment import Line
from workhold.model.seating import Seat
from workhold.model.shown import find_shown
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.units import MILLIMETRE

L = [[0, 0, 0], [60, 0, 0], [60, 20, 0], [20, 20, 0], [20, 50, 0], [0, 50, 0]]
KITE = [[0, 0, 0], [56, 6, 0], [48, 44, 0], [10, 37, 0.2]]


def held(loop: list[list[float]], **fields: object) -> Result:
    """The fixtures of a part on a fence."""
    return design(Workpiece.from_loops("part", [loop]), Fence(10, 3, wall_offset=5, **fields))  # type: ignore[arg-type]


@pytest.mark.thinned(6)
@pytest.mark.parametrize("travel", [(4, 30), None], ids=["bolted", "line"])
@pytest.mark.parametrize("direction", ["-x", "+x", "-y", "+y"])
def test_pictures_and_sheets_show_the_fence_and_cover_nothing(direction: str, travel: object) -> None:
    """One hatched bar below the part, two round pegs, four forces; no word lies on another."""
    # Small tips, so that a clamp that pulls towards itself finds room in the mouth.
    result = held(KITE, travel=travel, directions=[direction])
    if direction == "+y":
        assert len(result) == 0
        return
    fixture, part, fence = result[0], result.workpiece, result.toolkit
    picture = draw_fixture(fixture, part, fence)
    # Once in the plan, once among the signs.
    assert len(re.findall('class="fence"', picture)) == 2 and 'class="hatching"' in picture
    assert len(re.findall('class="peg"', picture)) == 2
    for page in draw_setup_sheet(result, 1):
        assert collisions(page) == []
    words = " ".join(word for page in draw_setup_sheet(result, 1) for word in texts(page))
    assert "fence left" in words and "x from column A" in words and "y from the fence" in words
    assert "5.000 mm from the fence" in words and "jaw" not in words


def test_corners_on_the_fence_are_told_by_both_faces_and_not_marked_as_touched() -> None:
    """The slant of an L lies on the fence with two corners."""
    result = held(L, travel=(2, 40))
    fixture = result[0]
    assert [peg.touched for peg in fixture.pegs[1:3]] == ["1/2", "3/4"]
    picture = draw_fixture(fixture, result.workpiece, result.toolkit)
    assert len(re.findall('class="touched"', picture)) == len({fixture.pegs[0].face, fixture.pegs[3].face})
    words = " ".join(word for page in draw_setup_sheet(result, 1) for word in texts(page))
    assert "the corner of faces 1 and 2" in words.replace("- ", "")


def test_the_bar_lies_below_the_part_and_the_plate_goes_on_below_it() -> None:
    """As long as plate and part."""
    result = held(KITE)
    seen = find_shown(result[0], result.toolkit, result.workpiece)
    (wall,) = seen.walls
    assert wall.bar.y1 == 0.0 < -wall.bar.y0
    assert wall.bar.x0 <= seen.part.x0 and wall.bar.x1 >= seen.part.x1
    assert seen.part.y0 == pytest.approx(0.0, abs=1e-9)
    assert seen.carriers[0].plate.y0 == wall.bar.y0
    assert wall.ends == (result[0].pegs[1].x, result[0].pegs[2].x)


def test_dxf_has_the_bar_on_a_layer_and_one_locator() -> None:
    """The wall's ends are not pegs."""
    result = held(KITE, travel=(4, 30))
    drawing = ezdxf.read(StringIO(make_setup_dxf(result[0], result.workpiece, result.toolkit).decode()))
    (bar,) = drawing.modelspace().query('*[layer=="FENCE"]')
    assert max(y for _, y, *_ in bar.get_points()) == 0.0
    assert len(drawing.modelspace().query('CIRCLE[layer=="LOCATORS"]')) == 1


def test_the_list_of_pins_has_the_locator_alone_and_a_spreadsheet_all_contacts() -> None:
    """A fence is not a pin."""
    result = held(KITE)
    assert len(write_pin_list(result[0], result.toolkit, MILLIMETRE, None, None).splitlines()) == 2
    header, first, *_ = "".join(write_result_csv(result)).splitlines()
    row = dict(zip(header.split(","), first.split(","), strict=True))
    assert (row["peg2_jaw"], row["peg2_hole"], float(row["peg2_y"])) == ("wall", "fence", 0.0)
    assert float(row["peg2_x"]) == pytest.approx(result[0].pegs[1].x, abs=1e-8)


def test_angles_choose_what_lies_on_the_fence() -> None:
    """Seen from the drawing: the part turned so that one side is level."""
    theta = held(KITE)[0].pose.theta_deg
    asked = Restrictions(angles=((theta - 0.5, theta + 0.5),))
    result = design(Workpiece.from_loops("part", [KITE]), Fence(10, 3, wall_offset=5), restrictions=asked)
    assert {round(fixture.pose.theta_deg, 6) for fixture in result} == {round(theta, 6)}


def test_the_sheet_says_what_is_measured_and_how_far_the_set_up_may_be_moved() -> None:
    """Rows are fixed by the fence, so it may be moved along it only; two clamps have a tip each."""
    words = " ".join(word for page in draw_setup_sheet(held(KITE), 1) for word in texts(page))
    assert "centre of the locator or of the clamp's tip, from column A at the fence" in words.replace(
        "\n", " "
    )
    assert (
        "any columns further right; then measure all places from the column that takes the place of A"
        in words
    )
    assert "further up" not in words
    part = Workpiece.from_loops("block", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    two = design(part, Fence(20, 3, wall_offset=10, clamps=2, columns=4, rows=3))
    told = " ".join(word for page in draw_setup_sheet(two, 1) for word in texts(page))
    assert "of a clamp's tip" in told


def test_a_wall_is_touched_at_its_ends_and_a_pin_where_its_face_is() -> None:
    """The wall pushes up, whatever face of the part ends there."""
    face = Line((0.0, 0.0), (40.0, 30.0))
    assert find_contact(WALL_END, (12.0, 0.0), face) == ((12.0, 0.0), (0.0, -1.0))
    (x, y), (nx, ny) = find_contact(ROUND_PIN, (20.0, 15.0), face)
    assert (x, y) == pytest.approx((20.0, 15.0)) and (nx, ny) == pytest.approx((0.6, -0.8))


def test_a_seat_like_a_fixture_is_said_to_lie_flush() -> None:
    """In the picture of seats, and among those of the terminal, where a seat of pegs alone touches with four."""
    result = held(KITE, travel=(4, 30))
    fixture = result[0]
    seat = Seat("fixture", fixture.pose, fixture.travel + 1.0, 1.0, False, False, (), (), None, False)
    own = evolve(seat, jaw_separation=fixture.travel, difference=0.0, is_own=True)
    picture = texts(draw_seats([own, seat], fixture, result.workpiece, result.toolkit))
    assert picture.count("flush") == 2 and "four pegs" not in picture
    lengths = LengthUnit.from_typical_length(MILLIMETRE, 10.0)
    gauge = SeatingSentences(None, fixture, result.toolkit, lengths).gauge  # type: ignore[arg-type]
    table = tabulate_seats([own, seat], gauge, MILLIMETRE)
    assert [row[-1] for row in table.rows] == ["right", "flush on the fence"]


def test_what_lies_on_a_fence_ends_nowhere_that_matters() -> None:
    """Edges are infinitely far from the ends of the contact, and not from the locator and the tip."""
    result = held(KITE)
    edges = (
        TouchableFeatures.from_workpiece(result.workpiece, result.toolkit)
        .compute_for_fixture(result[0], result.toolkit)
        .edges[0]
    )
    assert [bool(isinf(edge)) for edge in edges] == [False, True, True, False]
