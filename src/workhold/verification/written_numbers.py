"""Whether the numbers that a file writes of a fixture are the derived ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb

from workhold.model.fixture import Fixture, Pair
from workhold.verification.ball_geometry import largest
from workhold.verification.contacts import Balance
from workhold.verification.figures import COUNTS, RANGES, parts_spared
from workhold.verification.seat import CLAMPS, LOCATORS, SeatBalance
from workhold.verification.tolerances import (
    HAIR,
    NO_REACTION,
    Finding,
    number,
    rule,
)

__all__ = ["pair_numbers", "written", "written_numbers"]


def written_numbers(
    fixture: Fixture, names: Sequence[str], balance: Balance | SeatBalance, figures: Mapping[str, arb]
) -> Iterator[Finding]:
    """Whether the forces of pegs of some names and the figures of quality of the file are the derived ones.

    The file's numbers were computed in double precision from a rounded pose. An error of the pose moves a
    fixture by as many times more as its forces exceed the clamping force, and its forces by that factor
    again. A derived end distance is a range where the clearance passes slowly through zero, and so is a count
    beside the edge of what it counts. Any number in the range is right.
    """
    part = parts_spared(balance)
    for name, peg, force in zip(names, fixture.pegs, balance.forces, strict=True):
        yield from written(f"the force of {name}", peg.force, force, part * abs(force))
    for key, derived in figures.items():
        if key in fixture.quality:
            if key in COUNTS and not fixture.quality[key].is_integer():
                yield Finding(
                    True, f"its {key} is {fixture.quality[key]:.12g} in the file, which is no whole number"
                )
            spare = part * abs(derived) + (2 * derived.rad() if key in RANGES else 0)
            yield from written(f"its {key.replace('_', ' ')}", fixture.quality[key], derived, spare)


def pair_numbers(pair: Pair, names: Sequence[str], balance: SeatBalance) -> Iterator[Finding]:
    """Whether the reactions and the ends of the ratio in the file are the derived ones."""
    part = parts_spared(balance)
    for name, said, derived in zip(names, pair.reactions, balance.reactions, strict=True):
        for clamp, value, force in zip(CLAMPS, said, derived, strict=True):
            yield from written(f"the force of {name} under {clamp}", value, force, part * (1 + abs(force)))
    # The ends follow from reactions that are off.
    said, ratio = pair.ratio, balance.ratio
    least = [abs(b) for _, b in balance.reactions[:LOCATORS] if abs(b) > NO_REACTION]
    loss = 1 + largest([1 / b for b in least]) if least else arb(1)
    yield from written("the lower end of its ratio", said[0], ratio.low, part * loss * (1 + ratio.low))
    if (ratio.high is None) != (said[1] == float("inf")):
        end = "has none" if ratio.high is None else f"is {number(ratio.high)}"
        yield Finding(True, f"the upper end of its ratio {end}, and the file says otherwise")
    elif ratio.high is not None:
        yield from written("the upper end of its ratio", said[1], ratio.high, part * loss * (1 + ratio.high))


def written(name: str, value: float, derived: arb, spare: arb) -> Iterator[Finding]:
    """Whether a number of the file is the derived one, to a hair and what may be spared besides."""
    slack = HAIR + spare - abs(derived - value)
    if not slack > 0:
        words = f"{name} is {value:.12g} in the file and comes to {float(derived.mid()):.12g}"
        yield from rule(slack, words, words)
