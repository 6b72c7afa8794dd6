"""What is given beside a fixture has to be its own: part, toolkit, supports."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from attrs import evolve

import workhold
from workhold import Fixture, Load, Workpiece
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.seating.closing_simulation import simulate_closing
from workhold.seating.solver import SeatingSolver
from workhold.statics.loads import compute_load_cases

CORNERS = [[0.0, 0, 0], [80, 0, 0], [80, 60, 0], [0, 50, 0]]
PLATE = Workpiece.from_loops("plate", [CORNERS])
# As many faces, one of them elsewhere.
OTHER = Workpiece.from_loops("plate", [[*CORNERS[:3], [0, 49.9, 0]]])
VISE = workhold.Vise(pitch=10, columns=2, peg_radius=3)
FINE = workhold.Vise(pitch=10, columns=2, peg_radius=2.9)
HELD = workhold.design(PLATE, VISE, best=2)

Ask = Callable[[Fixture, Workpiece, Toolkit], object]
WAYS: dict[str, Ask] = {
    "loads": lambda held, part, toolkit: compute_load_cases(held, part, toolkit, [Load(((1.0, 1.0),), 10.0)]),
    "seating": lambda held, part, toolkit: SeatingSolver(part, toolkit).solve(held, with_cage=False),
    "seatings": lambda held, part, toolkit: SeatingSolver(part, toolkit).solve_all([held], with_cage=False),
    "closing": lambda held, part, toolkit: simulate_closing(
        SeatingSolver(part, toolkit), held, (), held.pose, 0.0
    ),
}


@pytest.mark.parametrize("name", WAYS)
@pytest.mark.parametrize(
    "given", [(OTHER, VISE), (PLATE, FINE), (OTHER, FINE)], ids=["part", "toolkit", "both"]
)
def test_another_part_and_another_toolkit_are_refused(name: str, given: tuple[Workpiece, Toolkit]) -> None:
    what = "toolkit" if given[0] is PLATE else "part"
    with pytest.raises(InputError, match=f"this fixture is of another {what}"):
        WAYS[name](HELD[0], *given)


def test_the_same_part_by_another_name_is_its_own() -> None:
    """As the same file read again is, and a toolkit that was made again."""
    again = Workpiece.from_loops("again", [CORNERS])
    WAYS["loads"](HELD[0], again, workhold.Vise(pitch=10, columns=2, peg_radius=3))


def test_a_fixture_put_together_otherwise_touches_faces_that_there_are() -> None:
    alone = evolve(HELD[0], listed=None)
    compute_load_cases(alone, PLATE, VISE, [])
    pegs = (evolve(alone.pegs[0], face=7), *alone.pegs[1:])
    with pytest.raises(InputError, match="of another part"):
        compute_load_cases(evolve(alone, pegs=pegs), PLATE, VISE, [])
    with pytest.raises(InputError, match="of another toolkit"):
        compute_load_cases(alone, PLATE, workhold.Plate(pitch=10, peg_radius=3), [])


def test_seatings_are_of_the_result_that_is_asked() -> None:
    others = workhold.design(PLATE, FINE, best=1)
    with pytest.raises(InputError, match="of another toolkit"):
        workhold.seatings(HELD, list(others))


@pytest.mark.thorough
def test_supports_are_those_of_the_fixture(tmp_path: Path) -> None:
    """On a sheet and as bodies; of the same fixture once more they are its own."""
    wide = workhold.Vise(pitch=10, columns=6, peg_radius=3)
    one, two = workhold.design(PLATE, wide, best=2)
    own, others = (fixture.supports(12, best=1, pad_radius=3) for fixture in (one, two))
    again = workhold.design(PLATE, wide, best=2)[0]
    again.save_glb(tmp_path / "own.glb", supports=own)
    for write, name in ((one.save_sheet, "a.svg"), (one.save_glb, "a.glb")):
        with pytest.raises(InputError, match="the supports are of another fixture"):
            write(tmp_path / name, supports=others)  # type: ignore[operator]
        with pytest.raises(InputError, match="give these"):
            write(tmp_path / name, supports=two)  # type: ignore[operator]
        assert not (tmp_path / name).exists()
