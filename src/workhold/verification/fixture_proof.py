"""The proof of one fixture."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import Literal

from attrs import field, frozen
from flint import arb, ctx

from workhold.fixels.toolkit import Toolkit
from workhold.model.diameter import outline_diameter
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.verification.balls import PRECISIONS, norm
from workhold.verification.closure import Balance, closure_findings
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.figures import Measure, pair_numbers, written_numbers
from workhold.verification.findings import Finding, number, rule
from workhold.verification.placing import gap_findings, proven_pose, written_pose
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.seat import SeatBalance
from workhold.verification.seat_clamps import Standing
from workhold.verification.sides import ArcSide, LineSide
from workhold.verification.tolerances import AGREEMENT
from workhold.verification.touching import touching_findings

__all__ = ["Judge", "Ruling", "Verdict", "verify_fixture"]

Verdict = Literal["proven", "refuted", "undecided"]


@frozen
class Ruling:
    """What is shown of a fixture.

    Parameters
    ----------
    verdict : "proven" when every rule holds, "refuted" when one is broken, "undecided" otherwise.
    reason : one sentence for a fixture that is not proven, empty for one that is.
    bits : the precision at which it was decided, or the highest tried.
    """

    verdict: Verdict
    reason: str
    bits: int


def verify_fixture(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, contact_margin: float = 0.0) -> Ruling:
    """Prove or refute one fixture from workpiece, toolkit, pegs and faces alone.

    Parameters
    ----------
    fixture : as a result lists it; floats are taken as the rational numbers they are.
    contact_margin : smallest distance in mm from a contact to the end of its feature.
    """
    return Judge(Query(workpiece, toolkit, contact_margin=contact_margin)).rule_on(fixture)


@frozen(eq=False)
class Judge:
    """Proves or refutes fixtures that a query asks for; see :func:`verify_fixture`.

    Parameters
    ----------
    query : what is asked.
    hardware : the rules of its toolkit.
    diameter, wrench_length : of the part, and L of the wrenches, half that of the peg-centre locus; in mm.
    """

    query: Query
    measures: dict[int, Measure] = field(factory=dict, init=False)
    hardware: ToolkitRules = field(init=False)
    diameter: float = field(init=False)
    wrench_length: float = field(init=False)

    def __attrs_post_init__(self) -> None:
        hardware, diameter = ToolkitRules.of(self.query), outline_diameter(self.query.workpiece)
        object.__setattr__(self, "hardware", hardware)
        object.__setattr__(self, "diameter", diameter)
        object.__setattr__(self, "wrench_length", diameter / 2 + hardware.largest_radius)

    def rule_on(self, fixture: Fixture) -> Ruling:
        """The ruling on one fixture, at the lowest precision that decides it."""
        ruling = Ruling("undecided", "", 0)
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                ruling = self.ruling_at(bits, fixture)
            if ruling.verdict != "undecided":
                break
        return ruling

    def ruling_at(self, bits: int, fixture: Fixture) -> Ruling:
        """The ruling at the precision in force."""
        if bits not in self.measures:
            self.measures[bits] = Measure.of(self.wrench_length, self.diameter, self.query)
        doubt = ""
        for finding in self.findings(fixture, self.measures[bits]):
            if finding.definite:
                return Ruling("refuted", finding.reason, bits)
            doubt = doubt or finding.reason
        return Ruling("undecided", doubt, bits) if doubt else Ruling("proven", "", bits)

    def findings(self, fixture: Fixture, measure: Measure) -> Iterator[Finding]:
        """Everything that speaks against a fixture, cheap rules first, which a definite finding ends."""
        outline, hardware = measure.outline, self.hardware
        yield from hardware.hole_findings(fixture)
        for name, peg in zip(hardware.names, fixture.pegs, strict=True):
            if peg.face not in outline.faces:
                yield Finding(True, f"{name} is on segment {peg.face}, which does not name a face")
        contacts = hardware.contacts(fixture, outline)
        touching = [
            (name, contact, peg.face)
            for name, contact, peg in zip(hardware.names, contacts, fixture.pegs, strict=True)
            if not contact.is_flush
        ]
        for name, contact, face in touching:
            if isinstance(contact.side, ArcSide) and not contact.side.reach(contact.radius) > 0:
                yield Finding(True, f"{name} does not fit into the concave face {face}")
        yield from flat_findings(fixture, hardware.names, contacts)
        travels = hardware.travels(fixture)
        pose = written_pose(fixture.pose, list(travels.values()))
        yield from gap_findings(touching, pose)
        proven, doubts = proven_pose(contacts, fixture.pose, travels)
        yield from doubts
        # Without a proof, what holds at no pose that agrees with the file's still refutes.
        pose = proven or pose
        yield from hardware.standing_findings(fixture, contacts, pose, outline)
        for name, contact, face in touching:
            yield from touching_findings(name, contact, face, pose, outline, self.query.contact_margin)
        yield from self.force_findings(fixture, contacts, pose, measure, proven is not None)

    def force_findings(
        self, fixture: Fixture, contacts: Sequence[BallContact], pose: BallPose, measure: Measure, is_proven: bool
    ) -> Iterator[Finding]:
        """Whether the contacts of a fixture close at a pose, with the forces and figures that are written."""
        hardware, pair = self.hardware, fixture.pair
        balance: Balance | SeatBalance
        if pair is None:
            balance = Balance.of(contacts, pose, self.query.toolkit.clamping)
            loose = list(closure_findings(balance, self.wrench_length, hardware.names, hardware.slack_words))
        else:
            balance = SeatBalance.of(contacts, pose)
            yield from balance.push_findings(self.wrench_length)
            loose = list(balance.closure_findings())
        yield from loose
        if loose and (is_proven or pair is not None):
            return
        if pair is not None and isinstance(balance, SeatBalance):
            yield from pair_numbers(pair, hardware.names, balance)
        figures = measure.figures(contacts, hardware.shared_faces(fixture, contacts), pose, balance)
        yield from written_numbers(fixture, hardware.names, balance, figures)
        if pair is not None and isinstance(balance, SeatBalance) and is_proven:
            standing = Standing.of(fixture, contacts, pose, self.query, hardware, measure.outline)
            yield from standing.pair_findings(fixture, pair, contacts, pose, balance)


def flat_findings(fixture: Fixture, names: Sequence[str], contacts: Sequence[BallContact]) -> Iterator[Finding]:
    """Whether flats look at the faces that they lie on, where the file says which way, and no others do."""
    for name, peg, contact in zip(names, fixture.pegs, contacts, strict=True):
        lies = contact.body is not None and isinstance(contact.side, LineSide)
        if peg.flat_deg is None or not lies:
            if lies or not (peg.flat_deg is None or isnan(peg.flat_deg)):
                yield Finding(True, f"{name} has {'a' if lies else 'no'} flat on its face, and the file says otherwise")
        elif not isnan(peg.flat_deg) and isinstance(contact.side, LineSide):
            sine, cosine = ((arb(peg.flat_deg) - arb(fixture.pose.theta_deg)) / 180).sin_cos_pi()
            off = norm((cosine + contact.side.normal[0], sine + contact.side.normal[1]))
            words = f"the flat of {name} looks {number(off * 180 / arb.pi())} degrees past its face"
            yield from rule(AGREEMENT - off, words, words)
