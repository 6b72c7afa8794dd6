"""Jaw plates: the lattice's holes, none of them blocked, apart from one another and within the plate."""

from __future__ import annotations

import pytest
from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import Holes
from workhold.fixels.plate import Plate
from workhold.fixels.vise import Vise
from workhold.model.dowels import Bolts, jaw_plates
from workhold.units import INCH

VISE = Vise(pitch=(10, 12), columns=3, peg_radius=3, rows=4, row_offset=5.0)


def test_holes_are_those_of_the_jaws() -> None:
    """Every hole's name and its place from the jaw's own A1; what is blocked is missing from its jaw alone."""
    left, right = jaw_plates(evolve(VISE, blocked=(Holes("left", 1), Holes("right", 0, 0))))
    assert [len(left.holes), len(right.holes)] == [8, 11]
    vise = jaw_plates(VISE)
    for plate, carrier in zip(vise, VISE.carriers, strict=True):
        zero = carrier.place(0, 0)
        for name, (x, y) in plate.holes:
            column, row = "ABC".index(name[2]), int(name[3:]) - 1
            assert carrier.place(column, row) == pytest.approx((x + zero[0], y + zero[1]))
    assert {name for name, _ in vise[0].holes} - {name for name, _ in left.holes} == {
        "L-B1",
        "L-B2",
        "L-B3",
        "L-B4",
    }


def test_the_edge_is_as_far_as_asked_for() -> None:
    """Half a pitch each way, or what is given."""
    box = jaw_plates(VISE)[0].outline
    assert (box.x0, box.y0, box.x1, box.y1) == (-5, -6, 25, 42)
    box = jaw_plates(VISE, edge=15.0)[1].outline
    assert (box.x0, box.y0, box.x1, box.y1) == (-15, -15, 35, 51)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"bolts": Bolts(5.0, ((5.0, 6.0), (22.6, 6.0)))}, "bolt 2 at 22.6,6 leaves the left jaw's plate"),
        ({"bolts": Bolts(5.0, ((10.0, 5.4),))}, "bolt 1 at 10,5.4 runs into dowel hole L-B1"),
        ({"bolts": Bolts(4.0, ((5.0, 6.0), (5.0, 9.9)))}, "bolt 2 at 5,9.9 runs into bolt 1"),
        ({"bolts": Bolts(0.0, ((5.0, 6.0),))}, "bolt holes of 0 mm cannot be drilled"),
        ({"hole_diameter": 10.0}, "dowel holes of 10 mm do not fit"),
        ({"hole_diameter": 0.0}, "dowel holes of 0 mm do not fit"),
        ({"edge": 3.0}, "the plate's edge would cut its outermost dowel holes"),
        ({"hole_diameter": 25.4, "unit": INCH}, "dowel holes of 1 in do not fit"),
    ],
)
def test_what_cannot_be_drilled_is_refused(changes: dict, said: str) -> None:
    """Holes that meet, or leave the plate."""
    with pytest.raises(InputError, match=said):
        jaw_plates(VISE, **changes)


def test_bolts_that_just_miss_are_allowed() -> None:
    """A tenth of a millimetre from a dowel hole, an edge and another bolt."""
    bolts = Bolts(4.0, ((5.0, 6.0), (5.0, 10.1), (22.9, 6.0), (10.0, 5.1)))
    assert all(plate.bolts == bolts for plate in jaw_plates(VISE, bolts=bolts))


def test_plates_need_a_number_of_rows() -> None:
    """As many as needed is none."""
    with pytest.raises(InputError, match="how many columns and rows"):
        jaw_plates(evolve(VISE, rows=None))


def test_a_clamp_has_no_plate_to_drill() -> None:
    """Of a plate with a clamp only the plate is drilled, with all its holes."""
    (plate,) = jaw_plates(Plate(pitch=20, peg_radius=5, columns=8, rows=6, directions=("-x", "-y")))
    assert (plate.title, len(plate.holes)) == ("plate", 48) and plate.holes[0][0] == "A1"
