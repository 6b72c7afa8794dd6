"""Whether numbers that a file writes of a fixture are the derived ones, a program's forces among them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from flint import arb

from workhold.model.fixture import Fixture, Pair
from workhold.model.query import Query
from workhold.verification.ball_geometry import largest
from workhold.verification.contacts import Balance, BallContact, BallPose
from workhold.verification.figures import COUNTS, RANGES, parts_spared
from workhold.verification.force_walk import ForceWalk, force_walk_of
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seat import CLAMPS, LOCATORS, SeatBalance
from workhold.verification.tolerances import (
    HAIR,
    NO_REACTION,
    Finding,
    number,
    rule,
)

__all__ = ["pair_numbers", "program_force_findings", "written", "written_numbers"]

KEYS = ("jaw", "contact", "jaw_force", "room")
ASKED = ("force", "line", "tool", "element")
# Coefficients of the load (g_x, g_y, moment), and of the jaw force.
Row = tuple[arb, arb, arb]


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


def program_force_findings(
    fixture: Fixture,
    query: Query,
    hardware: ToolkitRules,
    contacts: Sequence[BallContact],
    pose: BallPose,
    balance: Balance | SeatBalance,
) -> Iterator[Finding]:
    """What is wrong with the forces of the program that a file states of a fixture."""
    said, walk = fixture.asking, None if query.program is None else force_walk_of(query.program)
    if walk is None or said is None:
        if said is not None:
            yield Finding(True, "the forces of its program are given, and the program has none")
        return
    if fault := fault_of_form(said):
        yield Finding(True, f"the forces of its program {fault}")
        return
    inverse = balance.inverse(contacts, pose)
    if inverse is None:
        return
    rows = [balance.of_all(row) for row in inverse[:3]]
    locked = [[a - k for a, k in zip(row, balance.kept_by_closing(row), strict=True)] for row in rows]
    each: list[Row] = [(x, y, m) for x, y, m in zip(*locked, strict=True)]
    asked: list[Row] = [
        (-x / force, -y / force, -m / force) for (x, y, m), force in zip(each, balance.forces, strict=True)
    ]
    spare = parts_spared(balance)
    names = element_names(fixture, hardware)
    need = most(walk.worst(*row) for row in asked)
    yield from written("the jaw force of its program", said["jaw"]["force"], need, spare * abs(need))
    force = need if query.jaw_force is None else arb(query.jaw_force)
    yield from written("the jaw force stated with it", said["jaw_force"], force, spare * abs(force))
    if (said["room"] is None) != (query.jaw_force is None):
        yield Finding(True, "the room of its jaw force is given without one, or missing with one")
    elif said["room"] is not None:
        yield from written("the room of its jaw force", said["room"], force - need, spare * abs(need))
    share = [force * own for own in balance.forces]
    total = most(walk.worst(*row) + own for row, own in zip(each, share, strict=True))
    yield from written("the largest force of a contact", said["contact"]["force"], total, spare * abs(total))
    none = [arb(0)] * len(names)
    for key, functions, own, worst in (("jaw", asked, none, need), ("contact", each, share, total)):
        yield from place_findings(said[key], walk, names, functions, own, worst, spare)


def fault_of_form(said: Any) -> str:
    """What an entry lacks, behind "the forces of its program"; empty where it lacks nothing."""
    if not isinstance(said, dict) or any(key not in said for key in KEYS):
        return f"do not have {', '.join(KEYS)}"
    if any(not isinstance(said[key], dict) or any(one not in said[key] for one in ASKED) for key in KEYS[:2]):
        return f"do not say {', '.join(ASKED)}"
    numbers = [said["jaw"]["force"], said["contact"]["force"], said["jaw_force"]]
    numbers += [] if said["room"] is None else [said["room"]]
    if any(isinstance(one, bool) or not isinstance(one, int | float) for one in numbers):
        return "are no numbers"
    return ""


def place_findings(
    said: dict[str, Any],
    walk: ForceWalk,
    names: Sequence[str],
    functions: Sequence[Row],
    own: Sequence[arb],
    worst: arb,
    spare: arb,
) -> Iterator[Finding]:
    """Whether a line, a tool and a contact are those of the worst value.

    Parameters
    ----------
    functions, own : of each contact, what the load does to it, and what it has without.
    """
    if said["line"] is None:
        return
    there = most(
        walk.worst(*row, 0.0, said["line"], said["tool"]) + held
        for name, row, held in zip(names, functions, own, strict=True)
        if name == said["element"]
    )
    if there < worst - spare * (1 + abs(worst)):
        yield Finding(
            True,
            f"T{said['tool']} in line {said['line']} is not where the program asks most of the "
            f"{said['element']}",
        )


def most(values: Iterator[arb]) -> arb:
    """The largest of some numbers, 0 or more."""
    out = arb(0)
    for value in values:
        out = out.max(value)
    return out


def element_names(fixture: Fixture, hardware: ToolkitRules) -> list[str]:
    """What each contact of a fixture stands on, as files name it."""
    names = list[str]()
    for peg in fixture.pegs:
        carrier = hardware.carriers[peg.carrier]
        place = f"{carrier.peg} {peg.hole}" if carrier.has_lattice else peg.hole
        names.append(carrier.noun if carrier in hardware.walls else place)
    return names
