"""What speaks against a fixture.

Glossary
--------
slack : a number that a rule wants to be positive.
definite : the slack's ball lies so far on the wrong side that the rounding of the file's own numbers cannot be the cause.

A proof needs the whole ball of the slack on the right side, without any tolerance. A refutation needs it on the wrong side
by more than a tolerance: an exact coincidence, such as a contact at a tangent joint, is spoilt by the rounding of the
drawing's coordinates, and whether it holds is nothing that more digits decide. What is neither is undecided.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import frozen
from flint import arb

__all__ = ["AGREEMENT", "COINCIDENCE", "Finding", "number", "rule"]

# Lengths in mm by which rounding may spoil an exact coincidence.
COINCIDENCE = 1e-9
# Numbers written in a file agree with the derived ones to this: mm, degrees, or a part of the force.
AGREEMENT = 1e-6


@frozen
class Finding:
    """A rule that is broken (definite) or that cannot be shown to hold, with the reason in one sentence."""

    definite: bool
    reason: str


def rule(slack: arb, broken: str, edge: str, tolerance: float = COINCIDENCE) -> Iterator[Finding]:
    """Nothing when a slack is certainly positive, otherwise the finding in the words for its case."""
    if slack > 0:
        return
    definite = bool(slack < -tolerance)
    yield Finding(definite, broken if definite else edge)


def number(value: arb) -> str:
    """The middle of a ball, for messages."""
    return f"{float(value.mid()):.3g}"
