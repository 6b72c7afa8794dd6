"""The setup sheet: true to scale, complete, legible, whatever the size of the part."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from math import sqrt

import pytest
from attrs import evolve
from drawing_examples import any_set_up, diamond, example
from sheet_reading import collisions, distance, page_of, words_of
from svg_reading import by_class, scale_bar_of, texts, to_model

from fakes import fake_result
from workhold import Fixture, FlatJaw, Load, Peg, Pose, Vise, Workpiece, design
from workhold.conventions import NEAR_EDGE, STRONG_PEG, WEAK_CLOSURE
from workhold.drawing import SheetDetails, draw_setup_sheet, draw_sheet
from workhold.drawing.bench import make_bench
from workhold.drawing.scene import UNITS_PER_MM, Box, LengthUnit
from workhold.drawing.sheet import choose_standard_scale, fill_runs
from workhold.drawing.sheet_facts import PAPERS, choose_caliper_check, list_cautions, measure_edge_distances
from workhold.fixels.carrier import HoleSelection
from workhold.statics.loads import compute_load_cases
from workhold.units import INCH, MILLIMETRE, Unit

Held = tuple[Fixture, Workpiece, Vise]

DETAILS = SheetDetails(
    number=3, count=70, day=date(2026, 3, 31), result_hash="0123456789abcdef" * 4, version="1.2.3"
)
LONG_NAME = "bracket, left, revision C, machined side up, first operation of four " * 4
# Printers leave at least this blank, mm.
PRINTABLE = 5.0


def details_for(held: Held, **changes: object) -> SheetDetails:
    """Details with two loads, one of them at every corner of the part."""
    fixture, workpiece, vise = held
    corners = tuple((float(x), float(y)) for x, y, _ in workpiece.loops[0])
    loads = (Load(corners, 100.0, name="side milling"), Load(corners[:1], 30.0, (0.0, 90.0)))
    cases = compute_load_cases(fixture, workpiece, vise, loads, 2000.0, 0.15, "constant")
    return evolve(DETAILS, jaw_force=2000.0, friction=0.15, loads=cases, **changes)


def joined(pages: tuple[str, ...]) -> str:
    """All words of all pages, one after the other."""
    return " ".join(word for page in pages for word in texts(page))


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("size", [0.01, 1.0, 40.0], ids=["tiny", "usual", "huge"])
@pytest.mark.parametrize(("paper", "unit"), [("a4", MILLIMETRE), ("letter", INCH)])
@pytest.mark.parametrize("name", ["plate", LONG_NAME], ids=["named", "long name"])
@pytest.mark.parametrize("made", [example, diamond])
def test_nothing_is_covered_or_cut_off(
    size: float, paper: str, unit: Unit, name: str, made: Callable[..., Held]
) -> None:
    """No word lies on another, and all lie within what a printer prints."""
    held = made(size)
    changes = {"paper": paper, "unit": unit, "part_name": name, "others": 2}
    details = evolve(DETAILS, **changes) if made is example else details_for(held, **changes)
    pages = draw_sheet(*held, details)
    sides = {round(UNITS_PER_MM * side, 3) for side in PAPERS[paper]}
    for page in pages:
        box = page_of(page)
        assert {box.width, box.height} == sides
        assert collisions(page) == []
        inside = box.grow(-PRINTABLE * UNITS_PER_MM)
        assert [word for word, place in words_of(page) if not inside.contains(place)] == []


# The last ones are crowds in which the opening lay under a peg's name, or the letters of two jaws ran together.
@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", [*range(60), 64, 148, 184, 190, 232])
def test_no_two_labels_overlap_on_any_sheet(seed: int) -> None:
    """Column letters of jaws that all but meet, names of pegs in one row, the opening over them: all can be read."""
    unit, paper = (MILLIMETRE, INCH)[seed % 2], ("a4", "letter")[seed // 2 % 2]
    details = evolve(DETAILS, unit=unit, paper=paper, others=seed % 3, jaw_force=2000.0 if seed % 5 else None)
    for page in draw_sheet(*any_set_up(seed), details):
        assert collisions(page) == []
        inside = page_of(page).grow(-PRINTABLE * UNITS_PER_MM)
        assert [word for word, place in words_of(page) if not inside.contains(place)] == []


def test_a_hole_that_places_are_told_from_is_shown_with_room_for_its_name() -> None:
    """L-A1 lies two columns left of the last one that shows; its name and those at the rim stay on the paper."""
    fixture, workpiece, vise = diamond()
    pegs = [
        evolve(peg, x=peg.x + 30, column=peg.column + 3 * (peg.carrier == "left")) for peg in fixture.pegs
    ]
    moved = evolve(fixture, pegs=tuple(pegs), pose=evolve(fixture.pose, x=fixture.pose.x + 30))
    for paper in PAPERS:
        page = draw_sheet(moved, workpiece, evolve(vise, columns=4), evolve(DETAILS, paper=paper))[0]
        inside = page_of(page).grow(-PRINTABLE * UNITS_PER_MM)
        places = dict(words_of(page))
        assert inside.contains(places["L-A1 (0, 0)"]) and inside.contains(places["row"])
        assert collisions(page) == []


def test_distances_on_paper_times_the_scale_are_those_of_the_model(held: Held) -> None:
    """The scale that is written is a standard one and that of the drawing: pegs stand as far apart on paper as it says."""
    page = draw_sheet(*held, DETAILS)[0]
    (cell,) = (word for word in texts(page) if word.endswith(" on A4"))
    paper, model = (float(word) for word in cell.removesuffix(" on A4").split(":"))
    pegs = [(float(peg.attrib["cx"]), float(peg.attrib["cy"])) for peg in by_class(page, "peg")]
    for one, at in zip(held[0].pegs, pegs, strict=True):
        for other, other_at in zip(held[0].pegs, pegs, strict=True):
            on_paper = distance(at, other_at) / UNITS_PER_MM
            assert on_paper * model / paper == pytest.approx(
                distance((one.x, one.y), (other.x, other.y)), rel=2e-4
            )
    assert min(paper, model) == 1 and f"{max(paper, model):e}"[:3] in {
        "1.0",
        "1.5",
        "2.0",
        "2.5",
        "3.0",
        "4.0",
        "5.0",
        "6.0",
        "8.0",
    }


@pytest.mark.thorough
def test_scale_bar_is_as_long_as_it_says(held: Held) -> None:
    """The four pieces of the bar together measure the length beside it, in inches too."""
    for unit, size in ((MILLIMETRE, 1.0), (INCH, 25.4)):
        page = draw_sheet(*held, evolve(DETAILS, unit=unit))[0]
        length, words = scale_bar_of(page)
        assert float(words.split()[0]) * size == pytest.approx(length, rel=1e-4)


def test_pegs_are_labelled_by_the_holes_they_stand_in(held: Held) -> None:
    """On the plan every peg's centre is that of the hole whose name its row of the table gives."""
    fixture, _, vise = held
    page = draw_sheet(*held, DETAILS)[0]
    (group,) = by_class(page, "pegs")
    (labels,) = by_class(page, "labels")
    flags = [element.text for element in labels.iter() if element.tag.endswith("text")]
    for peg, circle in zip(fixture.pegs, by_class(page, "peg"), strict=True):
        x, y = to_model(group, float(circle.attrib["cx"]), float(circle.attrib["cy"]))
        column, row = ord(peg.hole[2]) - ord("A"), int(peg.hole[3:]) - 1
        place = vise.carriers[int(peg.hole[0] == "R")].compute_hole_center(column, row, fixture.travel)
        assert distance((x, y), place) < 1e-3 * vise.peg_radius
        assert peg.hole in flags
        assert texts(page).count(peg.hole) >= 2  # on the plan and in the table


