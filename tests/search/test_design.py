"""Limits of the vise and options of the search take away exactly the fixtures they forbid."""

from __future__ import annotations

from threading import Event

import numpy as np
import pytest

from fixture_sets import Judge, listed
from workhold import InputError, Result, Vise, design, load
from workhold.statics.judging import are_unfit


def keys(result: Result) -> list[object]:
    """Identities of all listed fixtures, sorted."""
    judge = Judge(result.workpiece, result.toolkit)
    return sorted((key, round(theta, 6)) for key, theta, _ in map(judge.identity, listed(result)))


def vise(**changes: object) -> Vise:
    """A two-column vise with some fields changed."""
    return Vise(**({"pitch": 10.0, "columns": 2, "peg_radius": 3.0} | changes))


@pytest.fixture(scope="module")
def free() -> Result:
    """The widget without limits."""
    return design(load("widget"), vise())


@pytest.mark.parametrize("rows", [1, 3, 5])
def test_rows_limit_the_span_of_rows(free: Result, rows: int) -> None:
    """With R rows exactly the fixtures whose pegs span at most R rows remain, and stand in the middle of the jaws."""
    limited = design(free.workpiece, vise(rows=rows))
    span = np.ptp(free.table.row, axis=1)
    assert len(limited) == int((span < rows).sum())
    low, high = limited.table.row.min(axis=1), rows - 1 - limited.table.row.max(axis=1)
    assert ((high - low >= 0) & (high - low <= 1)).all()


@pytest.mark.thorough
def test_max_opening_moves_pegs_outward_or_forbids(free: Result) -> None:
    """With a largest opening a fixture remains exactly when some columns bring the separation below it; no listed
    separation exceeds it or falls below the smallest gap, and pegs move outward no farther than needed."""
    most = 32.0
    limited = design(free.workpiece, vise(max_opening=most))
    separation = limited.table.jaw_separation
    assert ((separation <= most + 1e-6) & (separation >= 10.0 - 1e-6)).all()
    left = free.toolkit.find_peg_carriers(free.table.arrangement) == 0
    span_left = np.where(left, free.table.column, 1).min(axis=1)
    span_right = 1 - np.where(left, 0, free.table.column).max(axis=1)
    needed = np.maximum(np.ceil((free.table.jaw_separation - most) / 10.0 - 1e-9), 0)
    possible = (needed <= span_left + span_right) & (free.table.jaw_separation - 10 * needed >= 10.0)
    assert len(limited) == int(possible.sum())
    judge = Judge(limited.workpiece, limited.toolkit)
    assert all(judge.check(fixture)[0] == [] for fixture in listed(limited)[::7])


def test_min_gap_forbids_narrow_openings(free: Result) -> None:
    """Raising the smallest gap drops exactly the fixtures whose jaws' pegs come nearer."""
    wide = design(free.workpiece, vise(min_gap=35.0))
    assert len(wide) == int((free.table.jaw_separation >= 35.0).sum())


def test_row_offset_of_whole_pitches_renumbers_rows(free: Result) -> None:
    """An offset of one pitch is the same lattice; the fixtures are the same up to row numbers."""
    shifted = design(free.workpiece, vise(row_offset=10.0))
    assert shifted.counts == free.counts
    assert np.allclose(np.sort(shifted.table.theta), np.sort(free.table.theta))


@pytest.mark.thorough
def test_contact_margin_drops_contacts_near_ends(free: Result) -> None:
    """Each margin keeps a subset, and a margin longer than every feature keeps nothing."""
    before = set(map(str, keys(free)))
    for margin in (0.5, 2.0):
        kept = set(map(str, keys(design(free.workpiece, free.toolkit, contact_margin=margin))))
        assert kept < before
        before = kept
    assert len(design(free.workpiece, free.toolkit, contact_margin=1000.0)) == 0


def test_types_are_found_alone(free: Result) -> None:
    """Asking for one type gives that type's part of the list."""
    for name in ("I", "II"):
        alone = design(free.workpiece, free.toolkit, types=[name])
        assert alone.counts == {k: (v if k == name else 0) for k, v in free.counts.items()}


