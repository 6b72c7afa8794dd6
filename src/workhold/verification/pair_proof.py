"""The proof of one fixture with two clamps.

The three locators, or a wall and one, alone fix the pose, and each clamp's tip is where its line meets its face. So the
five contact equations, in the pose and both travels, have one solution, and what is then asked of locators, clamps and both
clamps together is asked there. Where a fixture stands for all pairs of clamps of its seat, these are derived again as well
(``seat_clamps``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from attrs import evolve
from flint import arb, arb_mat

from workhold.model.fixture import Fixture, Pair
from workhold.model.query import Query
from workhold.verification.balls import largest
from workhold.verification.contacts import Contact, Pose
from workhold.verification.figures import Measure, parts_spared, written, written_numbers
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Hardware
from workhold.verification.outline import Outline
from workhold.verification.pair_balance import PairBalance, push_of, seat_of
from workhold.verification.pair_plate import PairRules, directions_of, line_of
from workhold.verification.placing import gap_findings, proven_places, written_pose
from workhold.verification.plate import LOCATORS, direction_of, in_holes
from workhold.verification.rules import HAIR, LEAST_PUSH, LEAST_SEAT, LEAST_SHARE, MOST_FORCE, NO_REACTION, SAME_FREEDOM
from workhold.verification.seat import Ratio, ratio_of
from workhold.verification.seat_clamps import SeatClamp, SeatPair, Standing, choices, pieces_apart
from workhold.verification.touching import touching_findings

__all__ = ["pair_findings", "pairs_at"]

NAMES = ("clamp 1", "clamp 2")
AT_EDGE = "a locator's force is exactly at the edge of what counts as none"


def pair_findings(
    fixture: Fixture, pair: Pair, contacts: Sequence[Contact], query: Query, rules: Hardware, measure: Measure
) -> Iterator[Finding]:
    """Everything that speaks against a fixture with two clamps, with its contacts in holes and on faces that there are."""
    assert isinstance(rules, PairRules)
    outline = measure.outline
    poses = [written_pose(fixture.pose, travel) for travel in (0.0, 0.0, 0.0, *pair.travels)]
    on_pegs = [k for k, contact in enumerate(contacts) if not contact.is_flush]
    named = [(rules.names[k], contacts[k], fixture.pegs[k].face) for k in on_pegs]
    yield from gap_findings(named, [poses[k] for k in on_pegs])
    zero, doubts = solved(fixture, contacts)
    yield from doubts
    if zero is not None:
        theta, x, y, *travels = zero
        poses = [Pose.of(theta, x, y, travel) for travel in (arb(0), arb(0), arb(0), *travels)]
    pose = poses[0]
    placed = [evolve(contact, hole=contact.place(there)) for contact, there in zip(contacts, poses, strict=True)]
    locators = [contact for contact in placed[:LOCATORS] if not contact.is_flush]
    yield from rules.flush_findings(fixture, contacts, pose, outline)
    for name, contact, there in zip(NAMES, contacts[LOCATORS:], poses[LOCATORS:], strict=True):
        yield from rules.clamp_findings(name, locators, contact, there, outline)
    for k in on_pegs:
        face = fixture.pegs[k].face
        yield from touching_findings(rules.names[k], placed[k], face, pose, outline, query.contact_margin)
    yield from apart_findings(contacts, placed, poses, rules)
    seat = seat_of(placed[:LOCATORS], pose)
    spanned = abs(seat.determinant) / measure.wrench_length
    words = f"the locators do not fix the pose: their wrenches have a determinant of only {number(spanned)}"
    yield from rule(spanned - LEAST_SEAT, words, words)
    first, second = (push_of(contact, pose, seat) for contact in placed[LOCATORS:])
    for name, push in zip(NAMES, (first, second), strict=True):
        yield from rule(
            push.push - LEAST_PUSH,
            f"{name} does not push the part: its share is {number(push.push)}",
            f"the push of {name} is exactly at its limit",
        )
        most = largest([abs(entry) for entry in push.taken])
        yield from rule(
            MOST_FORCE * push.push - most,
            f"{name} presses a locator with {number(most / push.push)} times its own force",
            f"the force of a locator under {name} is exactly at its limit",
        )
        yield from rule(
            NO_REACTION - push.alone,
            f"{name} holds the part without the other: its least share is {number(push.alone)}",
            f"whether {name} holds the part without the other is exactly at its limit",
        )
    ratio = ratio_of(first, second)
    if ratio is None:
        yield Finding(False, AT_EDGE)
        return
    points, normals = zip(*((contact.in_part(pose), contact.outward(pose)) for contact in placed), strict=True)
    balance = PairBalance(points, normals, seat, (first, second), ratio)
    loose = list(closure_findings(balance))
    yield from loose
    if loose:
        return
    yield from pair_numbers(pair, rules.names, balance)
    faces = rules.shared_faces(fixture, contacts)
    yield from written_numbers(fixture, rules.names, balance, measure.figures(placed, faces, pose, balance))
    if zero is None:
        return
    standing = Standing(query, rules, outline, in_holes(fixture)[0], locators, pose, seat)
    yield from stroke_findings(fixture, placed, zero[LOCATORS:], standing)
    if not rules.every:
        yield from best_findings(pair, balance, list(standing.pairs(directions_of(fixture))))
    elif pair.count != 1:
        yield Finding(True, f"it stands for {pair.count} pairs of clamps, and all are listed")


def solved(fixture: Fixture, contacts: Sequence[Contact]) -> tuple[list[arb] | None, list[Finding]]:
    """The proven pose and travels of a fixture, see :func:`proven_places`."""
    assert fixture.pair is not None
    travels = {
        f"place of the tip of {name} on its line": t for name, t in zip(NAMES, fixture.pair.travels, strict=True)
    }
    return proven_places(partial(pair_system, contacts), fixture.pose, travels, "all five faces")


def pair_system(contacts: Sequence[Contact], unknowns: arb_mat) -> tuple[arb_mat, arb_mat]:
    """Values (5 x 1) and Jacobian (5 x 5) of the contact equations on a box (5 x 1) of angle, x, y and both travels."""
    theta, x, y, *travels = unknowns.entries()
    pose = Pose.of(theta, x, y, arb(0))
    values, rows = [], []
    for number_, contact in enumerate(contacts):
        k = number_ - LOCATORS
        value, (*slopes, along) = contact.equation(pose if k < 0 else evolve(pose, travel=travels[k]))
        values.append(value)
        rows.append([*slopes, *(along if k == n else arb(0) for n in range(2))])
    return arb_mat(5, 1, values), arb_mat(rows)


def apart_findings(
    contacts: Sequence[Contact], placed: Sequence[Contact], poses: Sequence[Pose], rules: PairRules
) -> Iterator[Finding]:
    """Whether the clamps, from their holes to their tips, keep clear of each other."""
    one, other = (
        (tip.hole, contact.hole if rules.is_bolted else tip.hole)
        for contact, tip in zip(contacts[LOCATORS:], placed[LOCATORS:], strict=True)
    )
    apart = pieces_apart(one, other) - 2 * arb(rules.toolkit.clamp_radius)
    yield from rule(
        apart + HAIR,
        f"the clamps meet: they overlap by {number(-apart)} mm",
        "the clamps touch exactly at the edge of what is allowed",
    )


def closure_findings(balance: PairBalance) -> Iterator[Finding]:
    """Whether both clamps together press the part against all locators."""
    words = "the clamps do not hold the part: at no ratio of their forces are all locators pressed"
    freedom = balance.ratio.freedom
    if not freedom > 0:
        yield Finding(bool(freedom < 0) or bool(balance.margin < LEAST_SHARE), words)
        return
    yield from rule(
        balance.margin - LEAST_SHARE,
        f"the clamps do not hold the part: the closure margin is {number(balance.margin)}",
        "the closure margin is exactly at its limit",
    )


def pair_numbers(pair: Pair, names: Sequence[str], balance: PairBalance) -> Iterator[Finding]:
    """Whether the reactions and the ends of the ratio in the file are the derived ones."""
    part = parts_spared(balance)
    for name, said, derived in zip(names, pair.reactions, balance.reactions, strict=True):
        for clamp, value, force in zip(NAMES, said, derived, strict=True):
            yield from written(f"the force of {name} under {clamp}", value, force, part * (1 + abs(force)))
    yield from ratio_findings(pair.ratio, balance, part)


def ratio_findings(said: tuple[float, float], balance: PairBalance, part: arb) -> Iterator[Finding]:
    """Whether the ends of the ratio in the file are the derived ones, as well as they follow from reactions that are off."""
    ratio: Ratio = balance.ratio
    least = [abs(b) for _, b in balance.reactions[:LOCATORS] if abs(b) > NO_REACTION]
    loss = 1 + largest([1 / b for b in least]) if least else arb(1)
    yield from written("the lower end of its ratio", said[0], ratio.low, part * loss * (1 + ratio.low))
    if (ratio.high is None) != (said[1] == float("inf")):
        end = "has none" if ratio.high is None else f"is {number(ratio.high)}"
        yield Finding(True, f"the upper end of its ratio {end}, and the file says otherwise")
    elif ratio.high is not None:
        yield from written("the upper end of its ratio", said[1], ratio.high, part * loss * (1 + ratio.high))


def stroke_findings(
    fixture: Fixture, placed: Sequence[Contact], travels: Sequence[arb], standing: Standing
) -> Iterator[Finding]:
    """Whether the clamps are bolted in the holes of the least total travel that have a place together."""
    rules = standing.rules
    if not rules.is_bolted:
        return
    clamps = []
    for peg, contact in zip(fixture.pegs[LOCATORS:], placed[LOCATORS:], strict=True):
        line, direction = line_of(peg), direction_of(peg)
        push = push_of(contact, standing.pose, standing.seat)
        holes = list(standing.holes(contact, line, direction))
        clamps.append(SeatClamp(direction, line, peg.face, contact.hole, push, holes, True))
    total = -sum(travels, arb(0))
    for first, second, sure in choices(rules, standing.pegs, *clamps):
        less = total - HAIR - first.stroke - second.stroke
        if less < 0:
            continue
        words = f"{number(first.stroke + second.stroke)} mm of travel in all, not {number(total)}"
        yield Finding(sure and bool(less > 0), f"the clamps could be bolted with {words}")


def best_findings(pair: Pair, balance: PairBalance, pairs: Sequence[SeatPair]) -> Iterator[Finding]:
    """Whether a fixture stands for as many pairs as there are at its seat, and none of them is better."""
    sure = [one for one in pairs if one.sure]
    if not len(sure) <= pair.count <= len(pairs):
        yield Finding(True, f"it stands for {pair.count} pairs of clamps, and there are {len(sure)} at its seat")
    elif len(sure) < len(pairs):
        yield Finding(False, f"there are {len(sure)} to {len(pairs)} pairs of clamps at its seat")
    freedom, margin = balance.ratio.freedom, balance.margin
    freest = largest([freedom, *(one.freedom for one in sure)])
    worse = freest - freedom - SAME_FREEDOM - HAIR
    words = f"another pair of clamps at its seat has a freedom of {number(freest)} degrees, this one {number(freedom)}"
    yield from rule(-worse, words, words)
    rivals = [one.margin for one in sure if freest - one.freedom < SAME_FREEDOM - HAIR]
    widest = largest([margin, *rivals])
    words = f"an equally free pair of clamps at its seat has a closure margin of {number(widest)}, this one {number(margin)}"
    yield from rule(2 * HAIR - (widest - margin), words, words)


def pairs_at(fixture: Fixture, query: Query, rules: PairRules, outline: Outline) -> tuple[int, int] | None:
    """How many pairs of clamps there are at a fixture's seat, at least and at most; None where its place is not proven."""
    contacts = rules.contacts(fixture, outline)
    zero, _ = solved(fixture, contacts)
    if zero is None:
        return None
    pose, seat = Pose.of(zero[0], zero[1], zero[2], arb(0)), contacts[:LOCATORS]
    locators = [contact for contact in seat if not contact.is_flush]
    standing = Standing(query, rules, outline, in_holes(fixture)[0], locators, pose, seat_of(seat, pose))
    pairs = list(standing.pairs(directions_of(fixture)))
    return sum(one.sure for one in pairs), len(pairs)