@pytest.mark.parametrize("size", [0.01, 1.0, 40.0])
def test_all_a_machinist_needs_is_written(size: float) -> None:
    """Part, date, result, version, opening, zero, angle, loads and reactions."""
    held = diamond(size)
    fixture, workpiece, _ = held
    words = joined(draw_sheet(*held, details_for(held)))
    pose, lengths = fixture.pose, LengthUnit.from_typical_length(MILLIMETRE, held[2].pitch[0])
    for wanted in [
        workpiece.name,
        "2026-03-31",
        "0123456789ab…",
        "workhold 1.2.3",
        "Fixture 3 of 70",
        lengths.format_length(fixture.travel),
        lengths.format_length(pose.x),
        lengths.format_length(pose.y),
        "45.0000°",
        "side milling",
        "load 2",
        "µ 0.15",
        "2000 N",
    ]:
        assert wanted in words


@pytest.mark.parametrize("size", [0.01, 1.0])
def test_a_drawing_far_from_its_origin_has_its_zero_on_the_part(size: float) -> None:
    """Drawn two metres off, the diamond's zero is its lower left corner, where it lies; both plan and inset show it."""
    fixture, workpiece, vise = diamond(size)
    far = Workpiece.from_loops(
        "far", [[[x + 2000, y - 300, bulge] for x, y, bulge in loop] for loop in workpiece.loops]
    )
    x, y = fixture.pose.apply(-2000.0, 300.0)
    page = draw_sheet(evolve(fixture, pose=Pose(45.0, float(x), float(y))), far, vise, DETAILS)[0]
    lengths = LengthUnit.from_typical_length(MILLIMETRE, vise.pitch[0])
    words = texts(page)
    assert "lower left corner as drawn" in words
    assert {lengths.format_length(fixture.pose.x), lengths.format_length(fixture.pose.y)} <= set(words)
    assert "X0 Y0" in words and "outside the plan" not in joined((page,))


