"""What speaks against a fixture.

Glossary
--------
slack : a number that a rule wants to be positive.
hair : see ``verification.tolerances``.

Drawings are made with round numbers, so that two faces are often exactly as far apart as two holes, or a contact is
exactly at the joint of two faces; and the coordinates of a drawing are rounded, which spoils such a coincidence by some
1e-13 mm in one direction or the other. A rule with its edge at the coincidence would be decided by that rounding. Therefore

- a gap or an opening is met when it is missed by no more than a hair;
- a contact at a tangent joint may lie up to a hair past that end of its face, at any other end it lies more than a hair
  inside;
- a peg may enter a face that runs alongside its own by no more than a hair.

The hair is part of the rule: an exact number, the same at every precision. With it in the slack, a rule holds when the whole
ball of the slack is positive, and is broken when the whole ball is negative. What is neither at the highest precision is
undecided.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import frozen
from flint import arb

__all__ = ["Finding", "number", "rule"]


@frozen
class Finding:
    """A rule that is broken (definite) or that cannot be shown to hold, with the reason in one sentence."""

    definite: bool
    reason: str


def rule(slack: arb, broken: str, edge: str) -> Iterator[Finding]:
    """Nothing when a slack is certainly positive, otherwise the finding in the words for its case."""
    if not slack > 0:
        definite = bool(slack < 0)
        yield Finding(definite, broken if definite else edge)


def number(value: arb) -> str:
    """The middle of a ball, for messages."""
    return f"{float(value.mid()):.3g}"
