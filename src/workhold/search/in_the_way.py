"""What of a program is in the way where it leaves no fixture: in words, with the line to look at first."""

from __future__ import annotations

from workhold.contact.problem import Frame, Problem
from workhold.contact.swept import keeps_of
from workhold.contact.trimming import most_in_the_way
from workhold.errors import InputError
from workhold.model.query import Query

__all__ = ["body_rule", "has_body_to_pass", "line_in_the_way", "program_rule", "stroke_rule"]


def line_in_the_way(query: Query) -> int | None:
    """The line of a query's program whose tool passes the longest stretch of places for pegs.

    None without a program, and where it passes none.
    """
    if query.program is None:
        return None
    try:
        problem = Problem.of(query.without_program)
    except InputError:
        return None
    carriers = Frame.of(query.toolkit, problem.diameter).carriers
    for locus, carrier in zip(problem.loci, carriers, strict=True):
        pieces, beyond = keeps_of(query, carrier)[0]
        line = most_in_the_way([feature.segment for feature in locus], pieces, beyond)
        if line is not None:
            return line
    return None


def program_rule(query: Query) -> str:
    """What a program asks, as the rule that takes contacts away.

    It reads such as "tools of the program, most in line 7".
    """
    line = line_in_the_way(query)
    return "tools of the program" + ("" if line is None else f", most in line {line}")


def has_body_to_pass(query: Query) -> bool:
    """Whether a clamp has a body, which its stroke gives it, that a program's tools may come too near to."""
    return query.program is not None and query.toolkit.moving.on is not None


def body_rule(query: Query) -> str:
    """What a program asks of the bodies of clamps, from the tip back to the hole."""
    return f"body of the {query.toolkit.moving.noun} clear of the program's tools"


def stroke_rule(query: Query, rule: str) -> str:
    """The rule on a clamp's stroke, with what a program asks of the body that the clamp then has."""
    return f"{rule}, {body_rule(query)}" if has_body_to_pass(query) else rule
