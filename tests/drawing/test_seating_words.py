"""What the sheet says of where the part ends up: bounds that hold, readings of the seats, pages that can be read."""

from __future__ import annotations

from datetime import date
from math import hypot, radians, sin

import pytest
from attrs import evolve
from sheet_reading import collisions, page_of, words_of
from svg_reading import by_class, texts

import workhold
from workhold import Fence, Load, Plate, Result, Vise, Workpiece
from workhold.drawing import SheetDetails, draw_setup_sheet, draw_sheet
from workhold.drawing.scene import UNITS_PER_MM, LengthUnit
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.sheet_facts import list_result_cautions
from workhold.model.clamps import describe_tightening_order
from workhold.model.quality import FIGURE_RANKING
from workhold.model.seating import CLOSE_READING, SMALL_CAPTURE, Seating
from workhold.statics.loads import compute_load_cases
from workhold.units import INCH, MILLIMETRE, Unit

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [70, 0, 0], [25, 55, 0]]])
DETAILS = SheetDetails(number=3, count=70, day=date(2026, 3, 31), result_hash="", version="1.2.3")
# Printers leave at least this blank, mm.
PRINTABLE = 5.0


@pytest.fixture(scope="module")
def result() -> Result:
    """The best fixtures of a wedge by figures: seats of the first one read alike, those of the second do not."""
    return workhold.design(WEDGE, Vise(pitch=20, columns=2, peg_radius=3), best=4, rank_by=FIGURE_RANKING)


@pytest.fixture(scope="module")
def told(result: Result) -> list[Seating]:
    """What else their pegs can do."""
    return workhold.seatings(result, 4)


def words_for(result: Result, told: Seating, number: int = 0, unit: Unit = MILLIMETRE) -> SeatingSentences:
    """The words of a fixture."""
    return SeatingSentences(told, result[number], result.toolkit, LengthUnit.from_typical_length(unit, 20.0))


def with_seats(told: Seating, wrong: int) -> Seating:
    """The same with its own seat and so many wrong ones."""
    own = [seat for seat in told.seats if not seat.is_wrong]
    return evolve(told, seats=tuple(own + [seat for seat in told.seats if seat.is_wrong][:wrong]))


@pytest.mark.thorough
@pytest.mark.parametrize(("paper", "unit"), [("a4", MILLIMETRE), ("letter", INCH)])
@pytest.mark.parametrize("wrong", [0, 1, 2, 23])
def test_nothing_is_covered_or_cut_off(
    result: Result, told: list[Seating], paper: str, unit: Unit, wrong: int
) -> None:
    """Whatever the number of pictures: no word lies on another and all lie within what a printer prints, on as many pages as
    it takes, and there is a picture for the right seat and up to five wrong ones."""
    details = evolve(DETAILS, paper=paper, unit=unit, seating=with_seats(told[0], wrong), jaw_force=2000.0)
    pages = draw_sheet(result[0], result.workpiece, result.toolkit, details)
    for page in pages:
        assert collisions(page) == []
        inside = page_of(page).grow(-PRINTABLE * UNITS_PER_MM)
        assert [word for word, place in words_of(page) if not inside.contains(place)] == []
    drawn = sum(
        element.tag.endswith("rect")
        for page in pages
        for group in by_class(page, "seats")
        for element in group
    )
    assert drawn == min(wrong + 1, 6)
    words = " ".join(word for page in pages for word in texts(page))
    assert ("18 more are off by more" in words) == (wrong == 23)
    assert ("in one wrong place" in words) == (wrong == 1) and ("no wrong place in which" in words) == (
        wrong == 0
    )
    assert f"{len(pages)} of {len(pages)}" in words


@pytest.mark.thorough
def test_blocks_that_need_a_third_page_get_one(result: Result, told: list[Seating]) -> None:
    """A name and sentences that fill pages: everything still stands on one, and on paper."""
    long = evolve(
        told[0],
        unsettled=tuple(f"place {k} where the part may rest could not be settled." for k in range(30)),
    )
    loads = [Load(((20.0, 10.0 + k),), 100.0 + k, name=f"pass {k}") for k in range(6)]
    cases = compute_load_cases(result[0], result.workpiece, result.toolkit, loads)
    details = evolve(DETAILS, seating=long, part_name="bracket, first operation " * 8, loads=cases)
    pages = draw_sheet(result[0], result.workpiece, result.toolkit, details)
    foot = page_of(pages[0]).y1 - 44
    for page in pages:
        assert collisions(page) == [] and max(box.y1 for _, box in words_of(page)) < foot
    assert len(pages) > 2
    words = " ".join(word for page in pages for word in texts(page))
    assert all(f"Place {k} where" in words for k in range(30))


