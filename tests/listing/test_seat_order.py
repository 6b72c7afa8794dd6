"""The best fixtures with two clamps are the first of the whole list, though most seats are never looked at."""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import inf
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from cad_parts import cad_part
from toolkit_results import NOTCHED, part
from workhold import Load, Plate, Query, Restrictions, Result, Tolerance, answer, verify
from workhold.conventions import SAME_PLACE, SAME_POSE
from workhold.files.result.writer import make_notes_entry
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.chord.intervals import share_one_line
from workhold.kernels.contact import record
from workhold.kernels.contact.seats import ASIDE
from workhold.listing import seat_order
from workhold.listing.contact_groups import PackedContacts, SeatGroups
from workhold.listing.ranking import is_worse, make_table_keys
from workhold.model.notes import BestOnly
from workhold.model.quality import FIGURES, JAW_FORCE_NEEDED, LOAD_REACTION
from workhold.search import design, lattice_shares, shares
from workhold.verification import verify_file

OF_LOADS = {FIGURES[LOAD_REACTION].key, FIGURES[JAW_FORCE_NEEDED].key}


@pytest.fixture(autouse=True)
def few_contacts_are_left_out_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Searches of any size stop early."""
    monkeypatch.setattr(lattice_shares, "COUNTED_WHOLE", 0)


def queries(seed: int, count: int) -> Iterator[Query]:
    """Questions about a part as it comes out of CAD: any plate, restriction, load, tolerance and ranking."""
    random, workpiece = Random(seed), cad_part(seed)
    plate = Plate(
        pitch=random.choice([(20, 20), (25, 25), (30, 20), (16, 24)]),
        peg_radius=random.choice([2, 3, 4]),
        clamp_radius=random.choice([3, 5]),
        travel=random.choice([(10, 40), (4, 30), None]),
        columns=random.choice([None, 5]),
        rows=random.choice([None, 6]),
        clamps=2,
        directions=random.choice([None, [("-x", "-y")], [("-x", "+x"), ("-y", "-y")], ["-x", "+y"]]),
    )
    x, y = workpiece.center
    for _ in range(count):
        loads = random.choice([(), (), (Load(points=((x + 3, y),), force=50, directions=(20, 80)),)])
        figures = [figure.key for figure in FIGURES if loads or figure.key not in OF_LOADS]
        restrictions = Restrictions(avoid=(random.randrange(len(workpiece.segments)),), angles=((0, 90),))
        yield Query(
            workpiece,
            plate,
            contact_margin=random.choice([0.0, 2.0]),
            restrictions=random.choice([None, None, restrictions]),
            rank_by=random.choice([None, random.sample(figures, random.randint(1, 4))]),
            tolerance=random.choice([None, Tolerance(peg=0.05, face=0.0)]),
            loads=loads,
            listing=random.choice(["best", "all"]),
        )


def assert_first(few: Result, whole: Result) -> None:
    """A list of the best is the first part of the whole one; what is counted is counted right.

    What was looked at is more where all is: square orientations come first, and ranges overlap a little.
    """
    assert few.table == whole.table.take(slice(0, few.query.best))
    if few.pairs is None:
        assert few.seats is None and few.notes[0] == BestOnly(few.query.best or 0)
        assert few.found == few.counts and len(few) == few.query.best
    else:
        assert (few.pairs, few.seats, few.found) == (whole.pairs, whole.seats, whole.found)
        assert few.proof is not None and whole.proof is not None
        assert (few.distinct, few.notes) == (whole.distinct, whole.notes)
        assert few.proof.undecided == whole.proof.undecided and few.proof.cells >= whole.proof.cells


@pytest.mark.thorough
@pytest.mark.parametrize(
    "seed", [31, *(pytest.param(seed, marks=pytest.mark.prove) for seed in range(200) if seed != 31)]
)
def test_the_best_are_the_first_of_the_whole_list(seed: int) -> None:
    for query in queries(seed, 2):
        whole = answer(query, threads=1)
        for best in (1, 7, 40, 400, len(whole) + 1):
            assert_first(answer(evolve(query, best=best), threads=1), whole)


@pytest.mark.thorough
def test_most_contacts_are_not_even_proven() -> None:
    query = Query(part(NOTCHED), Plate((16, 12), 3, clamps=2))
    few, whole = answer(evolve(query, best=5)), answer(query)
    assert few.proof is not None and whole.proof is not None
    assert few.pairs is None and 3 * few.proof.verified < whole.proof.verified
    assert few.proof.candidates == whole.proof.candidates


@pytest.mark.thorough
@pytest.mark.parametrize("listing", ["best", "all"])
def test_what_is_left_out_does_not_depend_on_threads_and_verifies(listing: str, tmp_path: Any) -> None:
    query = Query(cad_part(9), Plate(pitch=25, peg_radius=3, clamps=2), best=6, listing=listing)
    texts = []
    for threads in (1, 3):
        workhold.save(result := answer(query, threads=threads), tmp_path / "r.json")
        texts.append((tmp_path / "r.json").read_bytes())
    assert texts[0] == texts[1]
    assert not {"pairs", "seats"} & json.loads(texts[0]).keys()
    again = workhold.open(tmp_path / "r.json")
    assert (again.pairs, again.seats, again.notes) == (None, None, result.notes)
    for outcome in (verify(again), verify_file(tmp_path / "r.json")):
        assert (outcome.proven, outcome.faults) == (6, ())
    fields = json.loads(texts[0])
    (tmp_path / "without.json").write_text(json.dumps({**fields, **make_notes_entry(result.notes[1:])}))
    assert any("how many pairs" in fault for fault in verify_file(tmp_path / "without.json").faults)


@pytest.mark.thorough
def test_ranges_of_orientation_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    query = Query(part(NOTCHED), Plate((20, 16), 3, columns=4, rows=4, clamps=2), best=9)
    whole = answer(evolve(query, best=None))
    monkeypatch.setattr(lattice_shares, "BLOCKS_TOGETHER", 3)
    assert_first(answer(query), whole)


def rounded(width: float, height: float, radius: float) -> workhold.Workpiece:
    """A rectangle with rounded corners."""
    x, y = width - radius, height - radius
    points = [
        (radius, 0),
        (x, 0),
        (width, radius),
        (width, y),
        (x, height),
        (radius, height),
        (0, y),
        (0, radius),
    ]
    bulged = [(*point, (2**0.5 - 1) * (k % 2)) for k, point in enumerate(points)]
    return workhold.Workpiece.from_loops("rounded", [bulged])


@pytest.mark.thorough
@pytest.mark.parametrize("workpiece", [part(NOTCHED), rounded(80.0, 60.0, 3.0)], ids=["notched", "rounded"])
def test_no_fixture_ranks_before_the_bound_of_its_locators(
    workpiece: workhold.Workpiece, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The lemma on which the search stops."""
    seen: list[int] = []

    def one_by_one(groups: SeatGroups, kept: Any, floor: int, together: int = 0) -> Iterator[Any]:
        for number in range(len(groups)):
            if Random(number).random() < 0.1:
                kept.tables, bound = [kept.tables[0].take(slice(0))], groups.bounds.take([number])
                if groups.sharpened is not None:
                    bound = groups.select_groups_with_sharper_bounds(np.array([number])).bounds
                yield np.sort(groups.select_contacts(np.array([number]))[0])
                table, query = kept.concatenate(), kept.query
                keys = make_table_keys(table, query, kept.effective)
                for rows, least in ((keys.first, bound.first), (keys.rest, bound.rest)):
                    assert not any(is_worse(least, row)[0] for row in rows)
                assert keys.error is None or (keys.error >= bound.error).all()
                seen.append(len(keys))

    monkeypatch.setattr(SeatGroups, "iterate_batches", one_by_one)
    for ranking in (
        None,
        ["edge_distance", "tilt"],
        ["location_error"],
        ["end-distance"],
        ["smallest_face", "penalty"],
        ["closure_margin"],
        ["clamp_freedom"],
        ["warnings"],
    ):
        answer(Query(workpiece, Plate((20, 16), 3, clamps=2), rank_by=ranking, listing="all", best=10**6))
    assert sum(seen) > 100


