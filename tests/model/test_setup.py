"""Part zero: where a machinist programs from, whatever the drawing's own origin is."""

from __future__ import annotations

import pytest

from workhold import Workpiece
from workhold.errors import InputError
from workhold.model.setup import choose_part_zero
from workhold.units import INCH


def plate(x: float, y: float) -> Workpiece:
    """A plate 40 by 20 with its lower left corner at a point, a round hole 30, 12 and an oblong one from 5, 5 to 15, 9."""
    loops = [
        [[0, 0, 0], [40, 0, 0], [40, 20, 0], [0, 20, 0]],
        [[28, 12, 1], [32, 12, 1]],
        [[7, 5, 0], [13, 5, 1], [13, 9, 0], [7, 9, 1]],
    ]
    return Workpiece.from_loops(
        "plate", [[[x + px, y + py, bulge] for px, py, bulge in loop] for loop in loops]
    )


@pytest.mark.parametrize("place", [(0.0, 0.0), (2067.5, -300.25), (-20.0, -10.0), (-41.0, 3.0)])
@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ("corner", (0, 0)),
        ("Centre", (20, 10)),
        ("center", (20, 10)),
        ("hole 1", (30, 12)),
        ("hole2", (10, 7)),
    ],
)
def test_named_points_go_with_the_part(
    place: tuple[float, float], asked: str, wanted: tuple[float, float]
) -> None:
    """Wherever the part is drawn, each point is at the same place of it."""
    x, y = choose_part_zero(plate(*place), asked).point
    assert (x - place[0], y - place[1]) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(
    ("place", "wanted"),
    [
        ((0.0, 0.0), (0.0, 0.0)),  # at a corner
        ((-20.0, -10.0), (0.0, 0.0)),  # inside
        ((-40.0, 0.0), (0.0, 0.0)),  # at the right edge
        ((2067.5, 0.0), (2067.5, 0.0)),
        ((-41.0, 0.0), (-41.0, 0.0)),
        ((-20.0, -21.0), (-20.0, -21.0)),
        ((-20.0, 0.5), (-20.0, 0.5)),
    ],
)
def test_without_a_wish_it_is_the_origin_on_the_part_and_else_the_corner(
    place: tuple[float, float], wanted: tuple[float, float]
) -> None:
    """A drawing's origin counts where it is on the part; a drawing two metres off has its corner."""
    assert choose_part_zero(plate(*place)).point == wanted


def test_points_of_the_drawing_are_in_the_unit_told() -> None:
    """1,-2 inch are 25.4, -50.8 mm, in words or as numbers."""
    assert (
        choose_part_zero(plate(0, 0), "1,-2", INCH).point
        == choose_part_zero(plate(0, 0), (1, -2), INCH).point
        == (25.4, -50.8)
    )


@pytest.mark.parametrize(
    "asked", ["", "top", "1", "1,2,3", "1,x", "nan,0", "inf,0", "hole 0", "hole 3", "hole", "hole ²"]
)
def test_anything_else_is_one_sentence(asked: str) -> None:
    """It names what can be given."""
    with pytest.raises(InputError, match="give corner, centre, hole and its number, or a point"):
        choose_part_zero(plate(0, 0), asked)
