"""A budget lets through what the limits say, and not one more."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

from workhold.errors import InputError
from workhold.files.budget import UNLIMITED, Budget, FileLimits, OverBudgetError

SMALL = FileLimits("a drawing", 100, 3, "elements", 2, 10.0, 2.0)


class Clock:
    """A clock of a thread that a test sets, and how often it was looked at."""

    def __init__(self) -> None:
        self.now, self.looks = 0.0, 0

    def __call__(self) -> float:
        self.looks += 1
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """The clock of budgets, at 0."""
    found = Clock()
    monkeypatch.setattr("workhold.files.budget.time.thread_time", found)
    return found


def test_elements_that_lie_inside_each_other_are_counted_and_those_beside_are_not() -> None:
    budget = Budget(SMALL)
    for _ in range(5):
        with budget.count_nesting("an element"), budget.count_nesting("an element"):
            pass
    with ExitStack() as inside:
        inside.enter_context(budget.count_nesting("an element"))
        inside.enter_context(budget.count_nesting("an element"))
        with pytest.raises(InputError, match="an element is nested more than 2 levels deep"):
            inside.enter_context(budget.count_nesting("an element"))
    # What was refused is left, too.
    assert budget.depth == 0


@pytest.mark.parametrize("size", [0, 500_000, 3_000_000])
def test_time_grows_with_the_file_and_counts_from_the_start_of_its_reading(clock: Clock, size: int) -> None:
    clock.now = 1000.0
    budget = Budget(SMALL, size)
    clock.now += 10.0 + 2.0 * size / 1e6
    budget.check_time()
    clock.now += 0.1
    with pytest.raises(InputError, match=f"given up after {10 + 2 * size / 1e6:.0f} s"):
        budget.check_time()


@pytest.mark.parametrize("size", [1, 100, 255, 256, 1000])
def test_the_clock_is_looked_at_now_and_then_however_many_steps_are_counted_at_once(
    clock: Clock, size: int
) -> None:
    budget = Budget(SMALL)
    for _ in range(10_000 // size):
        budget.count_steps(size)
    # And once at the start.
    assert 2 <= clock.looks <= 1 + 10_000 // Budget.PERIOD
    clock.now = 20.0
    with pytest.raises(InputError, match="given up after"):
        for _ in range(256):
            budget.count_steps()


def test_elements_take_time_too(clock: Clock) -> None:
    budget = Budget(FileLimits("a drawing", 100, None, seconds=1.0))
    clock.now = 2.0
    with pytest.raises(InputError, match="given up after 1 s"):
        budget.spend(Budget.PERIOD)


def test_what_has_no_limits_is_never_refused(clock: Clock) -> None:
    budget = Budget(UNLIMITED)
    clock.now = 1e9
    budget.spend(10**9)
    with ExitStack() as inside:
        for _ in range(1000):
            inside.enter_context(budget.count_nesting("an element"))


def test_an_error_that_is_its_own_cause_has_no_other_behind_it() -> None:
    """As one that is raised again from itself, with a refusal behind it or none."""
    error = InputError("open")
    error.__cause__ = error
    assert not OverBudgetError.is_behind(error)
    other = InputError("too much")
    other.__cause__ = OverBudgetError("of it")
    assert OverBudgetError.is_behind(other)
