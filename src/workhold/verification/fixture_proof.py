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
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece
from workhold.verification.asked import Asked
from workhold.verification.balls import PRECISIONS
from workhold.verification.closure import Balance, closure_findings
from workhold.verification.contacts import Contact, Pose, contact_system
from workhold.verification.figures import Measure, written_numbers
from workhold.verification.findings import Finding, number, rule
from workhold.verification.holes import hole_findings, hole_place, jaw_findings
from workhold.verification.krawczyk import certified_zero
from workhold.verification.outline import Outline
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


def verify_fixture(fixture: Fixture, workpiece: Workpiece, vise: Vise, contact_margin: float = 0.0) -> Ruling:
    """Prove or refute one fixture from workpiece, vise, pegs and faces alone.

    Parameters
    ----------
    fixture : as a result lists it; floats are taken as the rational numbers they are.
    contact_margin : smallest distance in mm from a contact to the end of its feature.
    """
    return Judge(workpiece, vise, contact_margin).rule_on(fixture)


@frozen(eq=False)
class Judge:
    """Proves or refutes fixtures of one workpiece in one vise; see :func:`verify_fixture`.

    ``asked`` tells for which tolerance and loads the figures of quality are; without it the location error is taken to be
    that of the default tolerance.
    """

    workpiece: Workpiece
    vise: Vise
    contact_margin: float = 0.0
    asked: Asked = field(factory=Asked)
    measures: dict[int, Measure] = field(factory=dict, init=False)
    wrench_length: float = field(init=False)

    @wrench_length.default
    def half_the_locus(self) -> float:
        """L of the wrenches in mm: half the diameter of the peg-centre locus."""
        return outline_diameter(self.workpiece) / 2 + self.vise.peg_radius

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
            outline, outer = Outline.of(self.workpiece), len(self.workpiece.loops[0])
            self.measures[bits] = Measure.of(outline, outer, self.vise.peg_radius, self.wrench_length, self.asked)
        doubt = ""
        for finding in self.findings(fixture, self.measures[bits]):
            if finding.definite:
                return Ruling("refuted", finding.reason, bits)
            doubt = doubt or finding.reason
        return Ruling("undecided", doubt, bits) if doubt else Ruling("proven", "", bits)

    def findings(self, fixture: Fixture, measure: Measure) -> Iterator[Finding]:
        """Everything that speaks against a fixture, cheap rules first; nobody asks on after a definite finding."""
        outline, clamping = measure.outline, self.vise.clamping
        yield from hole_findings(fixture, self.vise)
        for position, peg in enumerate(fixture.pegs, 1):
            if peg.face not in outline.faces:
                yield Finding(True, f"peg {position} is on segment {peg.face}, which does not name a face")
        contacts = [
            Contact(hole_place(peg, self.vise), int(peg.jaw == "right"), outline.faces[peg.face], measure.radius)
            for peg in fixture.pegs
        ]
        faces = [peg.face for peg in fixture.pegs]
        for position, (contact, face) in enumerate(zip(contacts, faces, strict=True), 1):
            if isinstance(contact.side, ArcSide) and not contact.side.reach(measure.radius) > 0:
                yield Finding(True, f"peg {position} does not fit into the concave face {face}")
        yield from pose_findings(fixture, contacts, faces)
        solution, doubts = proven_pose(fixture, contacts)
        yield from doubts
        if solution is None:
            return
        yield from jaw_findings(fixture, self.vise, solution.separation)
        for position, (contact, face) in enumerate(zip(contacts, faces, strict=True), 1):
            yield from touching_findings(f"peg {position}", contact, face, solution, outline, self.contact_margin)
        balance = Balance.of(contacts, solution, clamping)
        loose = list(closure_findings(balance, self.wrench_length, clamping))
        yield from loose
        if not loose:
            yield from written_numbers(fixture, balance, measure.figures(contacts, faces, solution, balance))


def degree() -> arb:
    """One degree in radians."""
    return arb.pi() / 180


def pose_findings(fixture: Fixture, contacts: list[Contact], faces: list[int]) -> Iterator[Finding]:
    """Whether any pose that agrees with the file's, and a separation likewise, could touch all four faces.

    The gaps are enclosed over all of them at once; a gap that is certainly not the peg radius refutes the fixture.
    """
    written, backward_error = fixture.pose, arb(0, AGREEMENT)
    theta = (written.theta_deg + backward_error) * degree()
    around = Pose.of(
        theta, written.x + backward_error, written.y + backward_error, fixture.jaw_separation + backward_error
    )
    for position, (contact, face) in enumerate(zip(contacts, faces, strict=True), 1):
        off = contact.side.gap(contact.in_part(around)) - contact.radius
        if off > 0 or off < 0:
            yield Finding(True, f"peg {position} is {number(off)} mm away from touching face {face}")


def proven_pose(fixture: Fixture, contacts: list[Contact]) -> tuple[Pose | None, list[Finding]]:
    """The proven solution of the contact equations near the file's pose, if there is one, and what is wrong with it."""
    written = fixture.pose
    start = [radians(written.theta_deg), written.x, written.y, fixture.jaw_separation]
    zero = certified_zero(partial(contact_system, contacts), start)
    if zero is None:
        words = "the contact equations have no single solution that can be proven near the pose in the file"
        return None, [Finding(False, words)]
    theta, x, y, separation = zero
    findings: list[Finding] = []
    comparisons = (
        ("angle", "degrees", theta / degree(), written.theta_deg),
        ("x", "mm", x, written.x),
        ("y", "mm", y, written.y),
        ("jaw separation", "mm", separation, fixture.jaw_separation),
    )
    for name, unit, derived, value in comparisons:
        off = abs(derived - value)
        if not off < AGREEMENT:
            words = f"the {name} in the file is {number(off)} {unit} from the one that touches all four faces"
            findings += rule(AGREEMENT - off, words, words)
    return Pose.of(theta, x, y, separation), findings
