"""The frame of the search: whichever way a carrier slides, the fixtures are the same but for the turn."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from attrs import evolve, frozen

from workhold import Query, Result, Vise, Workpiece, design
from workhold.contact.features import measure_end_distances
from workhold.contact.problem import Problem, SearchFrame
from workhold.errors import InputError
from workhold.fixels.carrier import HoleSelection
from workhold.fixels.toolkit import Carrier, Travel
from workhold.model.quality import END_DISTANCE
from workhold.statics.quality import measure_quality

PART = Workpiece.from_loops(
    "part",
    [
        [[0, 0, 0], [40, 3, 0], [44, 20, 0.3], [30, 38, 0], [4, 33, 0]],
        [[12, 12, 0], [14, 22, 0], [25, 18, 0]],
    ],
)


@frozen
class Turned(Vise):
    """A vise turned by quarter turns counter-clockwise: a test's own toolkit, given as carriers."""

    quarters: int = 0

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """Both jaws after the turn; holes are counted along the axes, from the lowest."""
        left, right = (turned_carrier(carrier, self.quarters) for carrier in super().carriers)
        return left, right


@frozen
class Uneven(Vise):
    """A vise whose moving pegs have a radius of their own, so that no half turn swaps its jaws."""

    symmetries = ()
    moving_radius: float = 3.0

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """Both jaws."""
        left, right = super().carriers
        return left, evolve(right, peg_radius=self.moving_radius, body_radius=self.moving_radius)


def turned_carrier(carrier: Carrier, quarters: int) -> Carrier:
    """A carrier turned about the origin, one quarter turn at a time: hole (i, j) becomes (rows - 1 - j, i)."""
    for _ in range(quarters):
        assert carrier.rows is not None
        x, y = evolve(carrier, travel=None).compute_hole_center(0, carrier.rows - 1)
        travel = carrier.travel and Travel(
            carrier.travel.direction + pi / 2, carrier.travel.least, carrier.travel.most
        )
        carrier = evolve(
            carrier,
            pitch=carrier.pitch[::-1],
            columns=carrier.rows,
            rows=carrier.columns,
            offset=(-y, x),
            blocked=tuple(
                evolve(holes, column=carrier.rows - 1 - holes.row, row=holes.column)
                for holes in carrier.blocked
                if holes.row is not None
            ),
            travel=travel,
        )
    return carrier


def pegs_of(result: Result) -> np.ndarray:
    """Places of all pegs (N, 4) as complex numbers."""
    table = result.table
    x, y = result.toolkit.compute_hole_places(
        table.arrangement, table.column, table.row, table.jaw_separation
    )
    return x + 1j * y


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_toolkit_that_slides_another_way_has_the_same_fixtures_turned(quarters: int) -> None:
    """Faces, forces, travel and quality stay; places and poses turn with the toolkit."""
    asked = {
        "pitch": (12, 14),
        "columns": 2,
        "peg_radius": 2.5,
        "rows": 7,
        "row_offset": 3.0,
        "max_opening": 30,
        "blocked": [HoleSelection("left", 1, 3), HoleSelection("right", 0, 2)],
    }
    vise = design(PART, Vise(**asked))
    turned = design(PART, Turned(**asked, quarters=quarters))
    assert len(vise) == len(turned) > 20
    assert vise.found == turned.found
    quarter = 1j**quarters
    for name in ("face", "arrangement", "jaw_separation", "force"):
        assert np.allclose(getattr(vise.table, name), getattr(turned.table, name), rtol=0, atol=1e-9)
    assert np.allclose(vise.table.quality[:, :5], turned.table.quality[:, :5], rtol=1e-6)
    assert np.abs(pegs_of(turned) - quarter * pegs_of(vise)).max() < 1e-9
    assert np.abs(np.exp(1j * turned.table.theta) - quarter * np.exp(1j * vise.table.theta)).max() < 1e-12
    x, y = vise.table.position.T
    assert np.abs(turned.table.position @ (1, 1j) - quarter * (x + 1j * y)).max() < 1e-9


def test_a_vise_is_its_own_frame() -> None:
    """Nothing is turned, and no travel is lost or won."""
    vise = Vise(pitch=(10, 7), columns=4, peg_radius=3, row_offset=2.5)
    frame = SearchFrame.from_toolkit(vise, 100.0)
    assert frame.carriers == vise.carriers
    assert frame.lattice == (10.0, 7.0, 2.5)
    assert (frame.travel_at_rest, frame.swapped_peg_count, frame.gap) == (0.0, 2, 10.0)


def test_lattices_that_do_not_match_are_refused() -> None:
    """Carriers of two pitches, or a slant, make no common rows."""

    class Slanted(Turned):
        """A vise whose jaw slides on a slant."""

        @property
        def carriers(self) -> tuple[Carrier, Carrier]:
            """Both jaws."""
            left, right = Vise.carriers.fget(self)
            return left, evolve(right, travel=Travel(0.3, 0.0, None))

    with pytest.raises(InputError, match="quarter turns"):
        SearchFrame.from_toolkit(Slanted(pitch=10, columns=2, peg_radius=3), 100.0)


def test_pegs_of_two_radii_touch_features_of_their_own() -> None:
    """Standing pegs keep their radius from the part and moving pegs another; where both are the same up to a hair, so are
    the fixtures of features kept apart and in common."""
    asked = {"pitch": 14, "columns": 1, "peg_radius": 3}
    alike, apart = (Uneven(**asked, moving_radius=radius) for radius in (3.0, 3.0 + 1e-12))
    one, other = design(PART, alike), design(PART, apart)
    assert Problem.from_query(Query(PART, alike)).standing == Problem.from_query(Query(PART, alike)).moving
    assert (
        Problem.from_query(Query(PART, apart)).standing[1] == Problem.from_query(Query(PART, apart)).moving[0]
    )
    assert len(one) == len(other) > 0
    for name in ("column", "row", "face"):
        assert np.array_equal(getattr(one.table, name), getattr(other.table, name))
    # Without the half turn each fixture of two and two pegs is another one with the jaws swapped.
    assert one.found["I"] == 2 * design(PART, Vise(**asked)).found["I"]
    thin = design(PART, Uneven(**asked, moving_radius=1.0))
    problem = Problem.from_query(thin.query)
    assert len(thin) > 0
    turn = np.exp(-1j * thin.table.theta)[:, None]
    place = (pegs_of(thin) - (thin.table.position @ (1, 1j))[:, None]) * turn - complex(*PART.center)
    moves = thin.toolkit.find_peg_carriers(thin.table.arrangement)
    ends = measure_quality(thin.table, PART, thin.toolkit)[:, END_DISTANCE]
    for k in range(len(thin)):
        own = []
        for peg in range(4):
            first, end = problem.moving if moves[k, peg] else problem.standing
            rows = problem.rows[first:end][problem.faces[first:end] == thin.table.face[k, peg]]
            off = (place[k, peg] - rows[:, 1] - 1j * rows[:, 2]) * (rows[:, 3] - 1j * rows[:, 4])
            assert (
                np.where(rows[:, 0] == 0.0, np.abs(off.imag), np.abs(np.abs(off) - rows[:, 6])).min() < 1e-6
            )
            point = np.array([place[k, peg].real, place[k, peg].imag])
            own.append(
                measure_end_distances(rows[:, :10], np.broadcast_to(point, (len(rows), 2))).min(axis=1).max()
            )
        assert ends[k] == pytest.approx(min(own), abs=1e-9)