def test_forces_are_per_kilonewton_and_at_the_jaw_force() -> None:
    """A peg that takes 1 / sqrt(2) of the jaw force takes 707 N per kN, and 1414 N at 2000 N."""
    held = diamond()
    words = texts(draw_sheet(*held, details_for(held))[0])
    assert words.count("707") == 4 and words.count("1414 N") == 4


def test_text_is_the_same_every_time() -> None:
    """Two runs give the same bytes."""
    assert draw_sheet(*example(), DETAILS) == draw_sheet(*example(), DETAILS)


def test_sheet_says_when_the_part_has_no_room_on_one_page() -> None:
    """A part that two pages show larger has two; each tells which it is."""
    pages = draw_sheet(*example(2.0), DETAILS)
    for number, page in enumerate(pages, 1):
        assert f"{number} of {len(pages)}" in texts(page)


@pytest.mark.parametrize(
    ("largest", "name"),
    [
        (1.0, "1:1"),
        (1.499, "1:1"),
        (2.0, "2:1"),
        (0.5, "1:2"),
        (0.4999, "1:2.5"),
        (0.0334, "1:30"),
        (0.12, "1:10"),
        (39.0, "30:1"),
    ],
)
def test_scales_are_the_standard_ones_that_still_fit(largest: float, name: str) -> None:
    """ISO 5455, 1, 2, 5 and their decades, and round ones between."""
    scale = choose_standard_scale(largest)
    assert scale.name == name and scale.factor <= largest


def test_calipers_measure_the_jaw_separation() -> None:
    """Level holes at the opening are S apart, and those with pegs are preferred."""
    fixture, _, vise = example()
    check = choose_caliper_check(fixture, vise)
    assert (check.left, check.right) == ((1, 0), (0, 0)) and check.distance == pytest.approx(fixture.travel)
    assert check.placed == 1
    both = evolve(fixture.pegs[2], row=4, y=40.0)
    pegs = (fixture.pegs[0], fixture.pegs[1], both, fixture.pegs[3])
    assert choose_caliper_check(evolve(fixture, pegs=pegs), vise).left == (1, 4)


@pytest.mark.parametrize("offset", [-25.0, -3.0, 4.0, 6.0, 33.0])
def test_calipers_know_jaws_that_are_not_level(offset: float) -> None:
    """With a row offset the holes are level within half a pitch and the distance is that of their centres."""
    fixture, _, vise = example()
    vise = evolve(vise, row_offset=offset)
    check = choose_caliper_check(fixture, vise)
    left = vise.carriers[0].compute_hole_center(*check.left, fixture.travel)
    right = vise.carriers[1].compute_hole_center(*check.right, fixture.travel)
    assert abs(left[1] - right[1]) <= vise.pitch[1] / 2
    assert check.distance == pytest.approx(distance(left, right))


def test_calipers_keep_off_blocked_holes() -> None:
    """A blocked hole takes no pin."""
    fixture, _, vise = example()
    assert choose_caliper_check(fixture, evolve(vise, blocked=(HoleSelection("right", 0, 0),))).right != (
        0,
        0,
    )