@pytest.mark.thorough
@pytest.mark.parametrize("unit", [MILLIMETRE, INCH])
@pytest.mark.parametrize("number", range(4))
def test_bounds_are_never_told_too_wide(result: Result, told: list[Seating], unit: Unit, number: int) -> None:
    """Jaws opened as told are open by less than the capture opening, and a part put in as told lies nearer than placing."""
    one, words = told[number], words_for(result, told[number], number, unit)
    first, second = words.list_steps(WEDGE)[:2]
    number_of = [float(word) * unit.millimetres for word in first.split() if word.replace(".", "").isdigit()]
    wide, more, room = number_of
    assert one.capture_opening is not None and one.placing is not None and one.drop_room is not None
    right = result[number].travel
    assert (
        right < wide <= right + one.capture_opening
        and 0.9 * one.capture_opening < more <= one.capture_opening
    )
    assert room <= one.drop_room
    shift, turn = (
        float(word.rstrip("°")) for word in second.split() if word.rstrip("°").replace(".", "").isdigit()
    )
    (x0, y0), corners = WEDGE.center, WEDGE.loops[0][:, :2]
    arm = max(hypot(x - x0, y - y0) for x, y in corners)
    reached = shift * unit.millimetres + 2.0 * arm * sin(radians(turn) / 2.0)
    assert 0.85 * one.placing < reached <= one.placing


def test_the_nearest_readings_come_first(result: Result, told: list[Seating]) -> None:
    """Each with its reading and how it differs; those that the jaws cannot open to are left out."""
    words = words_for(result, told[1], 1)
    off = [abs(seat.difference) for seat in words.wrong]
    assert off == sorted(off) and len(off) == len(told[1].list_wrong_seats())
    near = words.wrong[0]
    pages = draw_sheet(result[1], WEDGE, result.toolkit, evolve(DETAILS, seating=told[1]))
    written = [word for page in pages for word in texts(page)]
    assert f"S = {near.jaw_separation:.3f} mm" in written
    assert f"{abs(near.difference):.3f} mm {'more' if near.difference > 0 else 'less'}" in written
    assert f"S = {result[1].travel:.3f} mm" in written and "right" in written
    most = sorted(seat.jaw_separation for seat in told[1].seats if seat.is_wrong)[2] + 1e-6
    assert len(words_for(result, evolve(told[1], most=most), 1).wrong) == 3
    near = words_for(result, evolve(told[1], opening=words.wrong[2].difference + 1e-6), 1)
    assert len(near.wrong) < len(words.wrong) and "opened by no more than" in near.describe_wrong_seats()[0]


def test_it_is_told_whether_the_reading_tells(result: Result, told: list[Seating]) -> None:
    """The first fixture's wrong seats read like the right one, those of the second do not."""
    first, second = (words_for(result, told[k], k).describe_wrong_seats()[0] for k in (0, 1))
    assert "the reading alone does not show it" in first and second.endswith(": the reading shows it.")


def test_friction_is_told_where_dry_steel_sticks(result: Result, told: list[Seating]) -> None:
    for friction, sticks in ((0.19, True), (0.21, False)):
        steps = words_for(result, evolve(told[0], sticking_friction=friction)).list_steps(WEDGE)
        assert any("tap it home as you close" in step for step in steps) == sticks


def test_what_never_gets_out_may_be_opened_as_far_as_one_likes(result: Result, told: list[Seating]) -> None:
    """And what gets out only where the jaws do not reach, as far as they go."""
    free = words_for(result, evolve(told[0], capture_opening=None, placing=None)).list_steps(WEDGE)
    assert "as far as you like" in free[0] and not any("Put the part in" in step for step in free)
    most = result[0].travel + 0.5 * (told[0].capture_opening or 0.0)
    assert "as far as possible" in words_for(result, evolve(told[0], most=most)).list_steps(WEDGE)[0]


def test_a_part_that_is_hardly_caught_is_warned_of(result: Result, told: list[Seating]) -> None:
    """Just below each threshold and not above; a reading that is no different is told as that."""

    def kinds(capture: float, off: float) -> list[str]:
        wrong = next(seat for seat in told[0].seats if seat.is_wrong)
        own = next(seat for seat in told[0].seats if seat.is_own)
        seats = (own, evolve(wrong, difference=off))
        return [
            kind
            for kind, _ in words_for(
                result, evolve(told[0], capture_opening=capture, seats=seats)
            ).list_cautions()
        ]

    assert kinds(1.01 * SMALL_CAPTURE, -1.01 * CLOSE_READING) == []
    assert kinds(0.99 * SMALL_CAPTURE, 1.01 * CLOSE_READING) == ["capture"]
    assert kinds(1.01 * SMALL_CAPTURE, -0.99 * CLOSE_READING) == ["reading"]
    (caution,) = words_for(result, told[0]).list_cautions()
    assert caution[0] == "reading" and "no different" in caution[1]


