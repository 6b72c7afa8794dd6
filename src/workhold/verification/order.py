"""Whether fixtures are listed in the order of their figures of quality (docs/quality.md, "Which comes first").

Every figure but the last counts to two significant digits, the last to nine decimals. A figure is written rounded, and that
rounding may carry it over the edge between two pairs of digits, so each is looked at a little to either side. The order of
``listing.ranking`` is not used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from workhold.model.fixture import Fixture
from workhold.model.quality import FIGURES
from workhold.verification.rules import HAIR

__all__ = ["order_faults"]

# Files have twelve significant digits.
DIGITS = 1e-12
# What a number is counted as at least and at most.
Range = tuple[float, float]
MORE_IS_BETTER = {figure.key: figure.more_is_better for figure in FIGURES}


def order_faults(fixtures: Sequence[Fixture], ranking: Sequence[str]) -> Iterator[str]:
    """A fault when a fixture is better than the one before it; none where the figures ranked by are not written."""
    if not ranking or any(key not in fixture.quality for fixture in fixtures for key in ranking):
        return
    rows = [ranges(fixture, ranking) for fixture in fixtures]
    for place in range(1, len(rows)):
        if is_better(rows[place], rows[place - 1]):
            yield f"fixture {place + 1} is better than the one before it, by {', '.join(ranking)}"
            return


def ranges(fixture: Fixture, ranking: Sequence[str]) -> list[Range]:
    """What the figures of a fixture count as, the first counting most and smaller being better."""
    out = []
    for place, key in enumerate(ranking, 1):
        value = -fixture.quality[key] if MORE_IS_BETTER[key] else fixture.quality[key]
        spare = HAIR + DIGITS * abs(value)
        low, high = value - spare, value + spare
        out.append((low, high) if place == len(ranking) else (two_digits(low), two_digits(high)))
    return out


def two_digits(value: float) -> float:
    """A number to two significant digits."""
    return float(f"{value:.1e}")


def is_better(one: Sequence[Range], other: Sequence[Range]) -> bool:
    """Whether one row of figures is certainly better than another: at the first that may differ."""
    for (low, high), (least, most) in zip(one, other, strict=True):
        if high < least:
            return True
        if not low == high == least == most:
            return False
    return False
