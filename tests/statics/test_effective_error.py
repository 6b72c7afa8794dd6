"""What speaks against a fixture, factor by factor, each by hand; and the sentence that says why one is first."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold import FlatJaw, OpeningVise, Plate, Query, Restrictions, Vise, Workpiece, answer
from workhold.fixels.toolkit import Toolkit
from workhold.model.first_choice import FACTORS
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import LOCATION_ERROR, WARNINGS
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.why_first import explain_why_first
from workhold.verification.first_choice import EffectiveJudge

BLOCK = [(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]
BORE = [(38, 30, 1), (62, 30, 1)]
KEYS = [factor.key for factor in FACTORS]


def block(*holes: list[tuple[float, float, float]]) -> Workpiece:
    """A plate of 100 x 60 with holes."""
    return Workpiece.from_loops("block", [BLOCK, *holes])


def holding(query: Query, **changed: object) -> tuple[FixtureTable, dict[str, np.ndarray]]:
    """All fixtures, and which factors hold of them."""
    table = answer(query, threads=1).table
    table = evolve(table, **changed) if changed else table
    return table, dict(zip(KEYS, EffectiveErrors.from_query(query).find_factors(table).T, strict=True))


def test_angles_as_written() -> None:
    """0 degrees, quarters of a turn, and others; a millionth of a degree is none."""
    degrees = [0.0, 9e-7, 360 - 9e-7, 1.1e-6, 90.0, 180.0, 270.0 + 9e-7, 270.0 + 2e-6, 45.0, 359.0]
    assert classify_angles(np.radians(degrees)).tolist() == [0, 0, 0, 2, 1, 1, 1, 2, 2, 2]


@pytest.mark.thorough
def test_near_the_end_of_a_straight_face_is_nearer_than_the_pegs_radius() -> None:
    """Two locators under the block, the first 3 mm from its corner: at the radius it is not nearer."""
    query = Query(block(), Plate(pitch=20, peg_radius=3, clamps=2))
    table, found = holding(query)
    square = np.flatnonzero(table.theta == 0.0)
    x, _ = workhold.model.fixture_table.compute_peg_places(table, query.toolkit, query.workpiece)
    for number in square[:200].tolist():
        places = []
        for peg, face in enumerate(table.face[number].tolist()):
            along = x[number, peg] - table.position[number, 0] if face in (0, 2) else None
            if along is not None:
                places.append(round(min(along, 100 - along), 9) < 3)
        assert not any(places) or found["face_end"][number]
    assert 0 < found["face_end"].sum() < len(table)


@pytest.mark.thorough
def test_clamps_and_dowels_inside_holes_count_unless_asked_for() -> None:
    """Where every face outside is avoided nothing is left but holes, and a vise that opens works from inside."""
    part = block(BORE, [(70, 20, 0), (90, 20, 0), (90, 40, 0), (70, 40, 0)])
    inside = part.numbered.inside
    query = Query(part, Plate(pitch=16, peg_radius=2, columns=7, rows=5))
    table, found = holding(query)
    is_inside = np.isin(table.face, sorted(inside))
    assert (found["clamp_in_hole"] == is_inside[:, 3]).all() and found["clamp_in_hole"].any()
    assert (found["dowel_in_bore"] == is_inside[:, :3].any(axis=1)).all() and found["dowel_in_bore"].any()
    outside = [face.number for face in part.faces if face.number not in inside]
    asked = evolve(query, restrictions=Restrictions(avoid=outside))
    assert not EffectiveErrors.from_query(asked).unasked.any()
    some = evolve(query, restrictions=Restrictions(avoid=outside[:-1]))
    assert np.flatnonzero(EffectiveErrors.from_query(some).unasked).tolist() == sorted(inside)
    opening = Query(part, OpeningVise(pitch=5, columns=2, peg_radius=2, min_gap=5))
    assert not EffectiveErrors.from_query(opening).unasked.any()


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("columns", "rows", "hangs"),
    [(None, None, False), (5, 5, False), (4, 5, True), (None, 3, False), (None, 2, True)],
)
def test_what_hangs_over_the_plate(columns: int | None, rows: int | None, hangs: bool) -> None:
    """A block of 100 x 60 as drawn lies on 5 x 3 holes, 20 mm apart, with half a pitch around; on fewer never."""
    query = Query(block(), Plate(pitch=20, peg_radius=3, columns=columns, rows=rows, clamps=2))
    # All holes in one place, so that the set-up may be moved anywhere, and the part just beside it.
    base = answer(Query(block(), Plate(pitch=20, peg_radius=3, clamps=2), best=1), threads=1).table
    table = evolve(
        base,
        column=np.zeros_like(base.column),
        row=np.zeros_like(base.row),
        theta=np.zeros(1),
        position=np.array([[-10.0, -10.0]]),
    )
    assert bool(EffectiveErrors.from_query(query).find_overhanging(table)[0]) == hangs
    moved = evolve(table, position=np.array([[-9.0, -10.0]]))
    # A millimetre beside whole holes: then as wide a plate as the part is never enough.
    assert bool(EffectiveErrors.from_query(query).find_overhanging(moved)[0]) == (hangs or columns == 5)


TOOLKITS: dict[str, Toolkit] = {
    "vise": Vise(pitch=20, columns=2, rows=5, peg_radius=3, max_opening=70),
    "plate": Plate(pitch=20, peg_radius=3, columns=6, rows=4, travel=(10, 40)),
    "fence": workhold.Fence(pitch=20, peg_radius=3, wall_offset=10, columns=6, rows=3, clamps=2),
    "flat jaw": FlatJaw(pitch=10, peg_radius=3, columns=7, rows=4),
}
L_SHAPE = [(0, 0, 0), (84, 0, 0), (84, 25, 0.2), (30, 30, 0), (26, 70, 0.4), (0, 70, 0)]


@pytest.mark.thorough
@pytest.mark.parametrize("kind", TOOLKITS)
def test_verification_finds_the_same_factors(kind: str) -> None:
    """By arithmetic of its own, of every fixture; most factors hold of some, and not of others."""
    part = Workpiece.from_loops("part", [L_SHAPE, [(8, 14, 1), (20, 14, 1)]])
    query = Query(part, TOOLKITS[kind])
    result = answer(query, threads=1)
    effective = EffectiveErrors.from_query(query)
    judge = EffectiveJudge(query, result.least_effective_error)
    marks = effective.find_factors(result.table)
    for fixture, row in zip(result, marks, strict=True):
        said = [ends for _, ends in judge.list_factors(fixture)]
        assert all(
            surely <= bool(mark) <= perhaps
            for (surely, perhaps), mark in zip(said, row.tolist(), strict=True)
        )
        assert sum(surely != perhaps for surely, perhaps in said) <= 1
    assert len(marks) > 5 and (marks.any(axis=0) & ~marks.all(axis=0)).sum() >= 2


@pytest.mark.thorough
def test_factors_multiply() -> None:
    """Of the location error."""
    query = Query(block(BORE), Plate(pitch=20, peg_radius=3, clamps=2))
    table, found = holding(query)
    product = np.ones(len(table))
    for factor in FACTORS:
        product[found[factor.key]] *= factor.times
    assert np.allclose(
        EffectiveErrors.from_query(query).compute_errors(table), table.quality[:, LOCATION_ERROR] * product
    )
    assert len(np.unique(np.round(product, 9))) > 4


@pytest.mark.thorough
def test_why_first_says_what_counts() -> None:
    """As drawn, turned by a quarter, and of another order nothing."""
    plate, two = Plate(pitch=20, peg_radius=3), Plate(pitch=20, peg_radius=3, clamps=2)
    square = answer(Query(block(), two, best=3), threads=1)
    assert re.fullmatch(
        r"First: no warning; location error 0\.\d{4} mm, .*; as drawn\.", explain_why_first(square)
    )
    aslant = answer(Query(block(), plate, best=3), threads=1)
    assert "(turned aslant" in explain_why_first(
        aslant
    ) and "no fixture that lies square to the drawing" in explain_why_first(aslant)
    quarter = Workpiece.from_loops("standing", [[(y, -x, b) for x, y, b in BLOCK]])
    tilted = answer(Query(quarter, two, restrictions=Restrictions(angles=((90.0, 90.0),)), best=3), threads=1)
    assert "counted as" in explain_why_first(tilted) and "(turned by 90°" in explain_why_first(tilted)
    assert explain_why_first(answer(Query(block(), two, rank_by="penalty", best=3), threads=1)) == ""


@pytest.mark.thorough
def test_why_first_says_what_stands_square() -> None:
    """None at all, none among those listed, none within a tenth, or none that has no warning or is fit."""
    whole = answer(Query(block(), Plate(pitch=20, peg_radius=3)), threads=1)
    best = answer(Query(block(), Plate(pitch=20, peg_radius=3), best=3), threads=1)
    assert explain_why_first(whole).endswith("; no fixture lies square to the drawing.")
    assert explain_why_first(best).endswith(
        "; no fixture that lies square to the drawing comes within a tenth, and none is listed."
    )
    assert explain_why_first(evolve(whole, complete=False)).endswith("and none is listed.")
    alone = answer(Query(block(), Plate(pitch=20, peg_radius=3), best=1), threads=1)
    assert explain_why_first(alone).endswith(
        "; no fixture that lies square to the drawing comes within a tenth."
    )
    theta, quality = whole.table.theta.copy(), whole.table.quality.copy()
    theta[7] = np.pi
    turned = evolve(whole.table, theta=theta)
    assert explain_why_first(evolve(whole, table=turned)).endswith(
        "; no fixture that lies square to the drawing comes within a tenth."
    )
    for column, value, words in (
        (WARNINGS, 1.0, "those that lie square to the drawing have a warning"),
        (LOCATION_ERROR, 50.0, "those that lie square to the drawing are not fit for a workshop"),
    ):
        changed = quality.copy()
        changed[7, column] = value
        assert explain_why_first(evolve(whole, table=evolve(turned, quality=changed))).endswith(f"; {words}.")
        other = theta.copy()
        other[8] = np.pi / 2
        two = evolve(whole.table, theta=other, quality=changed)
        assert explain_why_first(evolve(whole, table=two)).endswith("comes within a tenth.")
    quarter = theta.copy()
    quarter[0], quarter[7] = np.pi / 2, 0.3
    said = explain_why_first(evolve(whole, table=evolve(whole.table, theta=quarter)))
    assert said.endswith("; no fixture lies as drawn.")


def test_the_manual_has_the_table_of_factors() -> None:
    """Row by row, with each reason."""
    text = (Path(__file__).parents[2] / "docs" / "quality.md").read_text()
    table = text.partition("<!-- factors -->\n")[2].partition("\n<!-- end of factors -->")[0]
    rows = [f"| {one.words} | × {one.times:g} | {one.reason} |" for one in FACTORS]
    assert table.splitlines()[2:] == rows
