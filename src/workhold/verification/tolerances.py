"""The numbers that decide in a verification, and the findings of rules against a fixture.

The numbers are deliberately a copy of those of ``workhold.conventions``: a verification shares no rule with
the code that it judges, not even a constant. So a number changed by mistake on one side is noticed on the
other. Both are compared with the table of docs/belief.md, "Conventions that are part of the claim".

Drawings are made with round numbers. So two faces are often exactly as far apart as two holes, or a contact
is exactly at the joint of two faces. The coordinates of a drawing are rounded, which shifts such a
coincidence by some 1e-13 mm in one direction or the other. A rule with its limit at the coincidence would be
decided by that rounding. Therefore

- a gap or an opening is met when it is missed by no more than a hair;
- a contact at a tangent joint may lie up to a hair past that end of its face, at any other end it lies more
  than a hair inside;
- a peg may enter a face that runs alongside its own by no more than a hair.

The hair is part of the rule: an exact number, the same at every precision. With it in the slack, a rule holds
when the whole ball of the slack is positive, and is broken when the whole ball is negative. What is neither
at the highest precision is undecided.

Glossary
--------
hair : a length of 1e-9 mm by which the edge of a rule stands off a natural coincidence; the double nearest to
    it, taken as the rational number it is.
slack : a number that a rule wants to be positive.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import frozen
from flint import arb

__all__ = ["Finding", "format_middle", "judge_slack", "judge_written_number"]

# mm. A gap, an opening, a contact margin or the distance from a keep-out zone is met when it is missed by at
# most this; a contact may lie so far past a tangent joint, and lies more than this inside any other end.
HAIR = 1e-9
# mm. The body of a clamp, which touches the part at its tip, may enter it by at most this.
BODY_SLACK = 1e-7
# No unit. Sides whose normals at their joint agree to this in both components meet tangentially: the angle in
# radians by which the rounded coordinates and bulges of a drawing may turn them.
TANGENT = 1e-5
# mm. An edge or none may be counted at a joint that is tangent, or nearly so, where the ends of contact
# features are farther apart; so it may beside a hollow whose contact feature is about as long as ``HAIR``.
SAME_END = 9e-7
# mm. A peg fills a hollow whose radius exceeds its own by no more than this: no place there is a contact.
FILLED = 5e-7
# No unit. The least share of a peg in the closure, the shares scaled to sum 1: 0 when three normals meet in
# one point.
LEAST_SHARE = 1e-9
# No unit. The least clamping force, the shares scaled to sum 1: 0 at a double solution of the contact
# equations, where the rounding of a drawing alone leaves up to 1e-7 or so.
LEAST_CLAMPING = 1e-6
# No unit. Of two clamps each pushes with more than this part of the force on its face; with less it grazes
# the workpiece.
LEAST_PUSH = 1e-6
# No unit. The most a peg is pressed with per unit of a clamp's force.
MOST_FORCE = 1e6
# No unit. With two clamps the wrenches of the locators, moments in parts of L, have a larger determinant than
# this: with less the pose is a double root, which a rounded drawing leaves at 1e-7 or so.
LEAST_SEAT = 1e-6
# No unit. A locator's force per unit of a clamp's this near to zero is zero. A clamp whose least such force,
# as a share of all and per unit of that on its face, is more holds the part without the other.
NO_REACTION = 1e-9
# Degrees. Of the pairs of clamps of a seat whose freedom is the largest but for this the one of the largest
# margin stands for all.
SAME_FREEDOM = 1e-4
# No unit. Of five wrenches those nearer than this to a plane through three of them are on it.
FLAT = 1e-12
# No unit. The sizes of the four minors, moments in parts of L, sum to more than this; with less, the normals
# meet in one point or are parallel up to the rounding of the drawing, and four such contacts close nothing.
LEAST_SPAN = 1e-7
# mm. What is this near to a wall, or enters it by so much, lies on it; the contact with a wall is longer than
# the second.
FLUSH, LEAST_FLUSH = 1e-7, 1e-6
# Radians and mm. Fixtures in the same holes with orientations and places nearer than this are the same.
SAME = 1e-6

# mm. Of lengths that differ by ``SAME`` but for this, either may be said to be the longer one.
SPARE = 1e-8

# No unit. A bulge below this in size is a line: a convention of the file's form.
STRAIGHT = 2e-6
# Radians. Arcs of one face that lack less than this of half a turn of half sweep are a whole circle.
WHOLE = 1e-9

# mm or degrees. Places and angles written in a file agree with the derived ones to this.
AGREEMENT = 1e-6
# No unit, and for each square of the clamp amplification. Forces and figures of quality written in a file
# agree with the derived ones to these parts of themselves, and a hair of their unit. They are written with
# twelve digits; see ``figures``.
FIGURE_AGREEMENT = 1e-7
ROUNDING = 1e-13

# What is warned of (mm, no unit, times the jaw force, times the sum of the tolerances), what makes a fixture
# none for a workshop, and what counts against one (degrees, shares, times the jaw force, points);
# docs/quality.md.
NEAR_EDGE, WEAK_CLOSURE, STRONG_PEG, LARGE_LOCATION_ERROR = 1.0, 0.02, 3.0, 5.0
UNFIT_LOCATION_ERROR, UNFIT_CLOSURE = 50.0, 0.0025
SMALL_CAPTURE, CLOSE_READING = 1.0, 0.1
# mm. Silhouettes that agree to this cover the same place; within this factor of it either may be said.
SAME_PLACE, SAME_PLACE_SPARE = 1e-3, 2.0
# MPa of steel, N where no jaw force is known, and what a pin may take in MPa and move the part by in mm.
ELASTIC_MODULUS, SHEAR_MODULUS, STATED_FORCE = 210_000, 81_000, 1000
PIN_STRESS_LIMIT, PIN_MOVEMENT_LIMIT = 421.0, 0.05
SQUARE_TILT, MAIN_DIRECTION, SMALL_FACE, GENTLE_PEG = 0.01, 0.99, 0.1, 1.5
POINTS_PER_DECADE, TILTED_POINTS, STRONG_POINTS, SMALL_FACE_POINTS = 20, 9, 4, 2

# What the order makes of a location error: times so much for the angle as written (degrees), a contact nearer
# than its peg's radius to the end of a straight face, a clamp and a dowel in a hole, a part that hangs over
# the plate; and the share by which each step is larger than the one before. docs/quality.md.
WRITTEN_ANGLE = 1e-6
TURNED, ASLANT, AT_AN_END, CLAMP_IN_HOLE, DOWEL_IN_HOLE, HANGING = 1.05, 1.5, 1.1, 1.25, 1.1, 1.1
STEP = 11, 10


@frozen
class Finding:
    """A rule that is broken (definite) or that cannot be shown to hold, with the reason in one sentence."""

    definite: bool
    reason: str


def judge_slack(slack: arb, broken: str, edge: str = "") -> Iterator[Finding]:
    """Yield nothing if a slack is certainly positive, else one finding.

    If the slack is certainly negative, it is a definite finding with the words ``broken``. If that is
    uncertain, it is an undecided finding with the words ``edge``, or ``broken`` if ``edge`` is empty.
    """
    if not slack > 0:
        definite = bool(slack < 0)
        yield Finding(definite, broken if definite or not edge else edge)


def judge_written_number(name: str, value: float, derived: arb, spare: arb) -> Iterator[Finding]:
    """Yield a finding if a number of the file differs from the derived one by more than ``HAIR`` + ``spare``."""
    slack = HAIR + spare - abs(derived - value)
    if not slack > 0:
        yield from judge_slack(
            slack, f"{name} is {value:.12g} in the file and comes to {float(derived.mid()):.12g}"
        )


def format_middle(value: arb) -> str:
    """Return the midpoint of a ball as text with three significant digits, for messages."""
    return f"{float(value.mid()):.3g}"
