"""A part that turns with a peg on a level line and on a piece, and all roots of a function over a range.

The part turns about a point, the origin here; the line is k above it, and k may depend on the orientation
theta. With the outward normal n at the angle nu, t a quarter turn further, and the peg's centre at N n + tau
t, it is

    B = N cos nu - tau sin nu        along the line, while        k = N sin nu + tau cos nu.

Where curvature is kappa (0 on a line, above 0 on a convex arc), differentiating by theta gives with q = (k' -
B) / cos nu

    B' = -(tau + k' sin nu) / cos nu,        nu' = 1 + kappa q,        tau' = (1 - kappa N) q,
    B'' = -(tau' + k'' sin nu + (tau sin nu + k') nu' / cos nu) / cos nu.

On a line N is its distance from the origin, on an arc nu follows from the height of its centre, and all else
from nu. An upright line is a level one of a part that is turned by a quarter more.

Roots are isolated by enclosures of the function's value in the middle and its derivative throughout. A range
is dropped where the mean value theorem leaves no root, cut by the interval Newton method where the function
is monotone, and halved otherwise. What is too narrow to be halved, or hardly steep, is in doubt. Reference:
R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM 2009, chapter 8.
"""

from __future__ import annotations

from math import asin, atan2, floor, hypot, pi
from typing import NamedTuple

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.interval import (
    TURN,
    Interval,
    iadd,
    icos,
    idivide,
    imul,
    ineg,
    iscale,
    ishift,
    isin,
    isub,
    widen_outward,
)

# Radians. Ranges narrower than the first are not halved; a root known less well than the second is in doubt.
NARROWEST, KNOWN = 2e-8, 1e-8
# Ranges that are looked at of one function; what is left then is in doubt.
MOST_RANGES = 20000
# Verdicts on a range: to be left, to be looked at in halves or as far as it is left, a root, one in doubt.
NONE, HALVES, REST, ROOT, IN_DOUBT = range(5)


@inner
def intersect(a: Interval, b: Interval) -> Interval:
    """Return the intersection of two intervals; low > high where it is empty."""
    return (max(a[0], b[0]), min(a[1], b[1]))


@inner
def has_none(values: Interval) -> bool:
    """Return whether an interval does not contain 0."""
    return values[0] > 0.0 or values[1] < 0.0


@inner
def judge_range(turn: Interval, middle: float, value: Interval, slope: Interval) -> tuple[int, Interval]:
    """Return (verdict on a range of orientations, the part of the range that may have roots of a function).

    NONE: no root; HALVES: halve the range; REST: go on with the part returned; ROOT: one root, known to
    ``KNOWN`` radians; IN_DOUBT: the range is too narrow to be halved, or the function hardly steep.

    Parameters
    ----------
    turn : the range in radians.
    value : enclosure of the function at ``middle``.
    slope : enclosure of its derivative over the range.
    """
    reach = (turn[1] - turn[0]) / 2.0
    off = reach * max(-slope[0], slope[1])
    if value[0] > off or value[1] < -off:
        return (NONE, turn)
    if not has_none(slope):
        return (HALVES, turn)
    rest = intersect(turn, ishift(middle, ineg(idivide(value, slope))))
    if rest[0] > rest[1]:
        return (NONE, turn)
    if rest[1] - rest[0] < reach:
        return (REST, rest)
    # It shrinks until rounding hides the sign in the middle.
    return (ROOT if 2.0 * reach < KNOWN else IN_DOUBT, turn)


@inner
def push_rest(verdict: int, turn: Interval, looked: int, stack: Array, depth: int) -> int:
    """Push a range on the stack, whole if the verdict is REST, else as two halves; return the new depth.

    Return -1, with nothing pushed, when the range is too narrow to be halved, there is no room, or
    ``looked``, the number of ranges examined so far, has reached ``MOST_RANGES``.
    """
    if verdict == REST:
        stack[depth, 0], stack[depth, 1] = turn
        return depth + 1
    if turn[1] - turn[0] <= NARROWEST or looked >= MOST_RANGES or depth + 2 > stack.shape[0]:
        return -1
    middle = (turn[0] + turn[1]) / 2.0
    stack[depth, 0], stack[depth, 1] = turn[0], middle
    stack[depth + 1, 0], stack[depth + 1, 1] = middle, turn[1]
    return depth + 2


# Columns of a shape, a piece seen from the point about which the part turns: curvature in 1 / mm; the arc's
# centre by its distance and direction; what N is besides the centre's part, the distance of a line; direction
# of the normal at the middle, and how far normals turn to either side of it; middle and half extent along a
# line; and a disc around it.
CURVATURE, AWAY, AWAY_ANGLE, OFF, NORMAL, SPREAD, FOOT, HALF, DISC, DISC_ANGLE, DISC_RADIUS = range(11)
SHAPE_LENGTH = 11
# mm. How far past its end a contact may lie: rounding. No unit: normals nearer than this to square to the
# line press with a million times the force along it, and are none.
END, SQUARE = 1e-9, 1e-6
NOTHING = (0.0, 0.0)


class Contact(NamedTuple):
    """The contact of a peg on a level line with a piece, over a range of orientations.

    Symbols are those of :func:`compute_contact`.

    Parameters
    ----------
    is_possible : whether there may be a contact.
    is_everywhere : whether the whole line or circle has one throughout.
    place, slope, bend : enclosures of B, B' and B''.
    tangent : enclosure of tan nu.
    """

    is_possible: bool
    is_everywhere: bool
    place: Interval
    slope: Interval
    bend: Interval
    tangent: Interval


