"""The verification of a whole result, and the proof of each of its fixtures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from math import isnan
from pathlib import Path
from typing import Literal

from attrs import field, frozen
from flint import arb, ctx

from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.quality import PIN_KEYS
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.verification.account import find_account_faults, find_seat_faults
from workhold.verification.ball_geometry import PRECISIONS, ArcSide, LineSide, compute_norm
from workhold.verification.bending.checking import list_unchecked, rule_on_bendings
from workhold.verification.contacts import Balance, BallContact, BallPose, judge_closure, select_outline_for
from workhold.verification.figures import FigureMeasure, find_missing_figure, judge_written_numbers
from workhold.verification.flat_jaws import JawJudge
from workhold.verification.force_walk import judge_program_forces
from workhold.verification.judging import find_order_faults
from workhold.verification.listing import WrittenListing, collect_claims, read_listing
from workhold.verification.pins import make_beams
from workhold.verification.placing import (
    enclose_written_pose,
    find_broken_restriction,
    judge_gaps,
    prove_pose,
)
from workhold.verification.repeats import KnownFixtures, PartRotations, find_pattern_faults
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seat import SeatBalance
from workhold.verification.seat_clamps import SeatOnPlate
from workhold.verification.seating import SeatingJudge
from workhold.verification.stock_walk import find_stock_faults
from workhold.verification.strapped import StrapJudge
from workhold.verification.tolerances import AGREEMENT, Finding, format_middle, judge_slack
from workhold.verification.tool_walk import find_program_fault
from workhold.verification.touching import judge_touching

__all__ = [
    "Judge",
    "Ruling",
    "Unproven",
    "Verdict",
    "Verification",
    "ignore_progress",
    "list_not_shown",
    "verify",
    "verify_file",
    "verify_fixture",
    "verify_listing",
]

Verdict = Literal["proven", "refuted", "undecided"]


@frozen
class Ruling:
    """The verdict on a fixture.

    Parameters
    ----------
    verdict : "proven" when every rule holds, "refuted" when one is broken, "undecided" otherwise.
    reason : one sentence for a fixture that is not proven, empty for one that is.
    bits : the precision in bits at which it was decided, or the highest tried.
    """

    verdict: Verdict
    reason: str
    bits: int


def verify_fixture(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, contact_margin: float = 0.0
) -> Ruling:
    """Return the ruling on one fixture: proven, refuted or undecided, from workpiece, toolkit, pegs and faces
    alone.

    Parameters
    ----------
    fixture : as a result lists it; its floats are taken as the rational numbers they are.
    contact_margin : smallest distance in mm from a contact to the end of its contact feature.
    """
    return Judge(Query(workpiece, toolkit, contact_margin=contact_margin)).rule_on(fixture)


@frozen(eq=False)
class Judge:
    """Judge of fixtures that a query asks for, which proves or refutes each; see :func:`verify_fixture`.

    Parameters
    ----------
    query : what is asked.
    measures : figure measures made so far, by precision in bits.
    """

    query: Query
    measures: dict[int, FigureMeasure] = field(factory=dict, init=False)

    @cached_property
    def hardware(self) -> ToolkitRules:
        return ToolkitRules.from_query(self.query)

    @cached_property
    def diameter(self) -> float:
        """The diameter of the part, in mm."""
        return measure_outline_diameter(self.query.workpiece)

    @cached_property
    def wrench_length(self) -> float:
        """L of the wrenches in mm: half the part's diameter plus the largest peg radius."""
        return self.diameter / 2 + self.hardware.largest_radius

    def rule_on(self, fixture: Fixture) -> Ruling:
        """Return the ruling on one fixture, at the lowest precision that decides it."""
        ruling = Ruling("undecided", "", 0)
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                ruling = self.rule_at_precision(bits, fixture)
            if ruling.verdict != "undecided":
                break
        return ruling

    def rule_at_precision(self, bits: int, fixture: Fixture) -> Ruling:
        """Return the ruling on one fixture at this precision in bits, which must be in force."""
        if bits not in self.measures:
            self.measures[bits] = FigureMeasure.from_query(self.wrench_length, self.diameter, self.query)
        doubt = ""
        for finding in self.judge_fixture(fixture, self.measures[bits]):
            if finding.definite:
                return Ruling("refuted", finding.reason, bits)
            doubt = doubt or finding.reason
        return Ruling("undecided", doubt, bits) if doubt else Ruling("proven", "", bits)

    def judge_fixture(self, fixture: Fixture, measure: FigureMeasure) -> Iterator[Finding]:
        """Yield a finding for each rule that a fixture breaks or may break, cheap rules first.

        The caller must stop at the first definite finding, because later rules need the earlier ones.
        """
        outline, hardware = measure.outline, self.hardware
        yield from hardware.judge_holes(fixture)
        for name, peg in zip(hardware.names, fixture.pegs, strict=True):
            if peg.face not in select_outline_for(outline, peg.carrier).faces:
                yield Finding(True, f"{name} is on segment {peg.face}, which does not name a face")
        contacts = hardware.make_contacts(fixture, outline)
        touching = [
            (name, contact, peg.face, select_outline_for(outline, peg.carrier))
            for name, contact, peg in zip(hardware.names, contacts, fixture.pegs, strict=True)
            if not contact.is_flush
        ]
        for name, contact, face, _ in touching:
            if (
                isinstance(contact.side, ArcSide)
                and not contact.side.compute_offset_radius(contact.radius) > 0
            ):
                yield Finding(True, f"{name} does not fit into the concave face {face}")
        yield from judge_flats(fixture, hardware.names, contacts)
        travels = hardware.compute_travels(fixture)
        pose = enclose_written_pose(fixture.pose, list(travels.values()))
        yield from judge_gaps([one[:3] for one in touching], pose)
        proven, doubts = prove_pose(contacts, fixture.pose, travels)
        yield from doubts
        # Without a proof, what holds at no pose that agrees with the file's still refutes.
        pose = proven or pose
        yield from hardware.judge_standing(fixture, contacts, pose, outline)
        for name, contact, face, met in touching:
            yield from judge_touching(name, contact, face, pose, met, self.query.contact_margin)
        yield from self.judge_forces(fixture, contacts, pose, measure, proven is not None)

    def judge_forces(
        self,
        fixture: Fixture,
        contacts: Sequence[BallContact],
        pose: BallPose,
        measure: FigureMeasure,
        is_proven: bool,
    ) -> Iterator[Finding]:
        """Yield a finding if a fixture's contacts do not close at a pose, or written forces and figures are
        wrong.

        ``is_proven`` tells whether the pose is proven. If it is not, some rules are skipped.
        """
        hardware, pair = self.hardware, fixture.pair
        if pair is None:
            balance = Balance.from_contacts(contacts, pose, self.query.toolkit.clamping)
            loose = list(judge_closure(balance, self.wrench_length, hardware.names, hardware.slack_words))
            yield from loose
            if loose and is_proven:
                return
            outline = measure.outline
            yield from hardware.judge_reach(fixture, contacts, pose, outline, balance.shares)
            pressed = hardware.find_pressed_contacts(fixture, contacts, pose, outline)
            if hardware.jaw is not None:
                balance = Balance.from_contacts(pressed, pose, self.query.toolkit.clamping)
            yield from self.judge_figures(fixture, pressed, pose, measure, balance)
            return
        seat = SeatBalance.from_contacts(contacts, pose)
        yield from seat.judge_pushes(self.wrench_length)
        loose = list(seat.judge_closure())
        yield from loose
        if loose:
            return
        yield from seat.judge_numbers(pair, hardware.names)
        yield from self.judge_figures(fixture, contacts, pose, measure, seat)
        if is_proven:
            standing = SeatOnPlate.from_fixture(
                fixture, contacts, pose, self.query, hardware, measure.outline
            )
            yield from standing.judge_pair(fixture, pair, contacts, pose, seat)

    def judge_figures(
        self,
        fixture: Fixture,
        contacts: Sequence[BallContact],
        pose: BallPose,
        measure: FigureMeasure,
        balance: Balance | SeatBalance,
    ) -> Iterator[Finding]:
        """Yield a finding for each force or figure of quality in the file that differs from the one derived
        from ``balance``.
        """
        names, faces = self.hardware.names, self.hardware.number_shared_faces(fixture, contacts)
        stated = any(key in fixture.quality for key in PIN_KEYS)
        beams = make_beams(fixture, self.query)
        figures = measure.compute_figures(contacts, faces, pose, balance, beams, stated)
        yield from judge_written_numbers(fixture, names, balance, figures)
        yield from judge_program_forces(fixture, self.query, self.hardware, balance)


