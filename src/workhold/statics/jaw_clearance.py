"""The clearance between the tools of a program and a vise with flat jaws, and places of parallels clear of
the tools.

A tool is clear of a body of the vise where, at heights up to the body's top, its cylinders keep the program's
clearance from the body's box.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from math import ceil, inf

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans, find_swept_below
from workhold.conventions import GAP_SLACK
from workhold.errors import join_words
from workhold.fixels.jaw_pair import JawPair
from workhold.geometry.segment import Box
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.pose import Pose
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.vise_bodies import ViseBody, find_stop_level, list_parallel_boxes, list_vise_bodies
from workhold.units import Unit

__all__ = [
    "ToolNearVise",
    "describe_left_out",
    "describe_tools_in_the_way",
    "find_nearest_to_vise",
    "find_tool_in_the_way",
    "find_tools_below",
    "join_advice",
    "list_bodies_around",
    "list_vise_sentences",
    "place_parallels",
]

Array = NDArray[np.float64]


@frozen
class ToolNearVise:
    """The place where a tool comes nearest to a body of the vise.

    Parameters
    ----------
    distance : in mm; -inf where the tool runs into the body.
    line, tool : line of the program, and tool number.
    body : name of the body, such as "work stop".
    """

    distance: float
    line: int
    tool: int
    body: str


def list_bodies_around(fixture: Fixture, query: Query) -> list[ViseBody]:
    """Return the bodies of the vise around a fixture between flat jaws; [] for another fixture."""
    jaws, hold = query.toolkit.flat_jaws, fixture.hold
    if jaws is None or not isinstance(hold, JawHold):
        return []
    level = find_stop_level(query.workpiece, jaws, hold, fixture.pose)
    return list_vise_bodies(jaws, hold, query.part_height, level)


def move_into_part(pose: Pose, points: Array) -> Array:
    """Return points (N, 2) of the vise's frame in the part's coordinates, in mm."""
    x, y = pose.inverse.apply(points[:, 0], points[:, 1])
    return np.column_stack([x, y])


def list_approaches(program: Program, bodies: Iterable[ViseBody], pose: Pose) -> list[ToolNearVise]:
    """Return for each body the place where a tool comes nearest to it. Bodies above which all tools stay are
    left out.
    """
    out = []
    for body in bodies:
        swept = find_swept_below(program, body.top)
        if len(swept):
            corners = move_into_part(pose, np.array(body.box.corners))
            out.append(ToolNearVise(*swept.find_reach_to_box(corners), body.name))
    return out


def find_nearest_to_vise(program: Program, bodies: Iterable[ViseBody], pose: Pose) -> ToolNearVise | None:
    """Return the place where a tool comes nearest to any of the bodies; None if no tool comes down to one."""
    return min(list_approaches(program, bodies, pose), key=lambda one: one.distance, default=None)


def find_tool_in_the_way(program: Program, bodies: Iterable[ViseBody], pose: Pose) -> ToolNearVise | None:
    """Return the place where a tool comes too near the first body that is not clear; None if all are clear."""
    return next(
        (
            one
            for one in list_approaches(program, bodies, pose)
            if one.distance < program.clearance - GAP_SLACK
        ),
        None,
    )


def find_tools_below(program: Program) -> tuple[float, int, int] | None:
    """Return (height in mm, line, tool) of the lowest place of a tool's tip; None where it is not below 0."""
    moves = program.moves
    lowest = np.minimum(moves.start[:, 2], moves.end[:, 2])
    if not len(lowest) or lowest.min() >= 0.0:
        return None
    row = int(lowest.argmin())
    return float(lowest[row]), int(moves.line[row]), int(moves.tool[row])