NOWHERE = Contact(False, False, NOTHING, NOTHING, NOTHING, NOTHING)


@inner
def write_shape(row: Array, disc: Array, x: float, y: float, shape: Array) -> None:
    """Write a piece (10,) in a disc (3,) as seen from the point (x, y) of the part to ``shape`` (11,).

    Lengths are in mm, angles in radians. See ``base.feature`` for the layout of ``row``, ``seating.turning``
    for that of ``shape``.
    """
    dx, dy = row[X] - x, row[Y] - y
    shape[DISC], shape[DISC_RADIUS] = hypot(disc[0] - x, disc[1] - y), disc[2] + END
    shape[DISC_ANGLE] = atan2(disc[1] - y, disc[0] - x)
    if row[IS_ARC] == 0.0:
        shape[CURVATURE], shape[AWAY], shape[AWAY_ANGLE], shape[SPREAD] = 0.0, 0.0, 0.0, 0.0
        shape[OFF], shape[NORMAL] = row[AXIS_Y] * dx - row[AXIS_X] * dy, atan2(-row[AXIS_X], row[AXIS_Y])
        shape[FOOT], shape[HALF] = row[AXIS_X] * dx + row[AXIS_Y] * dy, row[HALF_EXTENT] + END
    else:
        shape[CURVATURE], shape[OFF] = row[SIGN] / row[RADIUS], row[SIGN] * row[RADIUS]
        shape[AWAY], shape[AWAY_ANGLE] = hypot(dx, dy), atan2(dy, dx)
        shape[NORMAL] = atan2(row[SIGN] * row[AXIS_Y], row[SIGN] * row[AXIS_X])
        shape[SPREAD], shape[FOOT], shape[HALF] = row[HALF_EXTENT] + END / row[RADIUS], 0.0, 0.0


@inner
def compute_contact(
    shape: Array, turn: Interval, level: Interval, rise: Interval, bend: Interval, facing: float, within: bool
) -> Contact:
    """Return the contact of a peg on a level line with a piece, over a range of orientations of the part.

    The part turns about a point; the line is k above it, k a function of theta. B is the coordinate of the
    contact along the line from that point, nu the direction of the outward normal. See ``seating.turning``
    for the layout of ``shape``.

    Parameters
    ----------
    shape : (11,), see :func:`write_shape`, as seen from that point.
    turn : range of theta in radians.
    level, rise, bend : enclosures of k, k' and k''.
    facing : 1 where the normal's component along the line is positive, -1 where it is negative.
    within : whether only the piece itself counts, not its whole line or circle.
    """
    if within:
        middle = iscale(shape[DISC], isin(ishift(shape[DISC_ANGLE], turn)))
        if level[0] > middle[1] + shape[DISC_RADIUS] or level[1] < middle[0] - shape[DISC_RADIUS]:
            return NOWHERE
    is_arc, smooth = shape[CURVATURE] != 0.0, True
    psi = (shape[NORMAL] - shape[SPREAD], shape[NORMAL] + shape[SPREAD])
    nu = ishift(shape[NORMAL], turn)
    if is_arc:
        # sin nu is the height over the centre, in radii.
        sine = iscale(
            shape[CURVATURE], isub(level, iscale(shape[AWAY], isin(ishift(shape[AWAY_ANGLE], turn))))
        )
        if sine[0] > 1.0 or sine[1] < -1.0:
            return NOWHERE
        smooth = sine[0] > -1.0 and sine[1] < 1.0
        found = widen_outward(asin(max(sine[0], -1.0)), asin(min(sine[1], 1.0)))
        if facing < 0.0:
            found = isub((pi, pi), found)
        turns = floor((nu[0] + nu[1] - found[0] - found[1]) / (2.0 * TURN) + 0.5)
        found = ishift(TURN * turns, found)
        on_part = isub(found, turn)
        # Where both ranges are so wide that they meet all around, the piece's ends decide nothing.
        if within and 2.0 * shape[SPREAD] + (turn[1] - turn[0]) + (found[1] - found[0]) < TURN:
            psi = intersect(psi, on_part)
            if psi[0] > psi[1]:
                return NOWHERE
            nu = intersect(found, iadd(turn, psi))
        else:
            psi, nu = on_part, found
    cosine = iscale(facing, icos(nu))
    if cosine[1] < SQUARE:
        return NOWHERE
    smooth = smooth and cosine[0] >= SQUARE
    cosine, sine = iscale(facing, (max(cosine[0], SQUARE), cosine[1])), isin(nu)
    from_center = ishift(shape[AWAY_ANGLE], ineg(psi))
    off = ishift(shape[OFF], iscale(shape[AWAY], icos(from_center)))
    along = idivide(isub(level, imul(off, sine)), cosine)
    if is_arc:
        along = intersect(along, iscale(shape[AWAY], isin(from_center)))
    elif within:
        along = intersect(along, (shape[FOOT] - shape[HALF], shape[FOOT] + shape[HALF]))
    if along[0] > along[1]:
        return NOWHERE
    place = isub(imul(off, cosine), imul(along, sine))
    speed = ineg(idivide(iadd(along, imul(rise, sine)), cosine))
    q = idivide(isub(rise, place), cosine)
    slide = imul(ishift(1.0, iscale(-shape[CURVATURE], off)), q)
    tilt = imul(idivide(iadd(imul(along, sine), rise), cosine), ishift(1.0, iscale(shape[CURVATURE], q)))
    change = ineg(idivide(iadd(iadd(slide, tilt), imul(bend, sine)), cosine))
    return Contact(True, smooth, place, speed, change, idivide(sine, cosine))
