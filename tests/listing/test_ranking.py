"""Ranking: by several figures, stable, and with names a user may get wrong."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold import InputError, Load, Tolerance
from workhold.listing.ranking import (
    OrderKeys,
    convert_to_billionths,
    count_error_steps,
    is_worse,
    make_order_keys,
)
from workhold.model.first_choice import has_house_order
from workhold.model.quality import (
    CLOSURE_MARGIN,
    DEFAULT_RANKING,
    FIGURES,
    LOCATION_ERROR,
    PREFERENCES,
    WRENCH_RADIUS,
    read_asked_ranking,
    resolve_ranking,
)

# So loose that no fixture is unfit by its location error.
LOOSE = Tolerance(1.0, 1.0)


def figures(count: int, **columns: list[float]) -> np.ndarray:
    """Figures of quality that are 1 but for some columns."""
    quality = np.ones((count, len(FIGURES)))
    for name, values in columns.items():
        quality[:, [figure.key for figure in FIGURES].index(name)] = values
    return quality


def keys(quality: np.ndarray, ranking: Sequence[str], tolerance: Tolerance, angles: Any = 0) -> OrderKeys:
    """The keys of fixtures without any factor."""
    error = quality[:, LOCATION_ERROR] if has_house_order(ranking) else None
    asked: Any = SimpleNamespace(rank_by=ranking, tolerance=tolerance)
    return make_order_keys(quality, asked, error, np.zeros(len(quality), np.int64) + angles)


def rank(quality: np.ndarray, ranking: Sequence[str], tolerance: Tolerance) -> np.ndarray:
    """The order of fixtures, best first."""
    found = keys(quality, ranking, tolerance)
    return found.sort(found.least_error)


def test_the_next_figure_decides_among_those_about_as_good() -> None:
    """Figures but the last count to two digits: 0.0201 and 0.0199 are equal, 0.021 is worse."""
    quality = figures(4, location_error=[0.021, 0.0201, 0.0199, 0.0204], wrench_radius=[0.9, 0.2, 0.3, 0.25])
    assert rank(quality, ("location_error", "wrench_radius"), LOOSE).tolist() == [2, 3, 1, 0]
    assert rank(quality, ("wrench_radius", "location_error"), LOOSE).tolist() == [0, 2, 3, 1]


@pytest.mark.parametrize("ranking", [("closure_margin",), ("location_error", "closure_margin")])
def test_the_last_figure_counts_to_nine_digits(ranking: tuple[str, ...]) -> None:
    """Margins that agree to seven digits still decide, alone or after others; larger is better."""
    quality = figures(3, closure_margin=[0.12345678, 0.12345680, 0.12345679])
    assert rank(quality, ranking, LOOSE).tolist() == [1, 2, 0]


def test_equal_fixtures_stay_in_the_order_of_their_identities() -> None:
    """What agrees to nine digits in the last figure is not moved."""
    quality = figures(3, closure_margin=[0.2, 0.2 + 1e-11, 0.1])
    assert rank(quality, ("closure_margin",), LOOSE).tolist() == [0, 1, 2]


@given(
    st.lists(st.sampled_from([0.01, 0.011, 0.0111, 0.5, 0.0]), min_size=1, max_size=12),
    st.integers(1, 12),
    st.data(),
)
def test_the_best_marked_are_the_first_ranked(errors: list[float], most: int, data: st.DataObject) -> None:
    """The first so many, also those equal to the last of them, and none else."""
    margins = data.draw(st.lists(st.sampled_from([0.1, 0.2]), min_size=len(errors), max_size=len(errors)))
    quality = figures(len(errors), location_error=errors, closure_margin=margins)
    ranking = ("location_error", "closure_margin")
    order = rank(quality, ranking, LOOSE)
    marked = keys(quality, ranking, LOOSE).are_among_best(most)
    assert marked[order[:most]].all()
    last = quality[order[min(most, len(order)) - 1]]
    for index in np.flatnonzero(marked):
        if index not in order[:most]:
            assert (
                abs(quality[index, LOCATION_ERROR] - last[LOCATION_ERROR])
                < 0.01 * last[LOCATION_ERROR] + 1e-12
            )
            assert quality[index, CLOSURE_MARGIN] == last[CLOSURE_MARGIN]


def test_names_are_read_as_people_write_them() -> None:
    """With hyphens, underscores or spaces, in any mixture of capitals."""
    assert resolve_ranking(["Location-Error", "wrench radius"], []) == ("location_error", "wrench_radius")
    assert resolve_ranking(None, []) == DEFAULT_RANKING
    assert "load_reaction" in resolve_ranking(None, [Load(moment=1.0)])
    assert FIGURES[WRENCH_RADIUS].option == "wrench-radius"


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["beauty"], "'beauty' is not a figure to rank by: choose among closure-margin"),
        (["end-distance", "end distance"], "name one twice"),
        (["load-reaction"], "no load"),
        ([], "name at least one"),
    ],
)
def test_names_that_cannot_be_ranked_by(names: list[str], words: str) -> None:
    """One sentence with the remedy."""
    with pytest.raises(InputError, match=words):
        resolve_ranking(names, [])


@pytest.mark.thorough
@given(st.lists(st.tuples(st.floats(0.001, 3.0), st.floats(0.0, 0.25)), min_size=1, max_size=12), st.data())
def test_what_is_none_for_a_workshop_comes_last(
    figures_of: list[tuple[float, float]], data: st.DataObject
) -> None:
    """In every order: beyond 50 times the tolerances, or with less than a hundredth of the even share."""
    errors, margins = zip(*figures_of, strict=True)
    quality = figures(len(errors), location_error=list(errors), closure_margin=list(margins))
    ranking = data.draw(st.sampled_from([DEFAULT_RANKING, *PREFERENCES.values(), ("wrench_radius",)]))
    order = rank(quality, ranking, Tolerance())
    last = [errors[k] > 1.0 + 1e-9 or margins[k] < 0.0025 - 1e-9 for k in order]
    assert last == sorted(last)


@pytest.mark.thorough
@given(st.lists(st.integers(0, 3), min_size=2, max_size=12), st.data())
def test_fixtures_with_a_warning_never_stand_before_those_without(
    warnings: list[int], data: st.DataObject
) -> None:
    """Whatever is preferred; how many there are counts first only where something is."""
    errors = data.draw(st.lists(st.floats(0.01, 0.9), min_size=len(warnings), max_size=len(warnings)))
    quality = figures(len(warnings), warnings=list(map(float, warnings)), location_error=errors)
    for ranking in (DEFAULT_RANKING, *PREFERENCES.values()):
        told = [warnings[k] for k in rank(quality, ranking, LOOSE)]
        told = [number > 0 for number in told] if has_house_order(ranking) else told
        assert told == sorted(told)


def test_a_preference_is_an_order_and_not_two() -> None:
    """With loads it asks for the load reaction instead of the clamp amplification."""
    assert read_asked_ranking(None, " Square ", []) == PREFERENCES["square"]
    assert read_asked_ranking(None, None, []) is None
    assert "load_reaction" in read_asked_ranking(None, "strong", [Load(moment=1.0)])
    with pytest.raises(InputError, match="choose square, strong, precise, roomy"):
        read_asked_ranking(None, "pretty", [])
    with pytest.raises(InputError, match="two orders"):
        read_asked_ranking(["closure-margin"], "square", [])


def test_steps_are_counted_in_whole_numbers() -> None:
    """A tenth more is a step, however numbers are rounded; and so is each further tenth of what is then."""
    least = 50_000_000
    errors = [least, 54_999_999, 55_000_000, 60_499_999, 60_500_000, 66_549_999, 66_550_000, least - 7]
    assert count_error_steps(np.array(errors), least).tolist() == [0, 0, 1, 1, 2, 2, 3, 0]
    many = np.random.default_rng(1).integers(1, 10**12, 300)
    for one, steps in zip(many.tolist(), count_error_steps(many, 977).tolist(), strict=True):
        assert one * 10**steps >= 977 * 11**steps or steps == 0
        assert one < Fraction(11, 10) ** (steps + 1) * 977
    assert count_error_steps(np.array([0, 1, 2]), 0).tolist() == [0, 0, 7]
    assert convert_to_billionths(np.array([0.055, np.nan, 1e300])).tolist() == [
        55_000_000,
        4 * 10**17,
        4 * 10**17,
    ]


def test_a_warning_counts_before_steps_and_steps_before_the_angle() -> None:
    """And the angle before any figure."""
    quality = figures(
        6,
        warnings=[1, 0, 0, 0, 0, 0],
        location_error=[0.01, 0.043, 0.0435, 0.04, 0.044, 0.0399],
        penalty=[0, 0, 0, 5, 0, 7],
    )
    found = keys(quality, DEFAULT_RANKING, LOOSE, np.array([0, 1, 0, 2, 0, 2]))
    assert found.least_error == 39_900_000
    assert found.sort(found.least_error).tolist() == [2, 1, 3, 5, 4, 0]


class Drawn:
    """Random fixtures of few different numbers, so that many are equal."""

    def __init__(self, data: st.DataObject) -> None:
        count = data.draw(st.integers(1, 14))

        def some(values: list[float]) -> list[float]:
            return data.draw(st.lists(st.sampled_from(values), min_size=count, max_size=count))

        errors = some([0.04, 0.041, 0.0439, 0.044, 0.0441, 0.0483, 0.0484, 0.05, 0.9])
        warnings, points = some([0.0, 0.0, 0.0, 1.0]), some([1.0, 2.0])
        quality = figures(count, warnings=warnings, location_error=errors, penalty=points)
        self.keys = keys(quality, DEFAULT_RANKING, LOOSE, np.array(some([0, 1, 2]), np.int64))


@pytest.mark.thorough
@given(st.data(), st.integers(1, 5), st.integers(0, 13))
def test_what_is_kept_holds_the_best_whatever_comes_later(data: st.DataObject, most: int, cut: int) -> None:
    """Kept of a part and then of all: the first so many of all are among it, and the least error stays."""
    whole = Drawn(data).keys
    first = np.flatnonzero(whole.take(slice(cut)).are_among_best(most))
    rest = np.arange(min(cut, len(whole)), len(whole))
    some = np.concatenate([first, rest])
    kept = some[whole.take(some).are_among_best(most)]
    assert set(whole.sort(whole.least_error)[:most].tolist()) <= set(kept.tolist())
    assert whole.take(kept).least_error == whole.least_error


@pytest.mark.thorough
@given(st.data(), st.integers(1, 4))
def test_what_is_beaten_is_not_among_the_best(data: st.DataObject, most: int) -> None:
    """With an error known to be the least of all, and without; and a bound is never beaten by itself."""
    found, others = Drawn(data).keys, Drawn(data).keys
    kept = found.take(found.are_among_best(most))
    for floor in (0, others.lowest_error):
        beaten = others.are_beaten(kept, most, min(floor, others.lowest_error))
        whole = kept.concatenate(others)
        best = whole.sort(whole.least_error)[:most] - len(kept)
        assert not beaten[best[best >= 0]].any()
        assert (
            not beaten[others.error == (whole.least_error or 0)][
                others.first[others.error == (whole.least_error or 0)].max(axis=1) == 0
            ].any()
            or kept.least_error == whole.least_error
        )


def test_keys_are_compared_in_lexicographic_order() -> None:
    rows = np.array([[0.0, 5.0], [1.0, 0.0], [1.0, 2.0], [1.0, 3.0], [2.0, 0.0]])
    assert is_worse(rows, np.array([1.0, 2.0])).tolist() == [False, False, False, True, True]