def judge_flats(fixture: Fixture, names: Sequence[str], contacts: Sequence[BallContact]) -> Iterator[Finding]:
    """Yield a finding for each peg whose flat does not face its side.

    Also yields one if the file states a flat for a peg without one, or omits a flat.
    """
    for name, peg, contact in zip(names, fixture.pegs, contacts, strict=True):
        lies = contact.body is not None and isinstance(contact.side, LineSide)
        if peg.flat_deg is None or not lies:
            if lies or not (peg.flat_deg is None or isnan(peg.flat_deg)):
                yield Finding(
                    True, f"{name} has {'a' if lies else 'no'} flat on its face, and the file says otherwise"
                )
        elif not isnan(peg.flat_deg) and isinstance(contact.side, LineSide):
            sine, cosine = ((arb(peg.flat_deg) - arb(fixture.pose.theta_deg)) / 180).sin_cos_pi()
            off = compute_norm((cosine + contact.side.normal[0], sine + contact.side.normal[1]))
            past = format_middle(off * 180 / arb.pi())
            yield from judge_slack(AGREEMENT - off, f"the flat of {name} looks {past} degrees past its face")


# What a result in any toolkit alone cannot show, beside what ``not_shown`` says.
NOT_SHOWN = (
    "how many candidates there were and what became of each, beyond what must add up, and which others are "
    "undecided",
    "how much work the search was: its cells and statistics, beyond their order",
    "whether a search that says it was interrupted was",
)