def place_parallels(program: Program, jaws: JawPair, hold: JawHold, pose: Pose) -> JawHold | None:
    """Return a hold with its parallels moved clear of the tools that come through the part.

    Each stands beside its jaw or as little away from it as necessary, by whole millimetres if possible, and
    within its half of the opening. None if there is no clear place.
    """
    swept = find_swept_below(program, 0.0)
    if not hold.parallels or not len(swept):
        return hold
    offsets = []
    for box, is_far in zip(list_parallel_boxes(jaws, hold), (False, True), strict=True):
        corners = move_into_part(pose, np.array(box.corners))
        if swept.find_reach_to_box(corners)[0] >= program.clearance - GAP_SLACK:
            offsets.append(0.0)
            continue
        blocked = list_blocked_places(swept, program.clearance, box, pose)
        # Towards the other jaw, y grows or falls.
        ways = [(-high, -low) for low, high in blocked] if is_far else blocked
        found = find_free_place(ways, hold.opening / 2 - box.height)
        if found is None:
            return None
        offsets.append(found)
    return evolve(hold, parallel_offsets=(offsets[0], offsets[1]))


def list_blocked_places(
    swept: SweptSpans, clearance: float, box: Box, pose: Pose
) -> list[tuple[float, float]]:
    """Return open intervals of moves along y, in mm, by which a box would come too near the swept space.

    At the ends of the box, along x, a place that is only just clear may count as blocked.
    """
    low, high, reach = swept.bound_strip(pose, box.x0, box.x1, clearance)
    rows = np.column_stack([low - reach - box.y1, high + reach - box.y0])
    return [(float(one), float(other)) for one, other in rows]


def find_free_place(blocked: Iterable[tuple[float, float]], most: float) -> float | None:
    """Return the least number from 0 to ``most`` in none of the open intervals; None without one.

    The next whole number is taken instead where it is free as well.

    >>> find_free_place([(-1.0, 2.5), (2.0, 3.2)], 9.0), find_free_place([(-1.0, 3.2), (3.5, 9.0)], 20.0)
    (4.0, 3.2)
    >>> find_free_place([(-1.0, 3.2)], 3.0) is None
    True
    """
    some = sorted(blocked)

    def is_free(place: float) -> bool:
        """Return whether a place is in no interval, and not too far."""
        return place <= most and not any(low + GAP_SLACK < place < high - GAP_SLACK for low, high in some)

    places = sorted({0.0, *(high for _, high in some if high > 0.0)})
    found = next((place for place in places if is_free(place)), None)
    if found is None:
        return None
    whole = float(ceil(found - GAP_SLACK))
    return whole if is_free(whole) else found


def name_tool(program: Program, tool: int) -> str:
    """Return a tool's number with its name where it has one, such as "T3 (drill)"."""
    known = program.tools[tool].name if tool in program.tools else ""
    return f"T{tool}{f' ({known})' if known else ''}"


def list_worst(near: Iterable[ToolNearVise]) -> list[ToolNearVise]:
    """Return for each body's name the approach whose line most often comes too near it. The most frequent
    body comes first.
    """
    by_body = dict[str, Counter[int]]()
    first = dict[tuple[str, int], ToolNearVise]()
    for one in near:
        by_body.setdefault(one.body, Counter())[one.line] += 1
        first.setdefault((one.body, one.line), one)
    order = sorted(by_body, key=lambda body: -by_body[body].total())
    lines = {body: min(by_body[body], key=lambda line: (-by_body[body][line], line)) for body in order}
    return [first[body, lines[body]] for body in order]


def add_article(body: str) -> str:
    """Return the name of a body of the vise with its article, "a" if there are two of it, else "the"."""
    return f"a {body.split()[-1]}" if body.endswith(("jaw", "parallel")) else f"the {body}"


def describe_tools_in_the_way(near: Iterable[ToolNearVise], program: Program) -> str:
    """Return a clause that names each line and tool that comes too near, with the bodies concerned."""
    together = dict[tuple[int, int, str], list[str]]()
    for one in list_worst(near):
        into, kept = "runs {tool} into {bodies}", ""
        if one.distance > 0.0:
            into = f"brings {{tool}} within {one.distance:.3g} mm of {{bodies}}"
            kept = f", where {program.clearance:g} mm are to be kept"
        together.setdefault((one.line, one.tool, into + kept), []).append(add_article(one.body))
    said = [
        words.format(tool=name_tool(program, tool), bodies=join_words(list(dict.fromkeys(bodies))))
        for (_, tool, words), bodies in together.items()
    ]
    lines = [
        f"line {line} of the program {words}" for (line, _, _), words in zip(together, said, strict=True)
    ]
    return join_words(lines)