@pytest.mark.thorough
def test_it_is_told_where_it_is_known_or_asked_for(result: Result, told: list[Seating]) -> None:
    """A sheet of a result that has it is the one that is asked for; without, neither page nor sheet tell anything of it."""
    sheets = {seating: draw_setup_sheet(result, 1, seating=seating) for seating in (True, None)}
    asked, plain = (" ".join(word for page in pages for word in texts(page)) for pages in sheets.values())
    kept = evolve(result, seating=tuple(told))
    same = {
        seating: draw_setup_sheet(kept, 1, seating=seating) == sheets[True] for seating in (None, True, False)
    }
    assert same == {None: True, True: True, False: False}
    assert "Does the part end up there?" in asked and "no different" in asked
    assert "Does the part end up there?" not in plain
    assert [c.kind for c in list_result_cautions(result, 1, seating=True)] == ["reading"]
    assert "reading" not in [c.kind for c in list_result_cautions(result, 1)]


def test_what_cannot_be_told_is_left_out_with_its_sentence() -> None:
    plate = workhold.design(WEDGE, Plate(pitch=20, peg_radius=0.0), best=1)
    words = " ".join(word for page in draw_setup_sheet(plate, 1, seating=True) for word in texts(page))
    assert "Does the part end up there?" in words and "What it looks like" not in words
    with pytest.raises(workhold.InputError) as refusal:
        workhold.seatings(plate)
    assert str(refusal.value)[1:] in words


@pytest.mark.thorough
@pytest.mark.parametrize(
    "toolkit",
    [Plate(pitch=20, peg_radius=3, clamps=2), Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2)],
)
def test_with_two_clamps_it_says_what_to_do_by_hand(toolkit: Plate | Fence) -> None:
    """Each step but the order of tightening, which has a block of its own; where it is asked for, or the result was asked
    for the seating of so many fixtures. What else lies in the same holes is still warned of, and nothing is cut off."""
    result = workhold.design(WEDGE, toolkit, best=3, seating=2)
    for rank in (2, 3):
        [told] = workhold.seatings(result, [result[rank - 1]])
        for seating in (True, None, False):
            pages = draw_setup_sheet(result, rank, seating=seating)
            words = " ".join(word for page in pages for word in texts(page))
            wanted = seating or (seating is None and rank == 2)
            steps = told.list_steps(
                LengthUnit.from_typical_length(MILLIMETRE, 20.0).format_length, with_order=False
            )
            why = "Neither of the two clamps holds the part alone"
            assert all((part in words) == wanted for part in (why, *steps, "Does the part end up there?"))
            assert words.count(describe_tightening_order(result[rank - 1])) == 2
            assert "What it looks like" not in words and not any(collisions(page) for page in pages)
    [asked, plain] = [list_result_cautions(result, 1, seating=seating) for seating in (True, False)]
    assert asked == plain


@pytest.mark.thorough
def test_a_clamp_is_drawn_back_and_tightened() -> None:
    """Words and readings of a clamp whose stroke gets less as it is drawn back, and never told wider than it may be."""
    toolkit = Plate(pitch=20, peg_radius=3, directions=["+y"], travel=(1, 40))
    # Of a plate's fixtures some are caught however far the clamp goes back; this one is not.
    plate = workhold.design(WEDGE, toolkit, best=1, rank_by=FIGURE_RANKING)
    (told,) = workhold.seatings(plate)
    words = words_for(plate, told)
    steps = words.list_steps(WEDGE)
    right, capture = -plate[0].travel, told.capture_opening or 0.0
    least = float(steps[0].split("stroke = ")[1].split()[0])
    assert steps[0].startswith("Draw the clamp back to stroke = ") and "at least" in steps[0]
    assert right - capture <= least < right - capture + 0.01
    assert any(
        step.startswith("Tighten it. The right reading is stroke = ") and "While the reading is less" in step
        for step in steps
    )
    # Readings as long as that stand on the sheet uncut.
    pages = draw_sheet(plate[0], WEDGE, plate.toolkit, evolve(DETAILS, seating=told))
    written = [word for page in pages for word in texts(page)]
    assert (
        words.format_reading(right) in written
        and words.format_reading(words.compute_reading(words.wrong[0])) in written
    )
    assert all(collisions(page) == [] for page in pages)
    lower = next(seat for seat in told.seats if seat.difference > 0.1)
    assert words.describe_difference(lower).endswith("less")