# The share of the work that is done before bending is computed again.
BEFORE_BENDING = 0.3

# Called with the fraction done and the number of fixtures not proven so far.
Progress = Callable[[float, int], None]


@frozen
class Unproven:
    """A fixture that is not proven.

    Parameters
    ----------
    index : its place in the list, from 0.
    verdict : "refuted" or "undecided".
    reason : one sentence, without a full stop.
    """

    index: int
    verdict: Verdict
    reason: str


@frozen
class Verification:
    """The verification of a result.

    Parameters
    ----------
    proven, refuted, undecided : numbers of fixtures.
    unproven : the fixtures that are not proven, in the order of the file.
    faults : faults of the result as a whole, one sentence each, without a full stop.
    bits : the highest precision that was needed.
    is_compared : whether the query was answered again, and the result compared with that answer.
    unchecked : sentences on what of the file was not checked.
    """

    proven: int
    refuted: int
    undecided: int
    unproven: tuple[Unproven, ...]
    faults: tuple[str, ...]
    bits: int
    is_compared: bool = False
    unchecked: tuple[str, ...] = ()

    @property
    def fixtures(self) -> int:
        """The number of fixtures verified."""
        return self.proven + self.refuted + self.undecided

    @property
    def holds(self) -> bool:
        """Whether nothing is refuted."""
        return not self.refuted and not self.faults


def list_not_shown(toolkit: Toolkit, is_seated: bool = False) -> Iterator[str]:
    """Yield sentences on claims that a result alone cannot show but a new search with its query would show.

    ``is_seated`` says whether the result states seating.
    """
    left_out = "seats" if toolkit.travel_count > 1 else "fixtures"
    yield f"whether {left_out} were left out, with all counts adjusted"
    yield (
        f"whether the query was wider: what is listed also meets one with {ToolkitRules(toolkit).wider_words}"
    )
    if is_seated:
        yield (
            "whether a fixture has further seats, or a lower pass, and how far its way out, cage, placing "
            "and depths go"
        )
    yield from NOT_SHOWN


def ignore_progress(fraction: float, unproven: int) -> None:
    """Do nothing: the default ``progress``."""


def verify(result: Result, progress: Progress = ignore_progress) -> Verification:
    """Return the verification of a result: each fixture is derived again in ball arithmetic, and proven or
    refuted.

    Nothing is used but the result's workpiece, toolkit, pegs and faces.

    Examples
    --------
    >>> from workhold import Vise, Workpiece, design
    >>> from workhold.verification import verify
    >>> wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    >>> outcome = verify(design(wedge, Vise(pitch=15, columns=1, peg_radius=2)))
    >>> outcome.proven == outcome.fixtures, outcome.holds
    (True, True)
    """
    return verify_listing(collect_claims(result), progress)


def verify_file(path: str | Path, progress: Progress = ignore_progress) -> Verification:
    """Return the verification of a result file, in which every number is compared with the derived one; see
    :func:`verify`.

    Raises
    ------
    InputError
        When the file cannot be read, is not a result file, or describes no usable workpiece or toolkit.
    """
    return verify_listing(read_listing(path), progress)


def verify_holds(listing: WrittenListing, progress: Progress, kept: str | None) -> Verification:
    """Return the verification of a result of flat jaws or of straps."""
    is_strapped = listing.query.toolkit.strap_set is not None
    judge = StrapJudge(listing.query) if is_strapped else JawJudge(listing.query)
    unproven = list[Unproven]()
    for place, fixture in enumerate(listing.fixtures):
        fault = next(judge.find_faults(fixture, place), None)
        if fault is not None:
            unproven.append(Unproven(place, "refuted", fault))
        progress((place + 1) / len(listing.fixtures), len(unproven))
    known = {one.index for one in unproven}
    for ruling in rule_on_bendings(listing.query, listing.fixtures, kept, known, ignore_count):
        if ruling.is_refuted:
            unproven.append(Unproven(ruling.index, "refuted", ruling.reason))
    unproven.sort(key=lambda one: one.index)
    listed = dict.fromkeys(listing.query.toolkit.types, 0)
    for fixture in listing.fixtures:
        listed[fixture.type] = listed.get(fixture.type, 0) + 1
    faults = [*listing.faults, *listing.find_bent_faults()]
    faults += judge.find_order_faults(listing.fixtures, listing.bent_count)
    if dict(listing.counts) != listed:
        faults.append(f"the counts are {dict(listing.counts)}, and {listed} are listed")
    if any(listing.found[name] < count for name, count in listed.items()):
        faults.append("fewer fixtures are found than listed")
    proven = len(listing.fixtures) - len(unproven)
    unchecked = list_unchecked(listing.query, listing.fixtures, kept)
    return Verification(proven, len(unproven), 0, tuple(unproven), tuple(faults), 53, unchecked=unchecked)


