"""What carriers and toolkits answer to whoever draws, writes or measures: all of it follows from their data."""

from __future__ import annotations

from typing import Any

import pytest

from workhold import Fence, Fixture, FlatJaw, OpeningVise, Peg, Plate, Pose, Vise
from workhold.fixels.contacts import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import ClampPair
from workhold.model.setup import list_length_settings, name_contacts

VISE = Vise(pitch=10, columns=2, peg_radius=3)
PLATE = Plate(pitch=20, peg_radius=3, directions=("-x", "-y"))
BOLTED = Plate(pitch=20, peg_radius=3, directions=("-x", "-y"), travel=(5, 30), flat=(2, 1))
FENCE = Fence(pitch=20, peg_radius=3, wall_offset=8, directions=("-x", "-y"))
ONE = Pose(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("toolkit", "contacts", "counted"),
    [
        (VISE, [ROUND_PIN] * 2, [(True, True)] * 2),
        (PLATE, [ROUND_PIN, CLAMP_TIP, CLAMP_TIP], [(True, True), (False, True), (True, False)]),
        (BOLTED, [FLAT_PIN, CLAMP_TIP, CLAMP_TIP], [(True, True)] * 3),
        (
            FENCE,
            [ROUND_PIN, WALL_END, CLAMP_TIP, CLAMP_TIP],
            [(True, True), (False, False), (False, True), (True, False)],
        ),
    ],
)
def test_what_stands_on_a_carrier(
    toolkit: Toolkit, contacts: list[object], counted: list[tuple[bool, bool]]
) -> None:
    """A clamp of which only the line is known has a column or a row, and the end of a wall neither."""
    assert [carrier.contact for carrier in toolkit.carriers] == contacts
    assert [carrier.counted_axes for carrier in toolkit.carriers] == counted
    assert [one.has_lattice for one in toolkit.carriers] == [
        kind in (ROUND_PIN, FLAT_PIN) for kind in contacts
    ]


@pytest.mark.parametrize(
    ("toolkit", "bodies"),
    [
        (Vise((10, 12), 2, 3, rows=5), [3, 3]),
        (Vise((10, 12), 2, 3, rows=5, body_radius=4), [4, 4]),
        (Plate((20, 22), 3, columns=4, rows=5, clamp_radius=2), [3, 2, 2]),
        (Fence((20, 22), 3, columns=4, rows=5, wall_offset=8, clamp_radius=2), [3, 0, 2, 2, 2, 2]),
        (FlatJaw((10, 12), 3, columns=4, rows=5), [0, 3]),
    ],
)
def test_a_carrier_has_the_lattice_and_the_pegs_of_its_toolkit(toolkit: Any, bodies: list[float]) -> None:
    """A peg's body is its tip where nothing else is given, a clamp has its own tip, and a wall has no pegs."""
    size = toolkit.pitch, toolkit.columns, toolkit.rows
    assert [(one.pitch, one.columns, one.rows) for one in toolkit.carriers] == [size] * len(bodies)
    assert [one.body_radius for one in toolkit.carriers] == bodies
    tips = [min(body, 3) for body in bodies]
    assert [one.peg_radius for one in toolkit.carriers] == tips


def test_how_files_name_what_stands_on_a_carrier() -> None:
    """By the jaw where there are two, else by what it does; the ends of a wall locate the part."""
    assert [carrier.file_entry for carrier in VISE.carriers] == [("jaw", "left"), ("jaw", "right")]
    roles = [("role", "locator"), ("role", "locator"), ("role", "clamp"), ("role", "clamp")]
    assert [carrier.file_entry for carrier in FENCE.carriers] == roles


def test_how_many_things_move_in_a_fixture() -> None:
    two = Fence(pitch=20, peg_radius=3, wall_offset=8, clamps=2)
    assert [(one.tip_count, one.travel_count) for one in (VISE, PLATE, FENCE, two)] == [
        (0, 1),
        (1, 1),
        (1, 1),
        (2, 2),
    ]
    assert [one.closes_at_once for one in (VISE, PLATE, two)] == [True, True, False]
    assert [one.ends_on_walls for one in (VISE, PLATE, two)] == [(), (), (slice(1, 3),)]


def test_what_half_a_turn_makes_of_a_toolkit() -> None:
    """Jaws change places, a plate's clamps push the other way where they can, and a fence stays where it is."""
    four = Plate(pitch=20, peg_radius=3, directions=("-x", "+x", "-y", "+y"))
    assert VISE.half_turned == (1, 0) == OpeningVise(pitch=10, columns=2, peg_radius=3).half_turned
    # Of two directions that half a turn makes of each other one is left.
    assert PLATE.half_turned == (0, -1, -1) == four.half_turned
    assert Plate(pitch=20, peg_radius=3, clamps=2, directions=(("-x", "+x"),)).half_turned == (0, 2, 1)
    assert FENCE.half_turned is None


def test_where_places_are_measured_from() -> None:
    """From a hole, or from a column and the fence, which then stands for a row and fixes the others."""
    vise, fence = VISE.datum, FENCE.datum
    assert (vise.origin_words, vise.lines, vise.full) == (
        "hole L-A1",
        ("column A", "row 1"),
        "the left jaw's hole L-A1",
    )
    assert (fence.origin_words, fence.lines) == ("column A and the fence", ("column A", "the fence"))
    assert (vise.fixes_rows, fence.fixes_rows, fence.edge) == (False, True, 8.0)
    assert vise.describe_peg_centres("peg") == "x, y: peg centre, from the centre of hole L-A1."
    assert fence.describe_peg_centres("peg") == "x from column A, y from the fence, to centres."


def test_the_words_of_what_is_set() -> None:
    """A clamp in a hole has a stroke, one on a line the place of its tip; jaws have an opening."""
    tip = Peg("clamp -y", 2, 0, 40.0, 66.0, 1, 1.0, "clamp C1")
    (stroke,) = list_length_settings(Fixture("clamp", (tip,), ONE, 14.0, {}, "-y"), BOLTED)
    (place,) = list_length_settings(Fixture("edge", (tip,), ONE, 14.0, {}, "-y"), FENCE)
    (opening,) = list_length_settings(Fixture("I", (), ONE, 24.0, {}), VISE)
    assert [one.place for one in (stroke, place, opening)] == ["C1", "column C", ""]
    assert [one.short for one in (stroke, place, opening)] == ["stroke", "tip y", "S"]
    assert (stroke.label, place.label) == ("Clamp bolted in", "Clamp along")
    assert place.caption == "Tip of the clamp, y from the fence" and place.length == 66.0


def test_the_only_clamp_needs_no_hole_to_be_named_by() -> None:
    locator, *tips = (
        Peg("plate", 1, 2, 20.0, 40.0, 0, 0.5),
        Peg("clamp -x", 4, 1, 66.0, 20.0, 2, 1.0, "clamp row 2"),
        Peg("clamp -y", 2, 4, 40.0, 66.0, 1, 1.0, "clamp column C"),
    )
    pair = ClampPair((0.0, 0.0), (0.0, 1.0), (), 1)
    one = Fixture("clamp", (locator, tips[0]), ONE, 0.0, {}, "-x")
    both = Fixture("clamp2", (locator, *tips), ONE, 0.0, {}, "-x -y", pair)
    assert name_contacts(one, PLATE) == ["B3", "clamp"]
    assert name_contacts(both, PLATE) == ["B3", "clamp row 2", "clamp column C"]
    assert (one.travels, both.travels) == ((0.0,), (0.0, 0.0))
