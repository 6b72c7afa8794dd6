"""The four contacts of a fixture in place, and the contact matrix from which all its figures follow.

Let c be the centre of the part, L the length of the wrenches and x the direction against which the moving
carrier clamps. The contact matrix A (4, 4) has a row for each peg:

    n_x,  n_y,  (q - c) x n / L,  n . x on the moving carrier and 0 on the other

for a contact at q with outward unit normal n. It answers both questions one asks of a fixture.

- Motion: let peg i stand delta_i too far towards the part. Then to first order A y = -delta, where y holds
the part's movement at c (x, y), its turn times L, and how far the carrier moves on.
- Force: pegs press with f >= 0 against the part, a load (g_x, g_y, moment m about c) acts on it, the moving
  carrier is pushed with a force F. Then A^T f = (g_x, g_y, m / L, F).

So one inverse serves for both. Its last row is the peg forces per unit of clamping force, and that row scaled
to sum 1 is the null vector of the wrenches. The duality of motions and forces is that of virtual work.
"""

from __future__ import annotations

from math import cos, hypot, inf, nan, pi, sin

from workhold.kernels.base.arrays import write_inverse
from workhold.kernels.base.compiling import (
    Array,
    IntMatrix,
    IntVector,
    Matrix,
    Stack,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    SIGN,
    X,
    Y,
)
from workhold.kernels.chord.evaluation import find_parameter, measure_end_distance


@inner
def measure_edge_distance(row: Array, s: float) -> float:
    """Return the distance in mm along a feature from the parameter s to the nearer end, tangent joints not
    counted.

    A contact may slide across a joint at which two features meet tangentially. Return inf where both ends are
    such joints, and on a whole circle. See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] != 0.0 and row[HALF_EXTENT] >= pi:
        return inf
    low = row[HALF_EXTENT] + s if row[LOW_SLACK] <= 0.0 else inf
    high = row[HALF_EXTENT] - s if row[HIGH_SLACK] <= 0.0 else inf
    return min(low, high) if row[IS_ARC] == 0.0 else min(low, high) * row[RADIUS]


@compiled
def write_contact_matrices(
    pegs: Stack,
    pose: Matrix,
    moves: Matrix,
    axes: Matrix,
    faces: IntMatrix,
    features: Matrix,
    starts: IntVector,
    center: Vector,
    length: float,
    points: Stack,
    normals: Stack,
    ends: Matrix,
    edges: Matrix,
    inverses: Stack,
    matrix: Matrix,
) -> None:
    """Write the contacts of N fixtures with P pegs each and the inverses of their contact matrices.

    Parameters
    ----------
    pegs : (N, P, 2) peg centres in the toolkit's frame, in mm.
    pose : (N, 3) orientation of the part in radians and translation x, y in mm.
    moves : (N, P) 1 for a peg on the moving carrier, 0 for others.
    axes : (N, 2) for each fixture the unit vector x in the toolkit's frame, against which the moving carrier
        clamps.
    faces : (N, P) number of the face that each peg touches.
    features : (F, 12) rows of contact features about c with the slacks of their ends, ordered by face.
    starts : index of the first feature of each face number, then F.
    center : (2,) c in the part's frame, in mm.
    length : L in mm, by which moments are divided.
    points : (N, P, 2) receives the peg centres in the part's frame about c, in mm.
    normals : (N, P, 2) receives the outward unit normals in the part's frame.
    ends : (N, P) receives the distances in mm along the features to their nearer ends.
    edges : (N, P) receives the distances in mm along the features to their nearer ends that are no tangent
        joints, see :func:`measure_edge_distance`.
    inverses : (N, 4, P) receives the inverses of the contact matrices where P is 4. ``inverses``, ``ends``
        and ``edges`` become NaN where there is no inverse or a face has no feature.
    matrix : (P, 4) work space.
    """
    count = pegs.shape[1]
    for k in range(len(pegs)):
        cosine, sine = cos(pose[k, 0]), sin(pose[k, 0])
        known = True
        for i in range(count):
            px, py = pegs[k, i, 0] - pose[k, 1], pegs[k, i, 1] - pose[k, 2]
            x, y = cosine * px + sine * py - center[0], cosine * py - sine * px - center[1]
            # Of a face's features the peg stands on one, and beyond the ends of the others.
            nearest, chosen, parameter = -inf, -1, 0.0
            for f in range(starts[faces[k, i]], starts[faces[k, i] + 1]):
                s = find_parameter(features[f], x, y)
                distance = measure_end_distance(features[f], s)
                if distance > nearest:
                    nearest, chosen, parameter = distance, f, s
            known = known and chosen >= 0
            row = features[max(chosen, 0)]
            nx, ny = row[AXIS_Y], -row[AXIS_X]
            if row[IS_ARC] != 0.0:
                nx, ny = row[SIGN] * (x - row[X]), row[SIGN] * (y - row[Y])
                size = hypot(nx, ny)
                nx, ny = nx / size, ny / size
            points[k, i, 0], points[k, i, 1] = x, y
            normals[k, i, 0], normals[k, i, 1] = nx, ny
            ends[k, i], edges[k, i] = nearest, measure_edge_distance(row, parameter)
            matrix[i, 0], matrix[i, 1], matrix[i, 2] = nx, ny, (x * ny - y * nx) / length
            matrix[i, 3] = moves[k, i] * (
                (nx * cosine - ny * sine) * axes[k, 0] + (nx * sine + ny * cosine) * axes[k, 1]
            )
        if not known or (count == 4 and not write_inverse(matrix, inverses[k]) > 0.0):
            for i in range(count):
                ends[k, i] = edges[k, i] = nan
                for j in range(4):
                    inverses[k, j, i] = nan