def ignore_count(done: int, count: int) -> None:
    """Do nothing: of what is not computed again no progress is told."""


def verify_listing(
    listing: WrittenListing, progress: Progress = ignore_progress, kept: str | None = None
) -> Verification:
    """Return the verification of a listing: the ruling on each fixture and the faults of the whole.

    ``progress`` is called after each fixture. ``kept`` is the part's solid in Open CASCADE's own form, from which it is
    computed again how far fixtures bend it; None for a drawn part, and where it is not there.
    """
    query, everything = listing.query, listing.fixtures
    if query.toolkit.holds_by_friction:
        return verify_holds(listing, progress, kept)
    judge, seating = Judge(query), SeatingJudge(query)
    turning = PartRotations.from_workpiece(query.workpiece)
    seen = KnownFixtures.make_empty(turning, judge.hardware)
    rulings: list[tuple[Verdict, str]] = []
    bits, doubtful = PRECISIONS[0], 0
    before_bending = BEFORE_BENDING if any(fixture.bent is not None for fixture in everything) else 1.0
    for place, fixture in enumerate(everything):
        ruling = judge.rule_on(fixture)
        verdict, reason = ruling.verdict, ruling.reason
        bits = max(bits, ruling.bits)
        if verdict != "refuted":
            broken = find_broken_restriction(fixture, query, judge.hardware)
            broken = broken or find_missing_figure(fixture, query) or seating.find_fault(fixture)
            broken = broken or find_program_fault(fixture, query, judge.hardware)
            verdict, reason = ("refuted", broken) if broken else (verdict, reason)
        first = None if verdict == "refuted" else seen.add(place, fixture)
        if first is not None:
            verdict, reason = "refuted", f"{judge.hardware.same_words} fixture {first + 1}"
        rulings.append((verdict, reason))
        doubtful += verdict != "proven"
        progress((place + 1) / len(everything) * before_bending, doubtful)

    def tell(done: int, count: int) -> None:
        progress(before_bending + (1.0 - before_bending) * done / count, doubtful)

    wrong = {place for place, (verdict, _) in enumerate(rulings) if verdict == "refuted"}
    for bending in rule_on_bendings(query, everything, kept, wrong, tell):
        rulings[bending.index] = ("refuted" if bending.is_refuted else "undecided", bending.reason)
    unproven = [Unproven(place, *ruling) for place, ruling in enumerate(rulings) if ruling[0] != "proven"]
    refuted = {one.index for one in unproven if one.verdict == "refuted"}
    faults = [
        *listing.faults,
        *find_account_faults(listing, turning.order),
        *find_order_faults(
            everything,
            query,
            judge.hardware,
            listing.least_effective_error,
            listing.is_whole,
            listing.is_chosen,
            listing.bent_count,
        ),
        *listing.find_bent_faults(),
        *find_pattern_faults(everything, query),
        *find_seat_faults(listing, refuted),
        *find_stock_faults(query),
    ]
    if not refuted and turning.is_certain:
        faults += find_distinct_faults(listing, seen)
    tally = len(rulings) - len(unproven), len(refuted), len(unproven) - len(refuted)
    unchecked = list_unchecked(query, everything, kept)
    return Verification(*tally, tuple(unproven), tuple(faults), bits, unchecked=unchecked)


def find_distinct_faults(listing: WrittenListing, seen: KnownFixtures) -> Iterator[str]:
    """Yield one sentence for each stated number of distinct fixtures that contradicts the listed fixtures.

    The number of sets among unlisted fixtures is not known: each may be a set of its own, or all may belong
    to one.
    """
    for kind, counts in listing.counts.items():
        sets, distinct, others = seen.sets.get(kind, 0), listing.distinct[kind], listing.found[kind] - counts
        if others > 0 and not sets <= distinct <= sets + others:
            yield (
                f"distinct says {distinct} fixtures of type {kind}, but those listed form {sets}, "
                f"and {others} more are found"
            )
        elif others == 0 and distinct != sets:
            yield f"distinct says {distinct} fixtures of type {kind}, but those listed form {sets}"
