"""Named records that the kernels of a search take, and the columns of the tables among them.

Kernels work in the frame in which the moving carrier of the toolkit slides along +x (``contact.problem``).
Pegs of the carrier that stands still come first.

Whole numbers of a curve (C, 7), the same for a sliding pair:

- TAIL and HEAD (features), COLUMN_STEP and ROW_STEP (of the head from the tail);
- CENTER (number of the common centre of concentric arcs, -1 for others);
- FIRST_STRETCH and END_STRETCH (the curve's stretches, none of a sliding pair).

Reals of a curve (C, 16):

- FROM and TO (alpha in radians), BRANCH;
- TANGENT_FROM and TANGENT_TO (bound of the error in radians of that end where the chord is a tangency there,
  0 where it is not);
- LENGTH, SHIFT (arg Delta: psi = alpha - shift) and its COSINE and SINE;
- BACKWARD_ERROR (see ``chord.evaluation``);
- COINCIDENCE (its kind, see ``chord.coincidences``), MIDDLE (alpha) and SIDE of the coincidence;
- KAPPA (sum of the features' curvatures in 1 / mm);
- NEAR_FROM and NEAR_TO (alpha): the part of the range in which ``NearSpots`` allows both pegs.

Reals of a sliding pair (P, 5): SLIDE_FROM and SLIDE_TO (parameter of the tail on its feature), DIRECTION
(alpha), STEP_LENGTH, ORIENTATION (psi in radians).

Columns of a piece (see ``curves.pieces``):

- LOW, HIGH (psi in radians), VALUE and SLOPE at both ends, SECOND_DERIVATIVE_LOW, SECOND_DERIVATIVE_HIGH;
- CURVE (index), the bounds VALUE_ERROR and SLOPE_ERROR of the errors at both ends;
- VALUE_LEAST and VALUE_MOST over the piece (errors included);
- X_STANDING (the rightmost peg is no farther left than this), X_MOVING (the leftmost peg is no farther
  right);
- RIGHTWARD_LOW to RIGHTWARD_HIGH: directions of the pegs' joint force where it has a part along +x, none when
  low > high;
- LEFTWARD_LOW to LEFTWARD_HIGH: directions of its opposite where it has a part along -x, none when low >
  high;
- ACROSS_LEAST and ACROSS_MOST (of y . P), STEADY (1 where all this is finite, 0 beside a tangency).

Entries of an edge, a chord at one end of a piece:

- value, slope, their errors, place of the tail along x, |P|;
- bound of how far P is from tail and head, bound of the tail's error;
- the outward normals of tail and head in the frame of the pegs;
- y . P, and bound of the error of P.
"""

from __future__ import annotations

from typing import NamedTuple

from workhold.kernels.base.compiling import (
    ByteMatrix,
    ByteStack,
    IntMatrix,
    IntVector,
    Matrix,
    Vector,
)


class Precision(NamedTuple):
    """Tolerances and data for bounds of location errors, and the largest errors allowed
    (``contact.location_bounds``).

    Parameters
    ----------
    faces : (F,) number of each feature's face.
    doubts : (F,) factor, at least 1, on the location error of contacts on each feature.
    gives : (F,) error of a contact for a location error of 1, per mm by which the contact is moved on a line,
        or per radian on an arc.
    probes : (P, 3) points of the silhouette with a direction: movement per unit along x, along y, and of a
        turn times L.
    peg, face : tolerances in mm.
    most, most_aslant : largest effective error allowed in mm where the part is square to its drawing, and at
        other orientations; inf where errors are not limited.
    """

    faces: IntVector
    doubts: Vector
    gives: Vector
    probes: Matrix
    peg: float
    face: float
    most: float
    most_aslant: float


class NearSpots(NamedTuple):
    """Spots (numbered stretches of features), and which two or three of them locators may touch together.

    Where locators would have too large a location error, the entries are 0 (``contact.location_bounds``).

    Parameters
    ----------
    starts : (F + 1,) number of the first spot of each feature, then M, the number of all spots; spots of one
        feature are equally long.
    joined : (M, M) 1 for two spots that may be touched together; (0, 0) where nothing is ruled out.
    triples : (M, M, M) 1 for three spots that may be touched together, in any order; (0, 0, 0) where triples
        are not known.
    """

    starts: IntVector
    joined: ByteMatrix
    triples: ByteStack


