"""Closing the jaws without friction, step by small step: linear programs over what pegs come near.

At a configuration (theta, x, y, S) the clearances of pegs from pieces nearby are linearized. The step that lowers S
most within a box is a linear program of four unknowns; what it enters to second order is undone by the shortest way
out. The box grows and shrinks as steps prove good. Where one peg of each jaw touches, the step is one of Newton
(``squeezing``). So the configuration stays free, S only falls, and the way has no gap wider than a step.
"""

from __future__ import annotations

from math import cos, floor, hypot, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Obstacles, WorkSpace
from workhold.kernels.seating.pieces import angle_from_middle
from workhold.kernels.seating.squeezing import squeeze
from workhold.kernels.seating.walls import add_wall

Array = NDArray[np.float64]

# How a descent ended.
GAVE_UP, AT_REST, AT_THE_STOP = 0, 1, 2
# mm. Shorter steps move nothing; pegs this deep in the part are in it; smaller gains are none.
LEAST_STEP, ENTERED, LEAST_GAIN = 1e-7, 1e-8, 1e-12
MOST_STEPS = 4000
# Steps of linear programs that follow where squeezing found something in the way.
WAIT = 3
# mm. Configurations as near to a seat as this, in place and in separation, go there.
SAME_PLACE, SAME_LEVEL = 1e-4, 1e-6


@inner
def look_around(config: Array, obstacles: Obstacles, reach: float, near: Array) -> int:
    """Write the clearances of pegs from pieces within a reach, after their gradients over (theta size, x, y, S) in mm
    per mm and before peg and piece; return how many."""
    count = 0
    cosine, sine = cos(config[0]), sin(config[0])
    for peg in range(obstacles.pegs.shape[0]):
        moving = float(obstacles.right[peg])
        qx, qy = obstacles.pegs[peg, 0] + moving * config[3] - config[1], obstacles.pegs[peg, 1] - config[2]
        x, y = cosine * qx + sine * qy, cosine * qy - sine * qx
        side = obstacles.right[peg]
        for k in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
            gx, gy, far = x - obstacles.discs[k, 0], y - obstacles.discs[k, 1], obstacles.discs[k, 2] + reach
            if gx * gx + gy * gy > far * far:
                continue
            row = obstacles.rows[k]
            dx, dy = x - row[X], y - row[Y]
            if row[IS_ARC] == 0.0:
                nx, ny = row[AXIS_Y], -row[AXIS_X]
                off, along = dx * nx + dy * ny, dx * row[AXIS_X] + dy * row[AXIS_Y]
                if abs(off) > reach:
                    continue
            else:
                size = max(hypot(dx, dy), 1e-300)
                nx, ny = row[SIGN] * dx / size, row[SIGN] * dy / size
                off = row[SIGN] * (size - row[RADIUS])
                if abs(off) > reach:
                    continue
                along = angle_from_middle(row, dx, dy) if row[HALF_EXTENT] < pi else 0.0
            if not obstacles.spans[k, 0] <= along <= obstacles.spans[k, 1] or count >= near.shape[0]:
                continue
            vx, vy = cosine * nx - sine * ny, sine * nx + cosine * ny
            near[count, 0] = (nx * y - ny * x) / obstacles.size
            near[count, 1], near[count, 2], near[count, 3], near[count, 4] = -vx, -vy, vx * moving, off
            near[count, 5], near[count, 6] = peg, k
            count += 1
    return add_wall(config, obstacles, reach, near, count)


@inner
def push_out(config: Array, obstacles: Obstacles, reach: float, work: WorkSpace) -> bool:
    """Move a configuration out of what it enters by little, by the shortest way; whether that was possible.

    The way is found by projecting on one clearance after the other (S. Kaczmarz 1937).
    """
    near, step = work.near, work.step
    for _ in range(6):
        count = look_around(config, obstacles, reach, near)
        deepest = 0.0
        for i in range(count):
            deepest = min(deepest, near[i, 4])
        if deepest > -1e-10:
            return True
        for j in range(4):
            step[j] = 0.0
        for _ in range(40):
            change = 0.0
            for i in range(count):
                value, square = near[i, 4], 0.0
                for j in range(4):
                    value += near[i, j] * step[j]
                    square += near[i, j] * near[i, j]
                if value < 1e-12:
                    by = (2e-12 - value) / square
                    change = max(change, by)
                    for j in range(4):
                        step[j] += by * near[i, j]
            if change < 1e-11:
                break
        config[0] += step[0] / obstacles.size
        for j in range(1, 4):
            config[j] += step[j]
    count = look_around(config, obstacles, reach, near)
    deepest = 0.0
    for i in range(count):
        deepest = min(deepest, near[i, 4])
    return deepest >= -ENTERED


@inner
def add_normal(number: int, count: int, place: int, work: WorkSpace) -> bool:
    """Add the normal of a clearance, or of a side of the box, to the orthonormal basis; whether it is independent."""
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
    if norm < 1e-9:
        return False
    for j in range(4):
        new[j] /= norm
    return True