def contacts_of(query: Query, monkeypatch: pytest.MonkeyPatch) -> tuple[list[Any], list[Any]]:
    """Contacts of three locators and a clamp of each direction, and the searches that found them."""
    monkeypatch.setattr(shares, "SQUARE_FIRST", inf)
    monkeypatch.setattr(design, "LIMITED_FROM", inf)
    found: list[Any] = []
    ordered = lattice_shares.make_ordered_groups

    def noted(records: Any, problems: Any, query: Query) -> SeatGroups:
        found[:] = records, problems
        return ordered(records, problems, query)

    monkeypatch.setattr(lattice_shares, "make_ordered_groups", noted)
    answer(query, threads=1)
    records, problems = found
    return [part.take(slice(None)) for part in records], problems


@pytest.mark.thorough
def test_locators_are_known_where_a_clamp_grazes_an_arc(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts moved by less than contacts are said to be off are off by no more than their locators tell."""
    query = Query(cad_part(5), Plate(pitch=20, peg_radius=3, clamps=2), best=5)
    random = np.random.default_rng(1)
    for records, problem in zip(*contacts_of(query, monkeypatch), strict=True):
        off = seat_order.bound_places_off(records, problem)
        said = records[:, record.LARGEST_RADIUS] + records[:, record.REACH] * problem.wrench_length
        vague = said > SAME_PLACE
        assert vague.any() and (off <= said).all() and (off[~vague] == said[~vague]).all()
        assert (off <= SAME_PLACE).mean() > 0.999
        for size in (1e-5, 1e-3, 0.1):
            moved, away = records.copy(), random.uniform(-size, size, (len(records), 3))
            moved[:, [record.TAIL_X, record.TAIL_Y]] += away[:, :2]
            moved[:, record.PSI] += away[:, 2] / problem.wrench_length
            moved[:, record.LARGEST_RADIUS] += 4 * size
            assert (seat_order.bound_places_off(moved, problem) + off >= np.hypot(*away.T[:2])).all()
            # Beside the holes a place is known no better than the orientation, nor where it is hardly known.
            moved[:, record.REACH] += size / problem.wrench_length
            assert (seat_order.bound_places_off(moved, problem) >= size).all()


@pytest.mark.thorough
def test_no_contact_stands_for_two_seats(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seats nearer than places and orientations are told apart share a group, which has no bound then."""
    query = Query(cad_part(5), Plate(pitch=20, peg_radius=3, clamps=2), best=5)
    records, problems = contacts_of(query, monkeypatch)
    before = seat_order.make_ordered_groups(
        [PackedContacts.from_blocks([part]) for part in records], problems, query
    )
    known = int(np.flatnonzero(before.bounds.is_known)[0])
    first = int(before.select_contacts(np.array([known]))[0].min())
    assert first < len(records[0])
    for turn, move in ((2 * SAME_POSE, 0.0), (0.0, 0.3 * SAME_PLACE)):
        other = records[0][first].copy()
        # The first turns the part about the middle of the plate, so that its place stays.
        other[record.PSI] += turn
        x, y = rotate_vectors(other[record.TAIL_X], other[record.TAIL_Y], turn)
        other[record.TAIL_X], other[record.TAIL_Y] = x + move, y
        more = [np.vstack([records[0], other]), *records[1:]]
        groups = seat_order.make_ordered_groups(
            [PackedContacts.from_blocks([part]) for part in more], problems, query
        )
        assert len(groups) == len(before)
        place = np.flatnonzero(groups.order == len(records[0]))
        number = np.searchsorted(groups.starts, place, side="right") - 1
        assert not groups.bounds.is_known[number].any()
        assert (~groups.bounds.is_known).sum() == (~before.bounds.is_known).sum() + 1


@pytest.mark.thorough
def test_contacts_at_joints_bound_their_seats(monkeypatch: pytest.MonkeyPatch) -> None:
    """On whole pitches pegs stand where an edge becomes a corner; such seats are bounded on either face."""
    query = Query(rounded(120.0, 80.0, 3.0), Plate(pitch=20, peg_radius=3, clamps=2), best=5)
    records, problems = contacts_of(query, monkeypatch)
    groups = seat_order.make_ordered_groups(
        [PackedContacts.from_blocks([each]) for each in records], problems, query
    )
    assert (~groups.bounds.is_known).mean() < 0.05
    for each, problem in zip(records, problems, strict=True):
        number, more = seat_order.assign_contacts_to_faces(each, problem, 3)
        assert (np.diff(number) >= 0).all() and len(np.unique(number)) == len(each) < len(more)
        # Nothing but the feature differs, and the places are the same.
        features = slice(record.FEATURES, record.FEATURES + 3)
        rest = np.delete(more, np.arange(record.RECORD_LENGTH)[features], axis=1)
        assert (rest == np.delete(each, np.arange(record.RECORD_LENGTH)[features], axis=1)[number]).all()
        known = set(map(tuple, np.column_stack([number, more[:, features]]).tolist()))
        assert all((k, *row[features]) in known for k, row in enumerate(each.tolist()))


@pytest.mark.parametrize("large", [7.0, 1e6])
def test_packed_contacts_are_the_records_in_their_order(large: float) -> None:
    random = np.random.default_rng(3)
    blocks = [np.hstack([random.integers(-9, 9, (n, 13)), random.normal(size=(n, 6))]) for n in (5, 0, 70000)]
    blocks[0][2, 4], blocks[2][0, record.REACH] = large, np.inf
    whole = np.concatenate(blocks)
    packed = PackedContacts.from_blocks(blocks)
    assert blocks == [] and np.array_equal(packed.take(slice(None)), whole)
    assert np.array_equal(np.concatenate(list(packed.iterate_parts())), whole)
    assert np.array_equal(packed.take(np.array([70001, 3])), whole[[70001, 3]])
    assert [part.shape for part in PackedContacts.from_blocks([]).iterate_parts()] == [(0, 19)]


@pytest.mark.thorough
def test_numbers_of_seats_are_those_of_their_definition(monkeypatch: pytest.MonkeyPatch) -> None:
    """Holes agree wherever they are on the plate and in which order; places are those beside the lowest."""
    query = Query(cad_part(9), Plate(pitch=(25, 20), peg_radius=3, clamps=2), best=5)
    triples: dict[int, Any] = {}
    for records, problem in zip(*contacts_of(query, monkeypatch), strict=True):
        holes, theta, turn, place, *_ = seat_order.number_seats(records, problem)
        columns, rows = problem.frame.map_step_to_toolkit(
            *(records[:, k : k + 3].astype(np.int64) for k in (record.COLUMNS, record.ROWS))
        )
        both = np.stack([columns - columns.min(axis=1)[:, None], rows - rows.min(axis=1)[:, None]], axis=2)
        for number, triple in zip(holes.tolist(), both.tolist(), strict=True):
            assert triples.setdefault(number, sorted(triple)) == sorted(triple)
        angle = problem.frame.quarters * np.pi / 2 - records[:, record.PSI]
        at = np.exp(1j * angle) * (records[:, record.TAIL_X] + 1j * records[:, record.TAIL_Y])
        beside = both[:, 0] * np.array([25, 20]) - np.stack([at.real, at.imag], axis=1)
        assert np.allclose(place, beside @ np.array([1.0, ASIDE]), atol=1e-9)
        assert np.allclose(np.exp(1j * (theta + seat_order.START)), np.exp(1j * angle))
        assert (theta >= 0).all() and (turn == records[:, record.REACH]).all()
    assert len({str(triple) for triple in triples.values()}) == len(triples) > 10


def test_a_group_holds_several_places_and_is_bounded_by_the_best() -> None:
    """Contacts on the same holes at the same angle may be of two seats: neither stands for the other."""
    order, off = np.array([4, 3, 1, 2, 0]), np.array([3.0, 1.0, 1.0, 1.0, 2.0])
    assert seat_order.find_best_known(order, off, np.array([0, 3])).tolist() == [1, 2]


@pytest.mark.thorough
def test_no_two_heads_push_along_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Locators across a slot as wide as a pitch, and on a diameter, fix no pose with a third."""
    for seed, pitch in ((11, 20.0), (6, 20.0)):
        query = Query(cad_part(seed), Plate(pitch=pitch, peg_radius=3, clamps=2), best=5)
        for records, problem in zip(*contacts_of(query, monkeypatch), strict=True):
            features, columns, rows = (
                records[:, first + 1 : first + 3].astype(int)
                for first in (record.FEATURES, record.COLUMNS, record.ROWS)
            )
            lengths = pitch * np.hypot(np.diff(columns, axis=1), np.diff(rows, axis=1))[:, 0]
            heads = {
                (*both, length)
                for both, length in zip(map(tuple, features.tolist()), lengths.tolist(), strict=True)
            }
            assert len(heads) > 100
            for a, b, length in heads:
                assert not share_one_line(problem.rows[a], problem.rows[b], length)


def test_heads_on_one_line_still_count_as_contacts() -> None:
    """The measure of the paper asks of contacts nothing but to be ones."""
    points = [(0, 0), (60, 0), (60, 50), (43, 50), (43, 17), (17, 17), (17, 50), (0, 50)]
    slotted = workhold.Workpiece.from_loops("slot", [[(x, y, 0) for x, y in points]])
    assert workhold.count_contacts(slotted, workhold.Vise(pitch=20, columns=3, peg_radius=3)) == 47679