class Features(NamedTuple):
    """Contact features; the pegs of each carrier touch a range of them, which belongs to their radius.

    Parameters
    ----------
    loose : (F, 10) rows with ends moved out slightly, for searching.
    rows : (F, 12) rows with the slack of their ends, for checking.
    standing, moving : first and past-the-last number of the features that pegs of each carrier touch; the
        ranges are equal or disjoint.
    precision : data for bounds of location errors.
    near : which spots three standing pegs may touch together.
    """

    loose: Matrix
    rows: Matrix
    standing: tuple[int, int]
    moving: tuple[int, int]
    precision: Precision
    near: NearSpots


class Lattice(NamedTuple):
    """Lattice of holes, common to both carriers: pitches in mm along x and y, and a row offset.

    ``row_offset`` is the height in mm of the moving carrier's row 0 above the standing carrier's row 0.
    """

    pitch_x: float
    pitch_y: float
    row_offset: float


class Limits(NamedTuple):
    """The rules that bound a fixture.

    Parameters
    ----------
    gap : smallest distance in mm along x from a standing to a moving peg, -inf where there is no such rule.
    contact_margin : smallest distance in mm from a contact to the end of its feature.
    wrench_length : L in mm, by which moments are divided.
    most_column_steps : largest column difference between pegs of one carrier.
    clamping : 1 when the moving carrier clamps by pushing towards -x, -1 when it clamps by pushing towards
        +x.
    least_margin : smallest closure margin that a fixture may have.
    most_listed : how many contacts a block lists when it counts them.
    pairing : 1 when the peg that moves is one of two clamps, else 0. With one of two clamps the four wrenches
        need not close, but the standing pegs alone must fix the pose, and the clamp must push.
    """

    gap: float
    contact_margin: float
    wrench_length: float
    most_column_steps: float
    clamping: float
    least_margin: float
    most_listed: float
    pairing: float = 0.0


class Setting(NamedTuple):
    """Lattice, limits, peg radii and errors, common to all records of a search.

    Parameters
    ----------
    standing_radius, moving_radius : of the pegs in mm.
    backward_error : how far in mm the features' rows may be from the drawing.
    """

    lattice: Lattice
    limits: Limits
    standing_radius: float
    moving_radius: float
    backward_error: float


TAIL, HEAD, COLUMN_STEP, ROW_STEP, CENTER, FIRST_STRETCH, END_STRETCH = range(7)
CURVE_INTEGERS = 7
FROM, TO, BRANCH, TANGENT_FROM, TANGENT_TO, LENGTH, SHIFT = range(7)
COSINE, SINE, BACKWARD_ERROR, COINCIDENCE, MIDDLE, SIDE, KAPPA = range(7, 14)
NEAR_FROM, NEAR_TO = 14, 15
CURVE_REALS = 16
SLIDE_FROM, SLIDE_TO, DIRECTION, STEP_LENGTH, ORIENTATION = range(5)
SLIDING_PAIR_REALS = 5


class Curves(NamedTuple):
    """Chord curves: whole numbers (C, 7), reals (C, 16), and their stretches (S, 13), see
    ``chord.stretches``."""

    integers: IntMatrix
    reals: Matrix
    stretches: Matrix


class SlidingPairs(NamedTuple):
    """Sliding pairs: whole numbers (P, 7) and reals (P, 5)."""

    integers: IntMatrix
    reals: Matrix


LOW, HIGH, VALUE_LOW, SLOPE_LOW, VALUE_HIGH, SLOPE_HIGH = range(6)
SECOND_DERIVATIVE_LOW, SECOND_DERIVATIVE_HIGH, CURVE = range(6, 9)
VALUE_ERROR_LOW, SLOPE_ERROR_LOW, VALUE_ERROR_HIGH, SLOPE_ERROR_HIGH = range(9, 13)
VALUE_LEAST, VALUE_MOST, X_STANDING, X_MOVING = range(13, 17)
RIGHTWARD_LOW, RIGHTWARD_HIGH, LEFTWARD_LOW, LEFTWARD_HIGH, ACROSS_LEAST, ACROSS_MOST, STEADY = range(17, 24)
PIECE_LENGTH = 24

EDGE_VALUE, EDGE_SLOPE, EDGE_VALUE_ERROR, EDGE_SLOPE_ERROR = range(4)
EDGE_X, EDGE_CENTER, EDGE_ARM, EDGE_ERROR = range(4, 8)
TAIL_NORMAL_X, TAIL_NORMAL_Y, HEAD_NORMAL_X, HEAD_NORMAL_Y, EDGE_ACROSS, EDGE_CENTER_ERROR = range(8, 14)
EDGE_LENGTH = 14
