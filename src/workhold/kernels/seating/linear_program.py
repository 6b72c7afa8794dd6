"""The linear programs of a step: the step farthest along an aim, and the shortest step out of obstacles.

A step is in four unknowns, (theta size, x, y, S), within a box and clearances that are linearized.
"""

from __future__ import annotations

from math import inf, sqrt

from workhold.kernels.base.compiling import inner
from workhold.kernels.seating.columns import DescentWorkSpace

Four = tuple[float, float, float, float]

# mm. What is entered by less is not; how often what is met may change on one way out.
BESIDE_NOTHING, MOST_CHANGES = 1e-12, 40
# No unit. Directions that come nearer to something by less than this share go along it.
ALONG = 1e-10


@inner
def add_normal(number: int, count: int, place: int, work: DescentWorkSpace) -> bool:
    """Orthogonalize the normal of a constraint against the first
    ``place`` rows of the basis, and write it as row ``place``.

    Constraint ``number`` is a clearance below ``count``, and a side of the box from ``count`` on: count + 2 j
    bounds unknown j from below, count + 2 j + 1 from above. Return whether the normal is independent of the
    rows before.
    """
    new, triangle = work.basis[place], work.triangle
    for j in range(4):
        new[j] = work.near[number, j] if number < count else 0.0
    if number >= count:
        new[(number - count) // 2] = 1.0 if (number - count) % 2 == 0 else -1.0
    for p in range(place):
        dot = 0.0
        for j in range(4):
            dot += work.basis[p, j] * new[j]
        triangle[p, place] = dot
        for j in range(4):
            new[j] -= dot * work.basis[p, j]
    norm = sqrt(new[0] * new[0] + new[1] * new[1] + new[2] * new[2] + new[3] * new[3])
    triangle[place, place] = norm
    if norm < 1e-9 or place == 4:
        # There are four unknowns: what a fifth has left is rounding.
        return False
    for j in range(4):
        new[j] /= norm
    return True


@inner
def write_shortest_step_out(count: int, work: DescentWorkSpace) -> None:
    """Write the shortest step with which all of ``count`` linearized
    clearances are non-negative to ``work.step``.

    Where there is no such step, the last step of the method is left. A dual active-set method: begin with no
    step, move to the constraint that is violated most while keeping to the constraints met before, and drop a
    constraint whose multiplier becomes negative (D. Goldfarb and A. Idnani, Mathematical Programming 27,
    1983).
    """
    near, basis, triangle, step, way = work.near, work.basis, work.triangle, work.step, work.way
    members = work.members
    for j in range(4):
        step[j] = 0.0
    size, entered, pressed = 0, -1, 0.0
    for _ in range(MOST_CHANGES):
        if entered < 0:
            deepest = BESIDE_NOTHING
            for i in range(count):
                value = near[i, 4]
                for j in range(4):
                    value += near[i, j] * step[j]
                if value < deepest:
                    deepest, entered = value, i
            if entered < 0:
                return
            pressed = 0.0
        independent = add_normal(entered, count, size, work)
        norm, missing = triangle[size, size], 2.0 * BESIDE_NOTHING - near[entered, 4]
        for j in range(4):
            missing -= near[entered, j] * step[j]
        # How fast the forces of the others fall as that of the new one grows, and which is gone first.
        length, gone = inf, -1
        for q in range(size - 1, -1, -1):
            way[q] = triangle[q, size]
            for p in range(q + 1, size):
                way[q] -= triangle[q, p] * way[p]
            way[q] /= triangle[q, q]
            if way[q] > 1e-12 and triangle[q, 5] < length * way[q]:
                length, gone = triangle[q, 5] / way[q], q
        if independent and missing <= length * norm * norm:
            length, gone = missing / (norm * norm), -1
        elif gone < 0:
            return
        pressed += length
        for q in range(size):
            triangle[q, 5] -= length * way[q]
        for j in range(4):
            step[j] += length * norm * basis[size, j] if independent else 0.0
        if gone < 0:
            members[size], triangle[size, 5] = entered, pressed
            size, entered = size + 1, -1
            continue
        for q in range(gone, size - 1):
            members[q], triangle[q, 5] = members[q + 1], triangle[q + 1, 5]
        size -= 1
        for q in range(size):
            add_normal(members[q], count, q, work)


@inner
def project_aim(work: DescentWorkSpace, size: int, aim: Four) -> Four:
    """Return the projection of the aim on the directions orthogonal to
    the first ``size`` rows of the basis, not normalized.
    """
    basis = work.basis
    wx, wy, wz, ws = aim
    for q in range(size):
        dot = basis[q, 0] * wx + basis[q, 1] * wy + basis[q, 2] * wz + basis[q, 3] * ws
        wx -= dot * basis[q, 0]
        wy -= dot * basis[q, 1]
        wz -= dot * basis[q, 2]
        ws -= dot * basis[q, 3]
    return (wx, wy, wz, ws)


@inner
def find_strongest_normal(work: DescentWorkSpace, size: int, aim: Four) -> int:
    """Return the row of the basis (see :func:`add_normal`) whose constraint has the most negative multiplier;
    -1 for none.

    That constraint only holds back the step along ``aim`` and is to be dropped. Multipliers come by back
    substitution in ``work.triangle`` and are written to its column 5; ``size`` is the number of rows of the
    basis in use.
    """
    basis, triangle = work.basis, work.triangle
    worst, dropped = -1e-9, -1
    for q in range(size - 1, -1, -1):
        multiplier = -(
            aim[0] * basis[q, 0] + aim[1] * basis[q, 1] + aim[2] * basis[q, 2] + aim[3] * basis[q, 3]
        )
        for p in range(q + 1, size):
            multiplier -= triangle[q, p] * triangle[p, 5]
        triangle[q, 5] = multiplier / triangle[q, q]
        if triangle[q, 5] < worst:
            worst, dropped = triangle[q, 5], q
    return dropped


@inner
def find_first_block(
    count: int, trust: float, step: Four, way: Four, taken: int, work: DescentWorkSpace
) -> tuple[float, int]:
    """Return (how far a step can go on in the direction ``way``, number of the constraint that ends it).

    The result is (inf, -1) where nothing ends it. Constraints are numbered as in :func:`add_normal`; ``step``
    is the step so far; bit i of ``taken`` is set for each clearance i that does not change along ``way``,
    which is not examined.
    """
    near, length, blocking = work.near, inf, -1
    for i in range(count):
        if taken >> i & 1:
            continue
        rate = near[i, 0] * way[0] + near[i, 1] * way[1] + near[i, 2] * way[2] + near[i, 3] * way[3]
        if rate < -ALONG:
            room = max(near[i, 4], 0.0) + near[i, 0] * step[0] + near[i, 1] * step[1]
            room = max(room + near[i, 2] * step[2] + near[i, 3] * step[3], 0.0)
            if room < length * -rate:
                length, blocking = room / -rate, i
    for j in range(4):
        # A side that the way keeps it does not come nearer to.
        rate = -abs(way[j])
        if rate < -ALONG:
            room = max(trust - step[j] if way[j] > 0.0 else trust + step[j], 0.0)
            if room < length * -rate:
                length, blocking = room / -rate, count + 2 * j + (1 if way[j] > 0.0 else 0)
    return (length, blocking)


@inner
def write_best_step(count: int, trust: float, work: DescentWorkSpace, aim: Four) -> float:
    """Write the step that leads farthest along ``aim`` to ``work.step``
    (theta size, x, y, S), and return how far in mm.

    It stays within a box of half width ``trust`` mm and ``count`` linearized clearances; ``aim`` is a unit
    vector.

    A primal active-set method: move in the null space of the active constraints' normals until another
    constraint blocks, and drop a constraint that only holds the step back (M. J. Best and K. Ritter, *Linear
    Programming: Active Set Analysis and Computer Programs*, 1985). S is the jaw separation in mm.
    """
    step, members = (0.0, 0.0, 0.0, 0.0), work.members
    size, taken = 0, 0
    for _ in range(60):
        way = project_aim(work, size, aim)
        if way[0] * way[0] + way[1] * way[1] + way[2] * way[2] + way[3] * way[3] < 1e-14:
            dropped = find_strongest_normal(work, size, aim)
            if dropped < 0:
                break
            if members[dropped] < count:
                taken ^= 1 << members[dropped]
            for q in range(dropped, size - 1):
                members[q] = members[q + 1]
            size -= 1
            for q in range(size):
                add_normal(members[q], count, q, work)
            continue
        length, blocking = find_first_block(count, trust, step, way, taken, work)
        if blocking < 0:
            break
        step = (
            step[0] + length * way[0],
            step[1] + length * way[1],
            step[2] + length * way[2],
            step[3] + length * way[3],
        )
        members[size] = blocking
        if add_normal(blocking, count, size, work):
            taken |= 1 << blocking if blocking < count else 0
            size += 1
        elif length == 0.0:
            break
    for j in range(4):
        work.step[j] = step[j]
    return aim[0] * step[0] + aim[1] * step[1] + aim[2] * step[2] + aim[3] * step[3]
