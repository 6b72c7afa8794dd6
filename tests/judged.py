"""The steps of a verification that tests take one by one, each named here alone."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from workhold import Fixture, Query
from workhold.fixels.toolkit import Toolkit
from workhold.model.search_report import UndecidedCandidate
from workhold.verification.contacts import BallPose
from workhold.verification.judging import Rank, make_sort_key
from workhold.verification.repeats import KnownFixtures
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.undecided import find_undecided_faults


def rules_in(toolkit: Toolkit) -> ToolkitRules:
    """What holds of every fixture in a toolkit."""
    return ToolkitRules(toolkit)


def posed(*travels: float) -> BallPose:
    """A part that lies as it is drawn, and how far what moves has travelled."""
    return BallPose.from_turn_and_place(arb(0), arb(0), arb(0), *map(arb, travels))


def known_in(toolkit: Toolkit) -> KnownFixtures:
    """What has seen no fixture yet, and tells of each further one whether it is one of those before it."""
    return KnownFixtures(rules_in(toolkit))


def place_in_order(fixture: Fixture, toolkit: Toolkit) -> Rank:
    """By what fixtures that are equally good are ordered."""
    return make_sort_key(fixture, rules_in(toolkit))


def faults_of(entries: Sequence[UndecidedCandidate], query: Query) -> list[str]:
    """What is wrong with undecided cases."""
    return list(find_undecided_faults(entries, query))
