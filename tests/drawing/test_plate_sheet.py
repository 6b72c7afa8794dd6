"""The setup sheet of a dowel plate: legible, without the words of a vise, and with all that sets up the clamp."""

from __future__ import annotations

from datetime import date

import pytest
from attrs import evolve
from plate_examples import WAYS, on_plate
from sheet_reading import collisions, page_of, words_of
from svg_reading import texts

from workhold import Fixture, Load, Plate, Workpiece
from workhold.drawing import SheetDetails, draw_sheet
from workhold.drawing.scene import UNITS_PER_MM
from workhold.files.result.fixture_text import write_pin_list
from workhold.statics.loads import compute_load_cases
from workhold.units import INCH, MILLIMETRE, Unit

Held = tuple[Fixture, Workpiece, Plate]

DETAILS = SheetDetails(
    number=3, count=70, day=date(2026, 3, 31), result_hash="0123456789abcdef" * 4, version="1.2.3"
)
LONG_NAME = "bracket, left, revision C, machined side up, first operation of four " * 4
# Printers leave at least this blank, mm.
PRINTABLE = 5.0
BOLTED = pytest.mark.parametrize("bolted", [True, False], ids=["bolted", "line"])


def details_for(held: Held, **changes: object) -> SheetDetails:
    """Details with two loads, one of them at every corner of the part."""
    corners = tuple((float(x), float(y)) for x, y, _ in held[1].loops[0])
    loads = (Load(corners, 100.0, name="side milling"), Load(corners[:1], 30.0, (0.0, 90.0)))
    cases = compute_load_cases(*held, loads, 2000.0, 0.15)
    return evolve(DETAILS, jaw_force=2000.0, friction=0.15, loads=cases, **changes)


def facts(pages: tuple[str, ...]) -> str:
    """All words of all pages."""
    return " ".join(word for page in pages for word in texts(page))


@pytest.mark.thinned(7)
@pytest.mark.sampled(3)
@pytest.mark.parametrize("way", WAYS)
@BOLTED
@pytest.mark.parametrize(("paper", "unit"), [("a4", MILLIMETRE), ("letter", INCH)])
@pytest.mark.parametrize(
    ("size", "endless"),
    [(0.01, True), (1.0, False), (1.0, True), (40.0, False)],
    ids=["tiny endless", "usual", "endless", "huge"],
)
def test_nothing_is_covered_or_cut_off(
    way: str, bolted: bool, paper: str, unit: Unit, endless: bool, size: float
) -> None:
    """No word lies on another, all lie within what a printer prints, and none is of a vise."""
    held = on_plate(way, bolted, size, LONG_NAME if endless else "plate", endless)
    changes = {"paper": paper, "unit": unit, "others": 2}
    pages = draw_sheet(*held, evolve(DETAILS, **changes) if endless else details_for(held, **changes))
    for page in pages:
        assert collisions(page) == []
        inside = page_of(page).grow(-PRINTABLE * UNITS_PER_MM)
        assert [word for word, place in words_of(page) if not inside.contains(place)] == []
    words = facts(pages).lower()
    assert [
        word for word in ("jaw", "vise", "calipers", "s =", "l-a1", "sliding", "type i") if word in words
    ] == []


@pytest.mark.thorough
@pytest.mark.parametrize("way", WAYS)
@BOLTED
def test_the_clamp_can_be_set_up_from_the_sheet(way: str, bolted: bool) -> None:
    """Its hole or line, its stroke or the place of its tip, its direction, and the force wanted and needed."""
    held = on_plate(way, bolted)
    fixture = held[0]
    details = details_for(held)
    words, tip = facts(draw_sheet(*held, details)), fixture.pegs[3]
    towards = {"-x": "to the left", "+x": "to the right", "-y": "downward", "+y": "upward"}[way]
    place = tip.hole.removeprefix("clamp ")
    length = -fixture.travel if bolted else tip.x if way[1] == "x" else tip.y
    number = f"{length:.3f} mm".replace("-", "−")
    assert f"Clamp {'bolted in' if bolted else 'along'} {place}" in words
    assert f"{towards}, {way}".replace("-", "−") in words and number in words
    assert ("10 to 30 mm" in words) == bolted
    needed = max(case.needed.value for case in details.loads)
    (told,) = (int(part.split()[0]) for part in words.split("the loads need at least ")[1:])
    assert needed <= told < needed + 1 and "clamp force 2000 N" in words
    assert all(peg.hole in words for peg in fixture.pegs[:3]) and "Locators Ø 10 mm" in words


@pytest.mark.thorough
@pytest.mark.parametrize("way", WAYS)
@BOLTED
def test_all_may_be_moved_as_far_as_there_are_holes(way: str, bolted: bool) -> None:
    """On a plate with so many columns and rows to spare: the sheet names them, and neither more nor fewer."""
    fixture, workpiece, plate = on_plate(way, bolted)
    pegs = fixture.pegs if bolted else fixture.pegs[:3]
    columns = 1 + max(peg.column for peg in (pegs if way[1] == "x" else fixture.pegs))
    rows = 1 + max(peg.row for peg in (fixture.pegs if way[1] == "x" else pegs))
    for more, said in (
        ((0, 0), "in this place only"),
        ((2, 0), "up to 2 columns further right;"),
        ((0, 1), "1 row further up;"),
    ):
        limited = evolve(plate, columns=columns + more[0], rows=rows + more[1])
        assert said in facts(draw_sheet(fixture, workpiece, limited, DETAILS))
    endless = evolve(plate, columns=None, rows=None)
    assert "any columns further right and any rows further up" in facts(
        draw_sheet(fixture, workpiece, endless, DETAILS)
    )


def test_pins_are_the_locators_alone() -> None:
    """The list of pins has a row for each locator, and none for the clamp."""
    fixture, _, plate = on_plate()
    header, *rows = write_pin_list(fixture, plate, MILLIMETRE, None, None).splitlines()
    assert [row.split(",")[0] for row in rows] == ["A2", "B4", "F1"] and header.startswith("hole,carrier")
