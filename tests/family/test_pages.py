"""The curve and the sheets of a plan: everything is there, legible, and on paper as on the screen."""

from __future__ import annotations

from datetime import date

import pytest
from attrs import evolve
from sheet_reading import collisions, page_of, words_of
from svg_reading import by_class, texts

from family_parts import shop_parts
from own_heights import STEM, stepped
from workhold import Plate, Query, Vise
from workhold.drawing.pdf import convert_svg_to_pdf
from workhold.family.family import Family, MemberRequest, make_family
from workhold.family.members import RANKINGS, format_loss
from workhold.family.pages import describe_moves, draw_curve, draw_setups, list_holes, make_grid
from workhold.family.plan import FamilyPlan
from workhold.geometry.segment import Box
from workhold.units import INCH, MILLIMETRE, Unit

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

DAY = date(2026, 3, 31)


def family_in(toolkit: Vise | Plate, count: int) -> Family:
    """A family of so many parts."""
    ranking = RANKINGS[toolkit.travel_count]
    return make_family(
        [MemberRequest(part.name, Query(part, toolkit, rank_by=ranking)) for part in shop_parts(count)],
        threads=1,
    )


@pytest.fixture(scope="module")
def families() -> dict[str, Family]:
    """Families in a vise, in one whose pegs move outward, and on a plate with two clamps."""
    return {
        "vise": family_in(Vise(pitch=10, columns=1, peg_radius=3), 14),
        "largest opening": family_in(Vise(pitch=10, columns=3, peg_radius=3, rows=10, max_opening=45), 5),
        "two clamps": family_in(Plate(pitch=20, peg_radius=3, clamps=2, travel=(10, 35)), 4),
    }


def on_page(svg: str) -> bool:
    """Whether all words stand on the page."""
    return all(page_of(svg).contains(box) for _, box in words_of(svg))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "place", "unit"),
    [("vise", 0, MILLIMETRE), ("vise", 3, INCH), ("largest opening", 0, MILLIMETRE), ("two clamps", 0, INCH)],
)
def test_sheets_tell_every_part_of_every_set_up(
    families: dict[str, Family], name: str, place: int, unit: Unit
) -> None:
    family = families[name]
    plan = family.plans[place]
    pages = draw_setups(plan, family.figure, DAY, unit)
    shown = iter(pages)
    for number, setup in enumerate(plan.setups, 1):
        words: list[str] = []
        for _ in range(1 + (len(setup.holdings) > 12)):
            page = next(shown)
            assert not collisions(page) and on_page(page)
            assert f"Set-up {number} of {len(plan.setups)}:" in texts(page)[0]
            words += texts(page)
        for hole in list_holes(setup):
            assert any(hole in word for word in words)
        for one in setup.holdings:
            # In its cell and in its table.
            assert words.count(one.member.name) == 2
            assert f"{one.fixture.pose.written_deg:z.4f}°" in words
            assert format_loss(one.loss) in words
    assert next(shown, None) is None
    assert convert_svg_to_pdf(pages, DAY)
    assert pages == draw_setups(plan, family.figure, DAY, unit)


@pytest.mark.thorough
def test_many_parts_of_a_set_up_go_on_further_pages(families: dict[str, Family]) -> None:
    setup = families["vise"].plans[0].setups[0]
    one = setup.holdings[0]
    many = [evolve(one, member=evolve(one.member, name=f"n{k}")) for k in range(32)]
    plan = FamilyPlan(families["vise"].points[0], (evolve(setup, holdings=tuple(many)),))
    pages = draw_setups(plan, families["vise"].figure, DAY)
    assert [len(by_class(page, "part-cell")) for page in pages] == [12, 18, 2]
    assert [f"page {k} of 3" in " ".join(texts(page)) for k, page in enumerate(pages, 1)] == [True] * 3
    assert sum(f"n{k}" in texts(page) for k in range(32) for page in pages) == 32
    for page in pages:
        assert not collisions(page) and on_page(page)


@pytest.mark.thorough
def test_a_name_however_long_stays_in_its_place(families: dict[str, Family]) -> None:
    family = families["vise"]
    long = [
        evolve(
            setup,
            holdings=tuple(
                evolve(one, member=evolve(one.member, name="bracket, revision C " * 9))
                for one in setup.holdings
            ),
        )
        for setup in family.plans[0].setups
    ]
    for page in draw_setups(evolve(family.plans[0], setups=tuple(long)), family.figure, DAY):
        assert not collisions(page) and on_page(page)


