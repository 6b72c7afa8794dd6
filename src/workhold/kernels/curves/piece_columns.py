"""Columns of a piece of a chord curve, and of the edges it is made from (see ``pieces``).

Columns of a piece: LOW, HIGH (psi in radians), VALUE and SLOPE at both ends, SECOND_DERIVATIVE_LOW,
SECOND_DERIVATIVE_HIGH, CURVE (index), the bounds VALUE_ERROR and SLOPE_ERROR of the errors at both ends, VALUE_LEAST
and VALUE_MOST over the piece (errors included), X_STANDING (the rightmost peg is no farther left than this), X_MOVING (the
leftmost peg is no farther right), RIGHTWARD_LOW to RIGHTWARD_HIGH and LEFTWARD_LOW to LEFTWARD_HIGH (directions of the
pegs' joint force where it has a part along +x, and of its opposite where it has one along -x; none when low > high),
ACROSS_LEAST and ACROSS_MOST (of y . P),
STEADY (1 where all this is finite, 0 beside a tangency).

Entries of an edge, a chord at one end of a piece: value, slope, their errors, place of the tail along x, |P|, bound of how
far P is from tail and head, bound of the tail's error, the outward normals of tail and head in the frame of the pegs, y . P,
and bound of the error of P.
"""

from __future__ import annotations

LOW, HIGH, VALUE_LOW, SLOPE_LOW, VALUE_HIGH, SLOPE_HIGH, SECOND_DERIVATIVE_LOW, SECOND_DERIVATIVE_HIGH, CURVE = range(9)
VALUE_ERROR_LOW, SLOPE_ERROR_LOW, VALUE_ERROR_HIGH, SLOPE_ERROR_HIGH = range(9, 13)
VALUE_LEAST, VALUE_MOST, X_STANDING, X_MOVING = range(13, 17)
RIGHTWARD_LOW, RIGHTWARD_HIGH, LEFTWARD_LOW, LEFTWARD_HIGH, ACROSS_LEAST, ACROSS_MOST, STEADY = range(17, 24)
PIECE_LENGTH = 24

EDGE_VALUE, EDGE_SLOPE, EDGE_VALUE_ERROR, EDGE_SLOPE_ERROR, EDGE_X, EDGE_CENTER, EDGE_ARM, EDGE_ERROR = range(8)
TAIL_NORMAL_X, TAIL_NORMAL_Y, HEAD_NORMAL_X, HEAD_NORMAL_Y, EDGE_ACROSS, EDGE_CENTER_ERROR = range(8, 14)
EDGE_LENGTH = 14
