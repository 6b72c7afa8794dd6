"""Columns of a row that describes a segment or a contact feature (``geometry.segment.segment_rows``).

IS_ARC : 0 for a line, 1 for an arc.
X, Y : middle of a line, centre of an arc, in mm.
AXIS_X, AXIS_Y : unit vector along a line, or from an arc's centre to its middle: parameters are 0 there.
HALF_EXTENT : largest parameter, in mm on a line and in radians on an arc; pi or more on a whole circle.
RADIUS : in mm, 0 for a line.
SIGN : whether the outward normal points away from an arc's centre (1) or towards it (-1); 1 for a line.
REST_X, REST_Y : what rounding has left of an arc's centre, in mm, which counts where the arc is shallow.
LOW_SLACK, HIGH_SLACK : how far in mm a contact may lie past either end (of features alone).
"""

from __future__ import annotations

IS_ARC, X, Y, AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN, REST_X, REST_Y, LOW_SLACK, HIGH_SLACK = range(12)
SEGMENT_LENGTH, FEATURE_LENGTH = 10, 12