@pytest.mark.thorough
def test_a_name_with_room_is_told_in_full(families: dict[str, Family]) -> None:
    """A name that is wider than its column takes another line of the table; nothing of it is cut off."""
    family, name = families["vise"], "left hand mounting bracket of the second conveyor, revision 12"
    long = [
        evolve(
            setup,
            holdings=tuple(evolve(one, member=evolve(one.member, name=name)) for one in setup.holdings[:2]),
        )
        for setup in family.plans[0].setups
    ]
    for page in draw_setups(evolve(family.plans[0], setups=tuple(long)), family.figure, DAY):
        assert not collisions(page) and on_page(page)
        words = " ".join(each.text or "" for each in by_class(page, "table")[0].iter())
        assert words.count("revision 12") >= 1 and "…" not in words


@pytest.mark.thorough
def test_what_is_moved_is_told(families: dict[str, Family]) -> None:
    plan = next(plan for plan in families["vise"].plans if len(plan.setups) > 2)
    assert list(describe_moves(plan.setups[0], None)) == []
    before, after = plan.setups[:2]
    (words,) = describe_moves(after, before)
    placed = words.partition("place ")[2].partition(";")[0].split(", ")
    assert len(placed) == after.moved
    assert set(placed) <= set(list_holes(after)) and not set(placed) & set(list_holes(before))
    assert list(describe_moves(before, before)) == ["After the set-up before: all pegs stay."]


@pytest.mark.thorough
def test_pegs_in_other_columns_are_named(families: dict[str, Family]) -> None:
    family = families["largest opening"]
    apart = [
        (plan, one)
        for plan in family.plans
        for setup in plan.setups
        for one in setup.holdings
        if not one.in_place
    ]
    assert apart
    plan, one = apart[0]
    words = " ".join(word for page in draw_setups(plan, family.figure, DAY) for word in texts(page))
    assert (
        f"* {one.member.name}: the same pegs in {', '.join(peg.hole for peg in one.fixture.pegs)}." in words
    )


@pytest.mark.parametrize("count", range(1, 25))
def test_cells_fill_their_room_without_overlap(count: int) -> None:
    room = Box(0.0, 0.0, 650.0, 400.0)
    cells = make_grid(count, room)
    assert len(cells) == count
    assert all(room.grow(1e-9).contains(cell) for cell in cells)
    assert all(a.compute_overlap_area(b) == 0 for k, a in enumerate(cells) for b in cells[:k])


def test_the_curve_has_a_point_for_each_number_of_set_ups(families: dict[str, Family]) -> None:
    for family in families.values():
        chosen = family.points[1]
        svg = draw_curve(family, chosen)
        assert on_page(svg) and not collisions(svg)
        (curve,) = by_class(svg, "curve")
        circles = [element for element in curve if element.tag.endswith("circle")]
        assert len(circles) == len(family.points)
        x, y = ([float(element.attrib[key]) for element in circles] for key in ("cx", "cy"))
        assert x == sorted(x) and y == sorted(y)
        assert [element.attrib["fill"] == "#b3122a" for element in circles].index(True) == 1
        assert format_loss(chosen.loss) in texts(svg)
        assert convert_svg_to_pdf([svg], DAY)


def test_what_is_not_proven_is_told_in_the_curve(families: dict[str, Family]) -> None:
    family = families["vise"]
    points = tuple(evolve(point, is_least=False) for point in family.points)
    unsure = Family(family.toolkit, family.figure, family.members, (), points, family.table)
    assert "or less" in " ".join(texts(draw_curve(unsure)))
    assert "or less" not in " ".join(texts(draw_curve(family)))
    lost = tuple(evolve(point, loss=float("inf")) for point in family.points)
    nothing = Family(family.toolkit, family.figure, family.members, (), lost, family.table)
    assert "No number of set-ups" in " ".join(texts(draw_curve(nothing)))


@pytest.mark.thorough
def test_heights_of_their_own_are_told_where_solids_are_held() -> None:
    """Of every set-up, in the unit of the sheet; nothing of them where nothing is a solid."""
    toolkit = Plate(pitch=10, peg_radius=3, columns=8, rows=8, clamp_heights=(12.7, 25.4))
    solid, prism = stepped({"clamp": ((12.7, 25.4), STEM)}), shop_parts(1)[0]
    for parts, said in (([solid], True), ([prism], False), ([solid, prism], True)):
        asked = [MemberRequest(part.name, Query(part, toolkit, rank_by=RANKINGS[1])) for part in parts]
        family = make_family(asked, threads=1)
        plan = family.plans[0]
        pages = draw_setups(plan, family.figure, DAY, INCH)
        for page in pages:
            words = "lamp: touch between 0.5000 and 1.0000 in above the plane on which the parts lie."
            assert any(words in text for text in texts(page)) is said
            assert not collisions(page) and on_page(page)