def describe_left_out(near: Sequence[ToolNearVise], program: Program) -> str:
    """Return a sentence on the set-ups that are dropped because a tool comes too near the vise."""
    count = len(near)
    verb = "set-up is" if count == 1 else "set-ups are"
    return f"{count} {verb} left out: {describe_tools_in_the_way(near, program)}."


def join_advice(near: Iterable[ToolNearVise], jaws: JawPair, program: Program) -> str:
    """Return a sentence with a remedy for each body that tools come too near, in the order of
    :func:`list_worst`.
    """
    said = dict.fromkeys(suggest_remedy(one.body, jaws, program) for one in list_worst(near))
    words = "; or ".join(said)
    return f"{words[:1].upper()}{words[1:]}."


def suggest_remedy(body: str, jaws: JawPair, program: Program) -> str:
    """Return a clause with a remedy for tools that come too near a body of the vise."""
    match body:
        case "work stop" if len(jaws.stops) > 1:
            return "take the stop away"
        case "work stop":
            other = "right" if jaws.stops == ("left",) else "left"
            return f"put the stop at the {other} end, or take it away"
        case "parallel":
            taken = " (taken to be)" if jaws.parallel_thickness is None else ""
            thick = jaws.compute_parallel_thickness(inf)
            return f"take parallels thinner than the {thick:g} mm{taken} that they have"
        case "bed of the vise":
            lowest = find_tools_below(program)
            deep = 0.0 if lowest is None else -lowest[0]
            return f"take parallels higher than {deep:g} mm, by which tools come through the part"
    if jaws.height is None:
        return "say how high the jaws are, as tools beside jaws of any height run into them"
    return "lift the part with higher parallels"


def list_vise_sentences(fixture: Fixture, query: Query, unit: Unit) -> list[str]:
    """Return sentences on how far tools cut through a part between flat jaws, and on the bodies that they
    come nearest to; [] without a program.
    """
    said = describe_tools_below(fixture, query, unit), describe_nearest(fixture, query, unit)
    return [sentence for sentence in said if sentence]


def describe_nearest(fixture: Fixture, query: Query, unit: Unit) -> str:
    """Return a sentence on the place where a tool comes nearest to the vise.

    It is "" without a program, and if no tool comes down to the vise.
    """
    if query.program is None:
        return ""
    near = find_nearest_to_vise(query.program, list_bodies_around(fixture, query), fixture.pose)
    if near is None:
        return ""
    return (
        f"Nearest to the vise comes {name_tool(query.program, near.tool)} in line {near.line}: "
        f"{unit.format_length(near.distance)} from "
        f"{add_article(near.body) if near.body == 'parallel' else f'the {near.body}'}."
    )


def describe_tools_below(fixture: Fixture, query: Query, unit: Unit) -> str:
    """Return a sentence on how far a tool comes through a part between flat jaws, and on the bodies that it
    clears.

    It is "" without a program, and where no tool comes below the part.
    """
    hold, lowest = fixture.hold, None if query.program is None else find_tools_below(query.program)
    if not isinstance(hold, JawHold) or lowest is None or query.program is None:
        return ""
    height, line, tool = lowest
    said = (
        f"{name_tool(query.program, tool)} comes {unit.format_length(-height)} below the part in line {line}"
    )
    if not hold.parallels:
        return f"{said}, beside the bed of the vise."
    left = hold.parallels + height
    over = f"{unit.format_length(left)} above the bed" if left > 0 else "beside the bed"
    return f"{said}, clear of the parallels and {over}."