def test_edges_are_measured_along_the_face() -> None:
    """In the diamond every contact is 20 - (23 sqrt(2) - 20) / sqrt(2) mm from the nearer corner of its side."""
    expected = 20 - (23 * sqrt(2) - 20) / sqrt(2)
    assert measure_edge_distances(*diamond()) == pytest.approx([expected] * 4)
    assert measure_edge_distances(*diamond(40.0)) == pytest.approx([40 * expected] * 4)


def test_tangent_joints_are_no_edges() -> None:
    """With the left corner rounded, the left contacts are as far from an edge as the far corners of their sides."""
    near = 20 - (23 * sqrt(2) - 20) / sqrt(2)
    assert measure_edge_distances(*diamond(rounded=True)) == pytest.approx([40 - near, 40 - near, near, near])


def test_a_part_without_edges_has_no_distance_from_one() -> None:
    """The figure is then a length that only stands for none; a part with corners keeps its own."""
    turn = sqrt(2) - 1
    rounded = [
        (5.0, 0.0),
        (35.0, 0.0, turn),
        (40.0, 5.0),
        (40.0, 25.0, turn),
        (35.0, 30.0),
        (5.0, 30.0, turn),
        (0.0, 25.0),
        (0.0, 5.0, turn),
    ]
    square = [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0)]
    for loop, has_none in ((rounded, True), (square, False)):
        part = Workpiece.from_loops("part", [[(*point, 0.0)[:3] for point in loop]])
        result = design(part, Vise(pitch=(10.0, 10.0), columns=2, peg_radius=3.0))
        pages = draw_sheet(result[0], part, result.toolkit, DETAILS)
        written = {words for page in pages for words, _ in words_of(page)}
        assert ("no edge there" in written) == has_none


def test_cautions_name_what_is_close_weak_or_strong() -> None:
    """Each threshold is warned of below and not above."""
    fixture, _, vise = example()
    lengths, far = LengthUnit.in_mm(), [10.0] * 4

    def kinds(fixture: Fixture, distances: list[float], **changes: object) -> list[str]:
        return [
            caution.kind
            for caution in list_cautions(fixture, vise, distances, evolve(DETAILS, **changes), lengths)
        ]

    def with_quality(**figures: float) -> Fixture:
        return evolve(fixture, quality=figures)

    assert kinds(fixture, far) == []
    assert kinds(fixture, [10.0, 0.99 * NEAR_EDGE, 10.0, 1.01 * NEAR_EDGE]) == ["edge"]
    assert kinds(with_quality(closure_margin=0.99 * WEAK_CLOSURE), far) == ["closure"]
    assert kinds(with_quality(closure_margin=1.01 * WEAK_CLOSURE), far) == []
    strong: Peg = evolve(fixture.pegs[0], force=1.01 * STRONG_PEG)
    assert kinds(evolve(fixture, pegs=(strong, *fixture.pegs[1:])), far) == ["amplification"]
    assert kinds(with_quality(location_error=0.09), far) == []
    assert kinds(with_quality(location_error=0.11), far) == ["location"]
    assert kinds(fixture, far, others=1) == ["pose"]


def test_a_jaw_force_too_small_for_a_load_is_warned_of() -> None:
    """Just below the jaw force needed a peg lets go, and the sheet says which and how much it takes."""
    fixture, workpiece, vise = diamond()
    load = (Load(((30.0, 20.0),), 100.0),)
    (needed,) = compute_load_cases(fixture, workpiece, vise, load)
    for share, expected in ((0.9, ["load"]), (1.1, [])):
        force = share * needed.needed.value
        cases = compute_load_cases(fixture, workpiece, vise, load, force)
        found = list_cautions(
            fixture, vise, [10.0] * 4, evolve(DETAILS, jaw_force=force, loads=cases), LengthUnit.in_mm()
        )
        assert [caution.kind for caution in found] == expected


def test_other_fixtures_in_the_same_holes_are_counted() -> None:
    """Fixture 0 put into a table three times has two others in its holes."""
    again = fake_result(5).table.take([0, 1, 0, 2, 0])  # type: ignore[arg-type]
    assert [again.count_in_same_holes(index) for index in range(5)] == [2, 0, 2, 0, 2]