def test_best_are_the_first_of_all(free: Result) -> None:
    """``best`` lists the first of the full ranking, and says that the others were not counted."""
    best = design(free.workpiece, free.toolkit, best=7)
    assert len(best) == 7
    assert best.found == best.counts
    assert any("not counted" in str(note) for note in best.notes)
    assert np.array_equal(best.table.theta, free.table.theta[:7])


@pytest.mark.thorough
def test_ranked_by_closure_margin(free: Result) -> None:
    """The closure margin falls along the list, but for what is not a fixture for a workshop, which comes last."""
    ranked = design(free.workpiece, free.toolkit, rank_by=["closure margin"])
    margins, last = (
        np.round(ranked.table.null_vector.min(axis=1), 9),
        are_unfit(ranked.table.quality, ranked.query.tolerance),
    )
    assert not last.all() and (np.diff(last.astype(int)) >= 0).all()
    for part in (margins[~last], margins[last]):
        assert (np.diff(part) <= 0).all()
    assert keys(ranked) == keys(free)


def test_forces_balance_the_clamping_force(free: Result) -> None:
    """The forces are the null vector in units of the clamping force: the right pegs push back with x force 1."""
    ratio = free.table.force / free.table.null_vector
    assert np.allclose(ratio, ratio[:, :1])
    assert (free.table.force > 0).all()


def test_cancelled_before_it_begins(free: Result) -> None:
    """A search cancelled at once returns a valid, incomplete, empty result."""
    cancel = Event()
    cancel.set()
    result = design(free.workpiece, free.toolkit, cancel=cancel)
    assert not result.complete
    assert len(result) == 0


@pytest.mark.thorough
def test_cancelled_half_way_keeps_valid_fixtures(free: Result) -> None:
    """What was found before the cancel is kept: each fixture is one of the full list."""
    cancel = Event()

    def stop(fraction: float, found: int) -> None:
        if found:
            cancel.set()

    part = design(free.workpiece, free.toolkit, threads=1, progress=stop, cancel=cancel)
    assert not part.complete
    assert 0 < len(part) < len(free)
    assert set(map(str, keys(part))) <= set(map(str, keys(free)))


def test_progress_rises_to_the_end(free: Result) -> None:
    """Progress is reported from this thread, never falls, and ends at 1."""
    seen: list[float] = []
    design(free.workpiece, free.toolkit, progress=lambda fraction, found: seen.append(fraction))
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"types": ["III"]}, "type III is unknown"),
        ({"contact_margin": -1.0}, "contact margin -1 is not a length"),
        ({"contact_margin": float("nan")}, "contact margin nan is not a length"),
        ({"best": 0}, "best 0 is not a positive whole number"),
        ({"threads": 0}, "threads 0 is not a positive whole number"),
    ],
)
def test_bad_options(free: Result, options: dict[str, object], words: str) -> None:
    """Options out of range are refused in one sentence."""
    with pytest.raises(InputError, match=words):
        design(free.workpiece, free.toolkit, **options)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["small4Handle", "thin4Handle", "widget"])
def test_distinct_counts_by_brute_force(name: str) -> None:
    """The number of sets under the part's rotations equals a count by carrying every fixture around by hand.

    The four-handled parts turn onto themselves by quarter turns, which add two to a segment's number; the widget does
    not turn onto itself.
    """
    result = design(load(name), Vise(pitch=10, columns=2, peg_radius=3))
    judge = Judge(result.workpiece, result.toolkit)
    orbit = 4 if "4" in name else 1
    seen: set[object] = set()
    sets = {"I": 0, "II": 0}
    for fixture in listed(result):
        images = []
        for k in range(orbit):
            moved = fixture | {
                "pegs": [
                    peg | {"segment": (peg["segment"] + 2 * k) % 8} if k else peg for peg in fixture["pegs"]
                ],
                "pose": fixture["pose"] | {"theta_deg": fixture["pose"]["theta_deg"] - 90.0 * k},
            }
            key, theta, _ = judge.identity(moved)
            images.append((str(key), round(theta, 4) % 6.2832, round(fixture["jaw_separation"], 4)))
        if not seen & set(images):
            sets[fixture["type"]] += 1
        seen.update(images)
    assert sets == dict(result.distinct)
