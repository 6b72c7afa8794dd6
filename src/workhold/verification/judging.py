"""Warnings and penalties of a fixture, and whether fixtures are listed in the right order.

Both are rules of docs/quality.md. Warnings and penalties are counted in balls. The file's numbers are
rounded, so a figure may lie on either side of its limit; then the ball contains both counts.

The order ("Which comes first"): fixtures that are unfit for a workshop come last. In the usual order a
warning, steps of the effective error and the angle come before figures (``verification.first_choice``). Every
figure but the last counts to two significant digits, the last to nine decimals. Equal fixtures are in the
order of types, holes, orientations and faces. Fixtures with a known seating come first, and warnings of the
seating count like those of quality. The rounding of a written figure may change its count, so a range around
each figure is used. The code of ``listing.ranking`` is not used.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate
from math import atan2, ceil, degrees, isinf, pi, radians, tau

from attrs import frozen
from flint import arb

from workhold.model.first_choice import list_ranking_figures
from workhold.model.fixture import Fixture, Peg
from workhold.model.quality import RANKED
from workhold.model.query import Query
from workhold.model.seating import Seating
from workhold.verification.ball_geometry import LineSide, Side
from workhold.verification.contacts import BallPose
from workhold.verification.first_choice import EffectiveJudge, classify_angle
from workhold.verification.listing import SeatingClaim
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.travel import (
    WAYS,
    count_quarter_turns,
    find_direction,
    list_directions,
    turn_hole_back,
)
from workhold.verification.tolerances import (
    CLOSE_READING,
    GENTLE_PEG,
    HAIR,
    LARGE_LOCATION_ERROR,
    MAIN_DIRECTION,
    NEAR_EDGE,
    PIN_MOVEMENT_LIMIT,
    PIN_STRESS_LIMIT,
    POINTS_PER_DECADE,
    SAME,
    SMALL_CAPTURE,
    SMALL_FACE,
    SMALL_FACE_POINTS,
    SQUARE_TILT,
    STRONG_PEG,
    STRONG_POINTS,
    TILTED_POINTS,
    UNFIT_CLOSURE,
    UNFIT_LOCATION_ERROR,
    WEAK_CLOSURE,
)

__all__ = [
    "find_main_direction",
    "find_order_faults",
    "compute_penalty",
    "make_sort_key",
    "compute_tilt",
    "count_warnings",
]


def find_main_direction(faces: Sequence[Side]) -> arb:
    """Return the main direction in degrees: that of the straight faces with most length parallel or square to
    them.

    Among about equal candidates the longest face decides, then the first. It is 0 (the drawing's x) if there
    is no straight face, or if different directions have about the same length. Candidates are compared in
    doubles.
    """
    lines = [side for side in faces if isinstance(side, LineSide)]
    if not lines:
        return arb(0)
    rough = [degrees(atan2(float(s.tangent[1].mid()), float(s.tangent[0].mid()))) % 90.0 for s in lines]
    lengths = [float(line.length.mid()) for line in lines]
    # Once more a quarter turn below and above, so that 0 and 90 degrees are neighbours.
    around = sorted(
        (angle + turn, length)
        for angle, length in zip(rough, lengths, strict=True)
        for turn in (-90.0, 0.0, 90.0)
    )
    places, sums = [angle for angle, _ in around], [0.0, *accumulate(length for _, length in around)]

    totals = [
        sums[bisect_right(places, angle + SQUARE_TILT)] - sums[bisect_left(places, angle - SQUARE_TILT)]
        for angle in rough
    ]
    rivals = [k for k, sum_ in enumerate(totals) if sum_ >= MAIN_DIRECTION * max(totals)]
    first = max(rivals, key=lambda k: round(lengths[k], 9))
    if any(abs((rough[k] - rough[first] + 45.0) % 90.0 - 45.0) >= 2 * SQUARE_TILT for k in rivals):
        return arb(0)
    along = lines[first].tangent
    return arb.atan2(along[1], along[0]) * 180 / arb.pi()


def compute_tilt(pose: BallPose, direction: arb) -> arb:
    """Return the angle in degrees between the part's main direction and the nearest axis of the jaws.

    It is 0 up to the limit ``SQUARE_TILT``. ``direction`` is the main direction in degrees in the part's
    frame.
    """
    angle = pose.theta * 180 / arb.pi() + direction
    off = abs(angle - 90 * round(float(angle.mid()) / 90))
    within = SQUARE_TILT - off
    return off if within < -HAIR else arb(0) if within > HAIR else off.union(arb(0))


def count_if_above(value: arb, limit: arb | float, part: arb) -> tuple[int, int]:
    """Return (least, greatest) possible count, each 0 or 1, of a value that counts if it is above a limit.

    ``part`` is the relative error of the value; ``HAIR`` is its absolute error.
    """
    spare = HAIR + part * abs(value)
    above = value - limit
    return int(bool(above > spare)), int(not above < -spare)


def sum_ranges(pairs: Sequence[tuple[int, int]]) -> arb:
    """Return the sum of counts, each given as (least, greatest), as a ball that holds every possible sum."""
    low, high = (arb(sum(ends)) for ends in zip(*pairs, strict=True))
    return low.union(high) if low < high else low


def count_warnings(
    figures: Mapping[str, arb],
    edges: Sequence[arb],
    off: arb,
    jaw_force: float | None,
    part: arb,
    bending: tuple[float, float] = (PIN_STRESS_LIMIT, PIN_MOVEMENT_LIMIT),
    states_bending: bool = True,
) -> arb:
    """Return the number of warnings of a fixture, as a ball that contains every number that is possible
    within rounding.

    Warnings are: each contact near an edge, a weak closure, a strong peg, and a large location error. At a
    known jaw force there are three more: a peg that loses contact, a large pin stress, a large movement of
    the part by bent pins.

    Parameters
    ----------
    figures : figures of quality by key.
    edges : distances in mm of contacts from edges.
    off : sum of the tolerances in mm.
    jaw_force : in N; None if none is given.
    part : relative error of the file's figures.
    bending : limits of pin stress in MPa and of that movement in mm.
    states_bending : whether the file states how far pegs bend. An older file does not, and its number of
        warnings may or may not include those of bending.
    """
    pairs = [count_if_above(-edge, -NEAR_EDGE, part) for edge in edges]
    pairs.append(count_if_above(-figures["closure_margin"], -WEAK_CLOSURE, part))
    pairs.append(count_if_above(figures["clamp_amplification"], STRONG_PEG, part))
    pairs.append(count_if_above(figures["location_error"], LARGE_LOCATION_ERROR * off, part))
    if jaw_force is not None and "jaw_force_needed" in figures:
        pairs.append(count_if_above(figures["jaw_force_needed"], arb(jaw_force) * (1 + arb(HAIR)), part))
    for key, limit in zip(("pin_stress", "pin_movement"), bending, strict=True):
        if jaw_force is not None and key in figures:
            low, high = count_if_above(figures[key], limit, part)
            pairs.append((low if states_bending else 0, high))
    return sum_ranges(pairs)


def compute_penalty(figures: Mapping[str, arb], off: arb, diameter: float, part: arb) -> arb:
    """Return the sum of the penalty points for location error, tilt, a strong peg and a small face.

    Points for the location error are rounded up. ``off`` is the sum of the tolerances and ``diameter`` the
    part's, in mm; ``part`` is the relative error of the figures.
    """
    points = [(0, 0)]
    if off > 0:
        steps = POINTS_PER_DECADE * (figures["location_error"] / off).log() / arb(10).log()
        # A step is worth ten times its share of the error, and a little.
        spare = 2 * HAIR + 10 * float(part.mid())
        points = [(ceil(float(steps.lower()) - spare), ceil(float(steps.upper()) + spare - 2 * HAIR))]
    weights = (
        (count_if_above(figures["tilt"], SQUARE_TILT / 2, part), TILTED_POINTS),
        (count_if_above(figures["clamp_amplification"], GENTLE_PEG, part), STRONG_POINTS),
        (count_if_above(-figures["smallest_face"], -SMALL_FACE * arb(diameter), part), SMALL_FACE_POINTS),
    )
    return sum_ranges([*points, *((weight * low, weight * high) for (low, high), weight in weights)])


# Files have twelve significant digits.
DIGITS = 1e-12
# Beside them, for numbers near 0.
LEAST = 1e-15
# What a number is counted as at least and at most.
Range = tuple[float, float]
# Type, directions and holes, orientation in radians, and faces, which order fixtures that are equally good.
Rank = tuple[list[int], float, list[int]]
MORE_IS_BETTER = {figure.key: figure.more_is_better for figure in RANKED}


@frozen(eq=False)
class OrderJudge:
    """The sort keys that precede the figures in the usual order of a query."""

    query: Query
    effective: EffectiveJudge

    def rank_first_keys(self, fixture: Fixture, figures: Mapping[str, float]) -> list[Range]:
        """Return three sort keys, each as (least, greatest): has a warning (0 or 1), steps above the least
        effective error, class of the angle.
        """
        warned = float(figures.get("warnings", 0.0) > HAIR)
        low, high = classify_angle(fixture.pose.theta_deg)
        return [(warned, warned), self.effective.count_error_steps(fixture), (low, high)]

    def find_least_error_fault(self, fixtures: Sequence[Fixture], is_whole: bool) -> str:
        """Return a sentence if the written least effective error is missing or wrong; "" if it is right.

        ``is_whole`` tells that all fixtures found are listed. Otherwise an unlisted fixture may have the
        least error, so only too large a written value is a fault.
        """
        if not fixtures:
            return ""
        least = self.effective.least
        if least is None:
            return "the least effective error, from which steps of the order count, is missing"
        off = self.query.tolerance.peg + self.query.tolerance.face
        ranked = [(enclose_unfit_flag(fixture, off), fixture) for fixture in fixtures]
        classes = [
            (bad[0] + (bad[0] != bad[1]) / 2, fixture.quality.get("warnings", 0.0) > HAIR)
            for bad, fixture in ranked
        ]
        said, best = round(least * 1e9), min(classes)
        if best[0] % 1:
            # Whether the first is fit is a matter of the last digit.
            return ""
        errors = [
            self.effective.compute_effective_error(fixture)
            for one, (_, fixture) in zip(classes, ranked, strict=True)
            if one == best
        ]
        low, high = (min(ends) for ends in zip(*errors, strict=True))
        if said > high or (is_whole and said < low):
            return (
                f"the least effective error is given as {least:.9f} mm, and that of the fixtures listed is "
                f"{high / 1e9:.9f} mm"
            )
        return ""


def find_order_faults(
    fixtures: Sequence[Fixture],
    query: Query,
    hardware: ToolkitRules,
    least: float | None = None,
    is_whole: bool = False,
    is_chosen: bool = False,
    ahead: int = 0,
) -> Iterator[str]:
    """Yield one sentence for the first fixture that is out of order.

    Yields nothing if a figure that decides the order is not written, or if a fixture has unknown carriers.

    Parameters
    ----------
    least : least effective error in mm among all fixtures found, as written; None if it is not written.
    is_whole : whether all fixtures found are listed.
    is_chosen : whether somebody chose the listed fixtures, so that the best may be missing.
    ahead : how many of the first fixtures stand in another order, that of a figure of bending.
    """
    usual = query.without_seating
    if any(key not in fixture.quality for fixture in fixtures for key in list_ranking_figures(usual.rank_by)):
        return
    if query.has_house_order and not all(map(hardware.has_carriers, fixtures)):
        # What stands on something else is refuted, and no effective error of it is known.
        return
    judge = OrderJudge(query, EffectiveJudge(query, least)) if query.has_house_order else None
    if judge is not None and (fault := judge.find_least_error_fault(fixtures, is_whole)):
        yield fault
        return
    off = query.tolerance.peg + query.tolerance.face
    fixtures = fixtures[ahead:]

    def make_key(fixture: Fixture, figures: Mapping[str, float], asked: Query) -> list[Range]:
        """Return the sort key of a fixture with these figures, as ranges, in the order of the query
        ``asked``.
        """
        first = judge.rank_first_keys(fixture, figures) if judge is not None and asked.has_house_order else []
        return [
            enclose_unfit_flag(fixture, off),
            *first,
            *list_ranked_ranges(figures, list_ranking_figures(asked.rank_by)),
        ]

    rows = [make_key(fixture, fixture.quality, usual) for fixture in fixtures]
    stated = [collect_stated_figures(fixture) for fixture in fixtures]
    seated = [
        None if figures is None else [*make_key(fixture, figures, query), *row[1:]]
        for fixture, row, figures in zip(fixtures, rows, stated, strict=True)
    ]
    count = sum(one is not None for one in seated)
    if any(one is None for one in seated[:count]):
        yield "the seating of a fixture is stated, but not that of all before it"
        return
    # Of a search that was interrupted those come first whose seating was worked out by then.
    whole = count == query.seating and not ahead
    if whole and any(is_better(row, first) for first in rows[:count] for row in rows[count : count + 1]):
        contrast = "but without it is better than one before it that has"
        yield f"fixture {count + 1} has no seating stated, {contrast}"
    ranking = query.rank_by
    for place in range(1, len(rows)):
        one, before = seated[place], seated[place - 1]
        if before is not None and one is None:
            ranking = usual.rank_by
            continue
        better = is_better(one or rows[place], before or rows[place - 1])
        if better:
            yield f"fixture {ahead + place + 1} is better than the one before it, by {', '.join(ranking)}"
            return
        if better is None and is_earlier(fixtures[place], fixtures[place - 1], hardware):
            yield (
                f"fixture {ahead + place + 1} is as good as the one before it, and comes before it by type, holes "
                "and pose"
            )
            return
    # That which has the least error stands no step above it, so neither does the first.
    is_chosen = is_chosen or ahead > 0
    is_bare = judge is not None and least is not None and count == 0 and bool(fixtures) and not is_chosen
    if is_bare and judge is not None and judge.effective.count_error_steps(fixtures[0])[0] > 0:
        yield f"the least effective error is given as {least:.9f} mm, a step below that of the first fixture"


def collect_stated_figures(fixture: Fixture) -> dict[str, float] | None:
    """Return the figures of quality and seating by key, seating warnings added
    to "warnings"; None without seating.
    """
    claim: SeatingClaim | None = fixture.seating
    if claim is None:
        return None
    figures = {**fixture.quality, **claim.seating.figures}
    return figures | {"warnings": figures.get("warnings", 0.0) + count_seating_warnings(claim.seating)}


def count_seating_warnings(seating: Seating) -> int:
    """Return the number of warnings that a seating counts as: two for a small
    capture opening, one for a close reading.
    """
    opening, reading = seating.capture_opening, seating.find_least_reading()
    small = opening is not None and opening < SMALL_CAPTURE
    return 2 * small + (reading is not None and round(reading, 9) < CLOSE_READING)


def list_ranked_ranges(figures: Mapping[str, float], ranking: Sequence[str]) -> Iterator[Range]:
    """Yield (least, greatest) of the rounded sort value of each figure, in the order of ``ranking``.

    Smaller sorts first: figures where more is better have their sign reversed.
    """
    for place, key in enumerate(ranking, 1):
        value = -figures[key] if MORE_IS_BETTER[key] else figures[key]
        if isinf(value):
            yield value, value
            continue
        spare = DIGITS * abs(value) + LEAST
        if place == len(ranking):
            yield round(value - spare, 9), round(value + spare, 9)
        elif abs(value) <= HAIR:
            # Nothing has no digits.
            yield 0.0, 0.0
        else:
            yield float(f"{value - spare - HAIR:.1e}"), float(f"{value + spare + HAIR:.1e}")


def is_earlier(one: Fixture, other: Fixture, hardware: ToolkitRules) -> bool:
    """Return whether ``one`` certainly comes before ``other``, given that both fixtures are equally good."""
    (holes, angle, faces), (others, angle_of_other, faces_of_other) = (
        make_sort_key(fixture, hardware) for fixture in (one, other)
    )
    if abs(angle - angle_of_other) > SAME:
        return (holes, angle) < (others, angle_of_other)
    return (holes, faces) < (others, faces_of_other)


def make_sort_key(fixture: Fixture, hardware: ToolkitRules) -> Rank:
    """Return the sort key of equally good fixtures: (type, directions and holes; angle in radians; faces).

    Without a wall and with one moving carrier, the fixture is first turned so that its clamp pushes along -x.
    Then columns are counted from the first peg of each carrier, and rows from the lowest row of all. If both
    jaws are equal and have equally many pegs, a fixture whose angle is half a turn or more is turned back by
    half a turn. All other fixtures are sorted by the written columns and rows of their holes.
    """
    ways = [list(WAYS).index(name) for name in list_directions(fixture)]
    numbers = [hardware.toolkit.types.index(fixture.type), *ways]
    theta = radians(fixture.pose.theta_deg)
    if len(ways) > 1 or hardware.walls:
        pegs = list[Peg]()
        for carrier in hardware.carriers.values():
            there = [peg for peg in fixture.pegs if peg.carrier == carrier.name]
            pegs += sorted(there, key=make_peg_key) if carrier in hardware.lattices else there
        placed = [peg for peg in pegs if hardware.carriers[peg.carrier].contact.is_placed]
        holes = [[getattr(peg, noun) for peg in placed] for noun in ("column", "row")]
        if hardware.jaw is not None:
            # Where along a jaw with ends the pegs stand makes no difference.
            holes[0] = [column - min(holes[0]) for column in holes[0]]
        return [*numbers, *holes[0], *holes[1]], (theta + SAME) % tau - SAME, [peg.face for peg in pegs]
    groups = [[peg for peg in fixture.pegs if peg.carrier == one.name] for one in hardware.lattices]
    clamps = [peg for peg in fixture.pegs if find_direction(peg)]
    turns = count_quarter_turns(fixture.direction) if fixture.direction else 0
    alike = len(groups) > 1 and len(groups[0]) == len(groups[1]) and hardware.half_turns
    if alike and (theta + SAME) % tau >= pi:
        turns, groups = 2, groups[::-1]
    seen = [
        [(*turn_hole_back(turns, peg.column, peg.row), peg.face) for peg in group]
        for group in (*groups, clamps)
        if group
    ]
    lowest, places = min(row for part in seen for _, row, _ in part), list[tuple[int, int, int]]()
    for part in seen:
        first = min(column for column, *_ in part)
        places += sorted((column - first, row - lowest, face) for column, row, face in part)
    columns, rows, faces = (list(each) for each in zip(*places, strict=True))
    return [*numbers, *columns, *rows], (theta - turns * pi / 2 + SAME) % tau - SAME, faces


def make_peg_key(peg: Peg) -> tuple[int, int, int]:
    """Return the sort key of pegs of one carrier."""
    return peg.column, peg.row, peg.face


def enclose_unfit_flag(fixture: Fixture, off: float) -> Range:
    """Return (least, greatest) of a number that is 1.0 for a fixture unfit for a workshop and 0.0 for a fit
    one.

    The two numbers are equal unless rounding decides; they are (0.0, 1.0) where the file lacks the figures.
    ``off`` is the sum of the tolerances of peg and face, in mm.
    """
    margin, error = (fixture.quality.get(key) for key in ("closure_margin", "location_error"))
    if margin is None or error is None:
        return 0.0, 1.0
    beyond = max(UNFIT_CLOSURE - margin, error - UNFIT_LOCATION_ERROR * off)
    spare = HAIR + DIGITS * error
    return float(beyond > spare), float(beyond >= -spare)


def is_better(one: Sequence[Range], other: Sequence[Range]) -> bool | None:
    """Return whether the sort key ``one`` is before ``other``; None if they are equal.

    The first entry decides at which the ranges are not one and the same number. True means that the range of
    ``one`` is certainly less there; False that it is not.
    """
    for (low, high), (least, most) in zip(one, other, strict=True):
        if high < least:
            return True
        if not low == high == least == most:
            return False
    return None
