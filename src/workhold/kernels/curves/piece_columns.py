"""Columns of a piece of a chord curve, and of the edges it is made from (see ``pieces``).

Columns of a piece: LOW, HIGH (psi in radians), VALUE and SLOPE at both ends, SECOND_DERIVATIVE_LOW,
SECOND_DERIVATIVE_HIGH, CURVE (index), the bounds VALUE_ERROR and SLOPE_ERROR of the errors at both ends, VALUE_LEAST
and VALUE_MOST over the piece (errors included), X_LEFT (the rightmost peg is no farther left than this), X_RIGHT (the
leftmost peg is no farther right), FORCE_LEFT_LOW to FORCE_LEFT_HIGH and FORCE_RIGHT_LOW to FORCE_RIGHT_HIGH (directions
F as a chord of the left jaw and of the right one; none when low > high), ACROSS_LEAST and ACROSS_MOST (of y . P),
STEADY (1 where all this is finite, 0 beside a tangency).

Entries of an edge, a chord at one end of a piece: value, slope, their errors, place of the tail along x, |P|, bound of how
far P is from tail and head, bound of the tail's error, the outward normals of tail and head in the vise's frame, y . P, and
bound of the error of P.
"""

from __future__ import annotations

LOW, HIGH, VALUE_LOW, SLOPE_LOW, VALUE_HIGH, SLOPE_HIGH, SECOND_DERIVATIVE_LOW, SECOND_DERIVATIVE_HIGH, CURVE = range(9)
VALUE_ERROR_LOW, SLOPE_ERROR_LOW, VALUE_ERROR_HIGH, SLOPE_ERROR_HIGH = range(9, 13)
VALUE_LEAST, VALUE_MOST, X_LEFT, X_RIGHT = range(13, 17)
FORCE_LEFT_LOW, FORCE_LEFT_HIGH, FORCE_RIGHT_LOW, FORCE_RIGHT_HIGH, ACROSS_LEAST, ACROSS_MOST, STEADY = range(17, 24)
PIECE_LENGTH = 24

EDGE_VALUE, EDGE_SLOPE, EDGE_VALUE_ERROR, EDGE_SLOPE_ERROR, EDGE_X, EDGE_CENTER, EDGE_ARM, EDGE_ERROR = range(8)
TAIL_X, TAIL_Y, HEAD_X, HEAD_Y, EDGE_ACROSS, EDGE_CENTER_ERROR = range(8, 14)
EDGE_LENGTH = 14
