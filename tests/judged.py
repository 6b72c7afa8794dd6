"""The steps of a verification that tests take one by one, each named here alone."""

from __future__ import annotations

from collections.abc import Sequence

from workhold import Fixture, Query
from workhold.fixels.toolkit import Toolkit
from workhold.model.search_report import Undecided
from workhold.verification.judging import Rank, rank
from workhold.verification.repeats import KnownFixtures
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.undecided import undecided_faults


def known_in(toolkit: Toolkit) -> KnownFixtures:
    """What has seen no fixture yet, and tells of each further one whether it is one of those before it."""
    return KnownFixtures(ToolkitRules(toolkit))


def place_in_order(fixture: Fixture, toolkit: Toolkit) -> Rank:
    """By what fixtures that are equally good are ordered."""
    return rank(fixture, ToolkitRules(toolkit))


def faults_of(entries: Sequence[Undecided], query: Query) -> list[str]:
    """What is wrong with undecided cases."""
    return list(undecided_faults(entries, query))
