"""A toolkit that nothing knows of, a vise with one flat jaw made of data alone, is drawn and written like any other."""

from __future__ import annotations

import json
from datetime import date
from io import StringIO
from math import pi, sqrt
from typing import ClassVar

import ezdxf
import pytest
from attrs import evolve, frozen
from svg_reading import texts

from workhold import Fixture, Peg, Pose, Workpiece
from workhold.cli.tables import tabulate_fixture_setup
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet
from workhold.drawing.panel import describe_arrangement
from workhold.files.dxf.writer import make_setup_dxf
from workhold.files.result.fixture_text import make_fixture_template, write_pin_list
from workhold.fixels.setup_words import Datum, SetupWords
from workhold.fixels.toolkit import Arrangement, Carrier, Symmetry, Toolkit, Travel
from workhold.model.shown import find_shown
from workhold.units import MILLIMETRE
from workhold.web.answers import describe_fixture


@frozen
class FlatJaw(Toolkit):
    """A wall that stands still, and a jaw with pegs that moves down onto it."""

    kind: ClassVar[str] = "flat-jaw"
    noun: ClassVar[str] = "flat-jaw vise"
    locked: ClassVar[str] = "a screw vise, its jaw"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("flat", (2, 2)),)
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()
    setup_words: ClassVar[SetupWords] = SetupWords(
        standing="Fixed jaw and pegs",
        put="Put {peg}s in {holes} of the {plate}.",
        touching="flush",
        against="flush on the fixed jaw",
    )
    carriers: ClassVar[tuple[Carrier, ...]] = (  # type: ignore[misc]
        Carrier("wall", (10.0, 10.0), 6, 4, 0.0, 0.0, noun="fixed jaw", peg="end", is_wall=True),
        Carrier("plate", (10.0, 10.0), 6, 4, 3.0, 3.0, travel=Travel(pi / 2, 3.0, None), noun="jaw"),
    )

    @property
    def datum(self) -> Datum:
        """Where column A meets the fixed jaw."""
        wall, plate = self.carriers
        return Datum.from_wall(wall, plate)


OUT, TOOLKIT = 3 / sqrt(2), FlatJaw()
HOUSE = Workpiece.from_loops("house", [[[0, 0, 0], [40, 0, 0], [40, 20, 0], [20, 40, 0], [0, 20, 0]]])
HELD = Fixture(
    "flat",
    (
        Peg("wall", 0, 0, 0.0, 0.0, 0, 0.5, "fixed jaw left"),
        Peg("wall", 0, 0, 40.0, 0.0, 0, 0.5, "fixed jaw right"),
        Peg("plate", 0, 0, 10.0 - OUT, 30.0 + OUT, 3, 0.7),
        Peg("plate", 2, 0, 30.0 + OUT, 30.0 + OUT, 2, 0.7),
    ),
    Pose(0.0, 0.0, 0.0),
    30.0 + OUT,
    {"closure_margin": 0.2},
)


def test_its_sheet_says_how_to_set_it_up() -> None:
    """In the words of its data, the steps of a thing with an opening, and the holes of its only plate."""
    pages = draw_sheet(HELD, HOUSE, TOOLKIT, SheetDetails(1, 1, date(2026, 1, 1), "", "0"))
    words = " ".join(word for page in pages for word in texts(page))
    for told in (
        "Fixed jaw and pegs Ø 6 mm",
        "The part lies flush on the fixed jaw with face 0.",
        "From the fixed jaw to the centres of row 1 of the jaw.",
        "Put pegs in A1 and C1 of the jaw.",
        "lay the part in as drawn, not turned, flush on the fixed jaw.",
        "Close the jaw until both pegs touch.",
        "A1 is column A, row 1",
        "fixed jaw that the part lies flush on",
    ):
        assert told in words
    assert "clamp" not in words.replace("clamp amplification", "")


@pytest.mark.parametrize(
    ("theta", "told"),
    [
        (12.0, "turned 12.0° counter-clockwise from its drawing"),
        (348.0, "turned 12.0° clockwise from its drawing"),
        (270.0, "turned 270.0° counter-clockwise from its drawing"),
        (0.04, "not turned"),
        (359.96, "not turned"),
    ],
)
def test_its_sheet_says_which_way_it_is_turned(theta: float, told: str) -> None:
    """The shorter way where that is not an eighth of a turn, and nothing of what nobody sees."""
    held = evolve(HELD, pose=Pose(theta, 0.0, 0.0))
    pages = draw_sheet(held, HOUSE, TOOLKIT, SheetDetails(1, 1, date(2026, 1, 1), "", "0"))
    words = " ".join(word for page in pages for word in texts(page))
    assert f"lay the part in as drawn, {told}, flush on the fixed jaw." in words


def test_its_picture_shows_wall_opening_and_pegs() -> None:
    picture = draw_fixture(HELD, HOUSE, TOOLKIT)
    words = texts(picture)
    assert {"sliding jaw", "fixed jaw left", "A1", "C1"} <= set(words)
    assert any(word.startswith("S = 32.1") for word in words)
    assert picture.count('class="peg"') == 2 and picture.count('class="fence"') >= 1
    assert describe_arrangement(TOOLKIT.arrangements[0], TOOLKIT) == "Type flat: two pegs on the jaw"


@pytest.mark.thorough
def test_its_drawing_for_cam_has_layers_of_its_own() -> None:
    document = ezdxf.read(StringIO(make_setup_dxf(HELD, HOUSE, TOOLKIT).decode()))
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert {"PART", "PEGS", "OPENING", "FIXED JAW", "JAW"} <= layers
    assert [
        row.split(",")[0] for row in write_pin_list(HELD, TOOLKIT, MILLIMETRE, None, None).splitlines()[1:]
    ] == [
        "A1",
        "C1",
    ]


def test_its_result_file_has_wall_and_jaw() -> None:
    """The shape of FLAT_JAW: the wall's ends by themselves, pegs with the role of the jaw, and the opening."""
    template = make_fixture_template(TOOLKIT.arrangements[0], TOOLKIT, [], "")
    numbers = [float(k) for k in range(template.count("%") - template.count("%%"))]
    entry = json.loads(template % tuple(numbers))
    assert set(entry) == {"type", "wall", "pegs", "pose", "jaw_separation", "quality"}
    assert [peg["role"] for peg in entry["pegs"]] == ["jaw", "jaw"]
    assert set(entry["wall"]) == {"from", "to", "segments", "forces"}


def test_the_page_and_the_terminal_tell_it() -> None:
    answer = describe_fixture(HELD, HOUSE, TOOLKIT)
    assert (answer["flush"], answer["origin"]) == ([0, 1], "column A at the fixed jaw")
    assert answer["normals"][0] == [0.0, -1.0]
    told = tabulate_fixture_setup(HELD, TOOLKIT, 1, 1)
    assert told[1] == "Opening S 32.121 mm"
    assert str(told[2]).endswith("from column A at the fixed jaw")


@pytest.mark.parametrize("travelled", [30.0 + OUT, 40.0])
def test_what_shows_of_it_keeps_the_wall_below_the_part(travelled: float) -> None:
    """The plate slides above and does not go on below the wall."""
    seen = find_shown(evolve(HELD, travel=travelled), TOOLKIT, HOUSE)
    (wall,), (plate,) = seen.walls, seen.carriers
    assert wall.bar.y1 == 0.0 and wall.ends == (0.0, 40.0)
    assert plate.plate.y0 > wall.bar.y1 and plate.travelled == travelled