@inner
def best_step(count: int, trust: float, work: WorkSpace) -> float:
    """Write the step that lowers S most within a box of half width ``trust`` and ``count`` linearized clearances; return by
    how much S falls.

    A primal active-set method: descend in the null space of the working normals to what blocks, and drop a normal that holds
    back (M. J. Best and K. Ritter, *Linear Programming: Active Set Analysis and Computer Programs*, 1985).
    """
    near, basis, triangle, step, way, members = work.near, work.basis, work.triangle, work.step, work.way, work.members
    for j in range(4):
        step[j] = 0.0
    size = 0
    for _ in range(60):
        for j in range(4):
            way[j] = -1.0 if j == 3 else 0.0
        for q in range(size):
            dot = 0.0
            for j in range(4):
                dot += basis[q, j] * way[j]
            for j in range(4):
                way[j] -= dot * basis[q, j]
        if way[0] * way[0] + way[1] * way[1] + way[2] * way[2] + way[3] * way[3] < 1e-14:
            # Multipliers by back substitution in the triangle that orthogonalizing left.
            worst, dropped = -1e-9, -1
            for q in range(size - 1, -1, -1):
                multiplier = basis[q, 3]
                for p in range(q + 1, size):
                    multiplier -= triangle[q, p] * triangle[p, 5]
                triangle[q, 5] = multiplier / triangle[q, q]
                if triangle[q, 5] < worst:
                    worst, dropped = triangle[q, 5], q
            if dropped < 0:
                break
            for q in range(dropped, size - 1):
                members[q] = members[q + 1]
            size -= 1
            for q in range(size):
                add_normal(members[q], count, q, work)
            continue
        length, blocking = inf, -1
        for i in range(count + 8):
            taken = False
            for q in range(size):
                taken = taken or members[q] == i
            if taken:
                continue
            if i < count:
                rate, room = 0.0, max(near[i, 4], 0.0)
                for j in range(4):
                    rate += near[i, j] * way[j]
                    room += near[i, j] * step[j]
            else:
                j = (i - count) // 2
                sign = 1.0 if (i - count) % 2 == 0 else -1.0
                rate, room = sign * way[j], trust + sign * step[j]
            if rate < -1e-10 and max(room, 0.0) < length * -rate:
                length, blocking = max(room, 0.0) / -rate, i
        if blocking < 0:
            break
        for j in range(4):
            step[j] += length * way[j]
        members[size] = blocking
        if add_normal(blocking, count, size, work):
            size += 1
        elif length == 0.0:
            break
    return -step[3]


@inner
def is_in_one_of(config: Array, seats: Array, size: float) -> bool:
    """Whether a configuration is as good as that of a seat."""
    for k in range(seats.shape[0]):
        if abs(config[3] - seats[k, 3]) < SAME_LEVEL:
            away = abs(config[1] - seats[k, 1]) + abs(config[2] - seats[k, 2])
            turn = config[0] - seats[k, 0]
            if away + abs(turn - 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)) * size < SAME_PLACE:
                return True
    return False


@inner
def close_one(config: Array, trust: float, most: float, obstacles: Obstacles, seats: Array, work: WorkSpace) -> int:
    """Close the jaws from a configuration, in place; how it ended."""
    trial, longest, wait = work.trial, trust, 0
    if not push_out(config, obstacles, 8.0 * trust + 1e-6, work):
        return GAVE_UP
    for _ in range(MOST_STEPS):
        if config[3] <= obstacles.stop + 1e-9:
            config[3] = obstacles.stop
            return AT_THE_STOP
        if is_in_one_of(config, seats, obstacles.size):
            return AT_REST
        count = look_around(config, obstacles, 6.0 * trust, work.near)
        length = squeeze(config, count, longest, most, obstacles, work) if wait == 0 else 0.0
        if length <= 0.0:
            # What is in the way is a matter of linear programs, for a while.
            wait = WAIT if wait == 0 else wait - 1
        if length > 0.9 * longest:
            longest = min(2.0 * longest, most)
        if length != 0.0:
            for j in range(4):
                config[j] = trial[j]
            continue
        gain = best_step(count, trust, work)
        good = gain >= LEAST_GAIN
        if good:
            trial[0] = config[0] + work.step[0] / obstacles.size
            for j in range(1, 4):
                trial[j] = config[j] + work.step[j]
            trial[3] = max(trial[3], obstacles.stop)
            good = push_out(trial, obstacles, 6.0 * trust + 1e-6, work) and trial[3] < config[3] - 0.1 * gain
        if not good:
            # Where no step leads down, no shorter one does: that is only seen again, against rounding.
            trust *= 0.4 if gain >= LEAST_GAIN else 0.01
            if trust < LEAST_STEP:
                return AT_REST
            continue
        if trial[3] < config[3] - 0.7 * gain:
            trust = min(1.6 * trust, most)
        for j in range(4):
            config[j] = trial[j]
    return GAVE_UP


@compiled
def close_jaws(
    configs: Array,
    first: float,
    most: float,
    obstacles: Obstacles,
    seats: Array,
    work: WorkSpace,
    ends: NDArray[np.int8],
) -> None:
    """Close the jaws from configurations (N, 4) of theta, x, y and S, in place, until nothing moves or the stop is met.

    Parameters
    ----------
    first, most : how long the first steps are, and all, in mm.
    seats : (M, 4) configurations at which closing ends, known beforehand.
    ends : (N,) how each ended, written here: GAVE_UP, AT_REST or AT_THE_STOP.
    """
    for k in range(configs.shape[0]):
        ends[k] = close_one(configs[k], first, most, obstacles, seats, work)
