"""The proof of one fixture."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import radians
from typing import Literal

from attrs import field, frozen
from flint import arb, ctx

from workhold.model.diameter import outline_diameter
from workhold.model.fixture import Fixture
from workhold.model.query import Query
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece
from workhold.verification.balls import PRECISIONS
from workhold.verification.closure import Balance, closure_findings
from workhold.verification.contacts import Contact, Pose, contact_system
from workhold.verification.figures import Measure, written_numbers
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Hardware
from workhold.verification.kinds import hardware_of
from workhold.verification.krawczyk import certified_zero
from workhold.verification.rules import AGREEMENT
from workhold.verification.sides import ArcSide
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
    hardware: Hardware = field(init=False)
    diameter: float = field(init=False)
    wrench_length: float = field(init=False)

    def __attrs_post_init__(self) -> None:
        hardware, diameter = hardware_of(self.query.toolkit), outline_diameter(self.query.workpiece)
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
        """Everything that speaks against a fixture, cheap rules first; nobody asks on after a definite finding."""
        outline, hardware = measure.outline, self.hardware
        yield from hardware.hole_findings(fixture)
        for name, peg in zip(hardware.names, fixture.pegs, strict=True):
            if peg.face not in outline.faces:
                yield Finding(True, f"{name} is on segment {peg.face}, which does not name a face")
        contacts = hardware.contacts(fixture, outline)
        faces = hardware.shared_faces(fixture, contacts)
        touching = [
            (name, contact, peg.face)
            for name, contact, peg in zip(hardware.names, contacts, fixture.pegs, strict=True)
            if not contact.is_flush
        ]
        for name, contact, face in touching:
            if isinstance(contact.side, ArcSide) and not contact.side.reach(contact.radius) > 0:
                yield Finding(True, f"{name} does not fit into the concave face {face}")
        yield from pose_findings(fixture, touching)
        proven, doubts = proven_pose(fixture, contacts, hardware.travel_words)
        yield from doubts
        # Without a proof, what holds at no pose that agrees with the file's still refutes.
        solution = proven or written_pose(fixture)
        yield from hardware.standing_findings(fixture, contacts, solution, outline)
        for name, contact, face in touching:
            yield from touching_findings(name, contact, face, solution, outline, self.query.contact_margin)
        balance = Balance.of(contacts, solution, self.query.toolkit.clamping)
        loose = list(closure_findings(balance, self.wrench_length, hardware))
        yield from loose
        if not loose or proven is None:
            figures = measure.figures(contacts, faces, solution, balance)
            yield from written_numbers(fixture, hardware.names, balance, figures)


def degree() -> arb:
    """One degree in radians."""
    return arb.pi() / 180


def pose_findings(fixture: Fixture, touching: list[tuple[str, Contact, int]]) -> Iterator[Finding]:
    """Whether any pose that agrees with the file's, and a travel likewise, could touch all four faces.

    The gaps are enclosed over all of them at once; a gap that is certainly not the peg radius refutes the fixture.
    """
    around = written_pose(fixture)
    for name, contact, face in touching:
        off = contact.side.gap(contact.in_part(around)) - contact.radius
        if off > 0 or off < 0:
            yield Finding(True, f"{name} is {number(off)} mm away from touching face {face}")


def written_pose(fixture: Fixture) -> Pose:
    """All poses that agree with the file's, with travels likewise."""
    written, off = fixture.pose, arb(0, AGREEMENT)
    theta = (written.theta_deg + off) * degree()
    return Pose.of(theta, written.x + off, written.y + off, fixture.jaw_separation + off)


def proven_pose(fixture: Fixture, contacts: list[Contact], travel_words: str) -> tuple[Pose | None, list[Finding]]:
    """The proven solution of the contact equations near the file's pose, if there is one, and what is wrong with it.

    ``travel_words`` say what the travel is called.
    """
    written = fixture.pose
    start = [radians(written.theta_deg), written.x, written.y, fixture.jaw_separation]
    zero = certified_zero(partial(contact_system, contacts), start)
    if zero is None:
        words = "the contact equations have no single solution that can be proven near the pose in the file"
        return None, [Finding(False, words)]
    theta, x, y, travel = zero
    findings: list[Finding] = []
    comparisons = (
        ("angle", "degrees", theta / degree(), written.theta_deg),
        ("x", "mm", x, written.x),
        ("y", "mm", y, written.y),
        (travel_words, "mm", travel, fixture.jaw_separation),
    )
    for name, unit, derived, value in comparisons:
        off = abs(derived - value)
        if not off < AGREEMENT:
            words = f"the {name} in the file is {number(off)} {unit} from the one that touches all four faces"
            findings += rule(AGREEMENT - off, words, words)
    return Pose.of(theta, x, y, travel), findings
