"""In which order two clamps are tightened, and with what forces, in a machinist's words.

The locators are all pressed for an open interval of ratios of the two forces, see ``model.force_ratio``. Where it begins at
zero the first clamp alone lifts the part off no locator; where it has no upper end, the second does not.
"""

from __future__ import annotations

from math import ceil, floor, inf, log10

from workhold.model.fixture import Fixture

__all__ = ["clamp_names", "clamp_shares", "first_clamps", "freedom_words", "order_words", "second_over_first"]

# Digits of a ratio that is told, rounded so that it lies inside the interval.
DIGITS = 2


def clamp_names(fixture: Fixture) -> tuple[str, ...]:
    """What the clamps of a fixture are called: by holes or lines, and where both are on one line by directions too."""
    tips = fixture.pegs[-2:]
    holes = [tip.hole for tip in tips]
    if len(set(holes)) == len(holes):
        return tuple(holes)
    directions = [tip.carrier.rpartition(" ")[2].replace("-", "\N{MINUS SIGN}") for tip in tips]
    if len(set(directions)) == len(directions):
        return tuple(f"{hole} {direction}" for hole, direction in zip(holes, directions, strict=True))
    return tuple(f"{hole} on face {tip.face}" for hole, tip in zip(holes, tips, strict=True))


def first_clamps(fixture: Fixture) -> tuple[str, ...]:
    """What those of two clamps are called that may be tightened first, as they lift the part off no locator."""
    if fixture.pair is None:
        return ()
    low, high = fixture.pair.ratio
    return tuple(name for name, may in zip(clamp_names(fixture), (low == 0.0, high == inf), strict=True) if may)


def second_over_first(fixture: Fixture) -> float:
    """The second clamp's force over the first's at the working ratio; 0 where one clamp or jaw holds the part."""
    return 0.0 if fixture.pair is None else fixture.pair.working_ratio


def clamp_shares(fixture: Fixture) -> tuple[float, ...]:
    """The part of the clamp force, of two the sum of both, that each clamp has at the working ratio."""
    if fixture.pair is None:
        return (1.0,)
    ratio = fixture.pair.working_ratio
    return 1.0 / (1.0 + ratio), ratio / (1.0 + ratio)


def order_words(fixture: Fixture) -> str:
    """How to tighten the two clamps, one or two sentences; nothing for other fixtures.

    Examples
    --------
    >>> from workhold.model.fixture import Pair, Peg, Pose
    >>> tips = [Peg(f"clamp {d}", 4, 1, 66.0, 20.0, 2, 0.5, f"clamp {hole}") for d, hole in (("-x", "E2"), ("-y", "C5"))]
    >>> def words(low, high):
    ...     pair = Pair((0, 0), (low, high), (), 1)
    ...     return order_words(Fixture("clamp2", tuple(tips), Pose(0, 0, 0), 0, {}, "-x -y", pair))
    >>> words(0.0, float("inf"))
    'Tighten either clamp first, each as hard as it needs: neither lifts the part off a locator.'
    >>> words(0.0, 2.468)
    'Tighten clamp E2 first. Then tighten clamp C5 with less than 2.4 times its force: more lifts the part off a locator.'
    """
    if fixture.pair is None:
        return ""
    (low, high), (first, second) = fixture.pair.ratio, clamp_names(fixture)
    if low == 0.0 and high == inf:
        return "Tighten either clamp first, each as hard as it needs: neither lifts the part off a locator."
    if low == 0.0 or high == inf:
        one, other, most = (first, second, high) if low == 0.0 else (second, first, 1.0 / low)
        return (
            f"Tighten {one} first. Then tighten {other} with less than {inside(most, floor)} times its force: more lifts "
            "the part off a locator."
        )
    return (
        f"Bring both up together, in small turns: {second} with {inside(low, ceil)} to {inside(high, floor)} times the "
        f"force of {first}. Neither may be tightened alone: it lifts the part off a locator."
    )


def freedom_words(degrees: float) -> str:
    """What a clamp freedom means.

    >>> freedom_words(90.0), freedom_words(71.5), freedom_words(4.0)
    ('any two forces hold', 'no torque wrench is needed', 'both forces have to be right: use a torque wrench')
    """
    if degrees >= 90.0 - 1e-9:
        return "any two forces hold"
    return "no torque wrench is needed" if degrees >= EASY else "both forces have to be right: use a torque wrench"


# Degrees of clamp freedom from which a hand tightens well enough: forces may be off by a factor of two to either side.
EASY = 45.0


def inside(ratio: float, towards: type[int] | object) -> str:
    """A ratio to two digits, rounded up by ``ceil`` or down by ``floor``."""
    step = 10.0 ** (floor(log10(ratio)) - DIGITS + 1)
    whole = floor(ratio / step) if towards is floor else ceil(ratio / step)
    return f"{whole * step:.{DIGITS}g}" if 1e-4 < ratio < 100 else f"{whole * step:,.4g}"