@pytest.mark.thorough
def test_names_in_other_scripts_and_without_end_are_drawn() -> None:
    """Whatever the name, the sheet is made and stays on the page."""
    held = example(name="部品 <b>&amp;" + "x" * 500)
    for page in draw_sheet(*held, DETAILS):
        assert all(page_of(page).contains(box) for _, box in words_of(page))


@pytest.mark.thorough
@pytest.mark.parametrize(
    "vise",
    [
        Vise(pitch=10, columns=2, peg_radius=0),
        Vise(pitch=0.2, columns=200, peg_radius=0.05),
        Vise(pitch=10, columns=2, peg_radius=3, rows=5, row_offset=-4.0),
        Vise(pitch=(500, 700), columns=1, peg_radius=3, body_radius=5),
    ],
    ids=["points", "very fine", "rows and offset", "very coarse"],
)
def test_unusual_vises_have_sheets(vise: Vise) -> None:
    """Any vise gives pages with four pegs on which all words are within the page."""
    fixture, workpiece, _ = example()
    pegs = tuple(evolve(peg, column=min(peg.column, vise.columns - 1)) for peg in fixture.pegs)
    pages = draw_sheet(evolve(fixture, pegs=pegs), workpiece, vise, DETAILS)
    assert len(by_class(pages[0], "peg")) == 4
    for page in pages:
        assert all(page_of(page).contains(box) for _, box in words_of(page))


def test_boxes_of_words_are_found_to_collide() -> None:
    """The test of collisions itself sees two words on one place."""
    text = '<text x="10" y="20" font-size="10">word</text>'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 99 99">{text}{text}</svg>'
    assert collisions(svg) == [("word", "word")]
    assert words_of(svg)[0][1].compute_overlap_area(Box(0, 0, 99, 99)) > 0


def test_words_fill_the_second_page_before_a_third_begins() -> None:
    """Blocks at the end stand where a column has room; a view from the side gives way for a few words more."""
    part = Workpiece.from_loops("block", [[(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]])
    result = design(part, Vise(pitch=20, columns=3, peg_radius=3), best=2)
    pages = draw_setup_sheet(result, 1, thickness=20.0)
    assert len(pages) == 2
    words = " ".join(word for page in pages for word, _ in words_of(page))
    assert all(block in words for block in ("Quality", "Counting holes", "Signs", "Side view"))
    assert all(collisions(page) == [] for page in pages)


def test_columns_are_filled_up_in_any_order_only_to_save_a_page() -> None:
    """In order where that fits; the last ones below the others where it does not; None where nothing does."""
    blocks = [lambda column, k=k: None for k in range(5)]
    heights = [6.0, 5.0, 6.0, 4.0, 1.0]
    assert fill_runs(blocks, heights, 2, 12.0) == [tuple(blocks[:2]), tuple(blocks[2:])]
    heights = [6.0, 9.0, 3.0, 5.0, 1.0]
    found = fill_runs(blocks, heights, 2, 12.0)
    assert found is not None and sorted(blocks.index(one) for run in found for one in run) == [0, 1, 2, 3, 4]
    assert all(sum(heights[blocks.index(one)] for one in run) <= 12.0 for run in found)
    assert fill_runs(blocks, heights, 2, 11.0) is None


def test_a_face_on_a_flat_jaw_is_painted_no_farther_than_the_jaw() -> None:
    """What stands out beyond the jaw's ends touches nothing."""
    part = Workpiece.from_loops("triangle", [[(0, 0, 0), (120, 0, 0), (40, 80, 0)]])
    jaw = FlatJaw(pitch=12.7, columns=7, peg_radius=3.175, jaw_width=101.6)
    fixture = next(
        one for one in design(part, jaw) if {peg.face for peg in one.pegs if peg.beside is None} == {0, 1, 2}
    )
    bench = make_bench(fixture, part, jaw)
    for index in bench.on_walls:
        piece = bench.find_touched_piece(index)
        ends = sorted(x for x, _ in (piece.start, piece.end))
        assert ends == pytest.approx(sorted(fixture.pegs[k].x for k in bench.on_walls))
        assert ends[1] - ends[0] <= 101.6 + 1e-6 < bench.faces[index].length
    others = [k for k in bench.touching if k not in bench.on_walls]
    assert others and all(bench.find_touched_piece(k) == bench.faces[k] for k in others)
