"""Ranking: by several figures, stable, and with names a user may get wrong."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold import InputError
from workhold.listing.ranking import best_marked, rank
from workhold.model.quality import (
    CLOSURE_MARGIN,
    DEFAULT_RANKING,
    FIGURES,
    LOCATION_ERROR,
    PREFERENCES,
    WRENCH_RADIUS,
    asked_ranking,
    chosen_ranking,
)
from workhold.model.requirements import Load, Tolerance

# So loose that no fixture is unfit by its location error.
LOOSE = Tolerance(1.0, 1.0)


def figures(count: int, **columns: list[float]) -> np.ndarray:
    """Figures of quality that are 1 but for some columns."""
    quality = np.ones((count, len(FIGURES)))
    for name, values in columns.items():
        quality[:, [figure.key for figure in FIGURES].index(name)] = values
    return quality


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
    """Without ties exactly the first so many; with ties also those equal to the last of them, and none else."""
    margins = data.draw(st.lists(st.sampled_from([0.1, 0.2]), min_size=len(errors), max_size=len(errors)))
    quality = figures(len(errors), location_error=errors, closure_margin=margins)
    ranking = ("location_error", "closure_margin")
    order = rank(quality, ranking, LOOSE)
    assert np.flatnonzero(best_marked(quality, ranking, LOOSE, most, ties=False)).tolist() == sorted(
        order[:most]
    )
    marked = best_marked(quality, ranking, LOOSE, most, ties=True)
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
    assert chosen_ranking(["Location-Error", "wrench radius"], []) == ("location_error", "wrench_radius")
    assert chosen_ranking(None, []) == DEFAULT_RANKING
    assert "load_reaction" in chosen_ranking(None, [Load(moment=1.0)])
    assert FIGURES[WRENCH_RADIUS].option == "wrench-radius"


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["beauty"], "'beauty' is no figure to rank by: choose among closure-margin"),
        (["end-distance", "end distance"], "name one twice"),
        (["load-reaction"], "no load"),
        ([], "name at least one"),
    ],
)
def test_names_that_cannot_be_ranked_by(names: list[str], words: str) -> None:
    """One sentence with the remedy."""
    with pytest.raises(InputError, match=words):
        chosen_ranking(names, [])


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


@given(st.lists(st.integers(0, 3), min_size=2, max_size=12), st.data())
def test_fixtures_with_a_warning_never_stand_before_those_without(
    warnings: list[int], data: st.DataObject
) -> None:
    """Whatever is preferred."""
    errors = data.draw(st.lists(st.floats(0.01, 0.9), min_size=len(warnings), max_size=len(warnings)))
    quality = figures(len(warnings), warnings=list(map(float, warnings)), location_error=errors)
    for ranking in (DEFAULT_RANKING, *PREFERENCES.values()):
        told = [warnings[k] for k in rank(quality, ranking, LOOSE)]
        assert told == sorted(told)


def test_a_preference_is_an_order_and_not_two() -> None:
    """With loads it asks for the load reaction instead of the clamp amplification."""
    assert asked_ranking(None, " Square ", []) == PREFERENCES["square"]
    assert asked_ranking(None, None, []) is None
    assert "load_reaction" in asked_ranking(None, "strong", [Load(moment=1.0)])
    with pytest.raises(InputError, match="choose square, strong, precise, roomy"):
        asked_ranking(None, "pretty", [])
    with pytest.raises(InputError, match="two orders"):
        asked_ranking(["closure-margin"], "square", [])
