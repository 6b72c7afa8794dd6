"""Closing the jaws without friction, step by small step: linear programs over what pegs come near.

At a configuration (theta, x, y, S) the clearances of pegs from pieces nearby are linearized. The step that lowers S
most within a box is a linear program of four unknowns; what it enters to second order is undone by the shortest way
out. The box grows and shrinks as steps prove good. Where one peg of each jaw touches, the step is one of Newton
(``squeezing``). So the configuration stays free, S only falls, and the way has no gap wider than a step.
"""

from __future__ import annotations

from math import cos, floor, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import COSINE, MOVED, SINE, STEP, STEP_ALONG, TURNED, Obstacles, WorkSpace
from workhold.kernels.seating.squeezing import squeeze
from workhold.kernels.seating.walls import add_wall

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Four = tuple[float, float, float, float]

# How a descent ended.
GAVE_UP, AT_REST, AT_THE_STOP = 0, 1, 2
# mm. Shorter steps move nothing; pegs this deep in the part are in it; smaller gains are none.
LEAST_STEP, ENTERED, LEAST_GAIN = 1e-7, 1e-8, 1e-12
MOST_STEPS = 4000
# Of the part's size, how much farther around pegs pieces are listed than is asked for.
AROUND = 0.1
# How many times as wide as the one before a step's box is at most, and how many half widths a clearance falls within one.
WIDER, REACH = 3.0, 3.6
# mm. What is entered by less is not; how often what is met may change on one way out.
BESIDE_NOTHING, MOST_CHANGES = 1e-12, 40
# How many times as far as is looked at a way out leads at most: out of a narrow corner it is longer than what is entered.
FAR = 8.0
# No unit. Ways that come nearer to something by less than this share go along it.
ALONG = 1e-10
# Steps of linear programs that follow where squeezing found something in the way.
WAIT = 3
# mm. Configurations as near to a seat as this, in place and in separation, go there.
SAME_PLACE, SAME_LEVEL = 1e-4, 1e-6
# The way on which S falls.
DOWN = (0.0, 0.0, 0.0, -1.0)


@inner
def remember(peg: int, x: float, y: float, reach: float, obstacles: Obstacles, work: WorkSpace) -> None:
    """Write the pieces within a reach of a peg's place on the part, in their order, to a peg's list."""
    count, side = 0, obstacles.right[peg]
    for k in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
        gx, gy, far = x - obstacles.discs[k, 0], y - obstacles.discs[k, 1], obstacles.discs[k, 2] + reach
        if gx * gx + gy * gy <= far * far:
            work.lists[peg, count] = k
            count += 1
    work.places[peg, 0], work.places[peg, 1], work.places[peg, 2] = x, y, reach
    work.counts[peg] = count


@inner
def look_around(config: Array, obstacles: Obstacles, reach: float, work: WorkSpace) -> int:
    """Write the clearances of pegs from pieces within a reach, after their gradients over (theta size, x, y, S) in mm
    per mm and before peg and piece; return how many. The stop and the most come first,
    with -1 in the place of a peg.

    Pieces are listed for each peg farther around than is asked for, and listed anew where it has moved on (L. Verlet,
    Physical Review 159, 1967).
    """
    count, near = 0, work.near
    cosine, sine = cos(config[0]), sin(config[0])
    if config[3] - obstacles.stop <= reach:
        near[0, 0], near[0, 1], near[0, 2], near[0, 3], near[0, 4] = 0.0, 0.0, 0.0, 1.0, config[3] - obstacles.stop
        near[0, 5], near[0, 6] = -1.0, -1.0
        count = 1
    if obstacles.most - config[3] <= reach:
        near[count, 0], near[count, 1], near[count, 2], near[count, 3] = 0.0, 0.0, 0.0, -1.0
        near[count, 4], near[count, 5], near[count, 6] = obstacles.most - config[3], -1.0, -1.0
        count += 1
    for peg in range(obstacles.pegs.shape[0]):
        moving = float(obstacles.right[peg])
        qx, qy = obstacles.pegs[peg, 0] + moving * config[3] - config[1], obstacles.pegs[peg, 1] - config[2]
        x, y = cosine * qx + sine * qy, cosine * qy - sine * qx
        gx, gy, left = x - work.places[peg, 0], y - work.places[peg, 1], work.places[peg, 2] - reach
        if left < 0.0 or gx * gx + gy * gy > left * left:
            remember(peg, x, y, reach + AROUND * obstacles.size, obstacles, work)
        for i in range(work.counts[peg]):
            k = work.lists[peg, i]
            row = obstacles.rows[k]
            dx, dy = x - row[X], y - row[Y]
            if row[IS_ARC] == 0.0:
                nx, ny = row[AXIS_Y], -row[AXIS_X]
                off, along = dx * nx + dy * ny, dx * row[AXIS_X] + dy * row[AXIS_Y]
                if abs(off) > reach or not obstacles.spans[k, 0] <= along <= obstacles.spans[k, 1]:
                    continue
            else:
                size = max(sqrt(dx * dx + dy * dy), 1e-150)
                nx, ny = row[SIGN] * dx / size, row[SIGN] * dy / size
                off = row[SIGN] * (size - row[RADIUS])
                if abs(off) > reach:
                    continue
                # An angle from the middle is less than another where its cosine is more.
                forth, end = dx * row[AXIS_X] + dy * row[AXIS_Y], 3 if dy * row[AXIS_X] > dx * row[AXIS_Y] else 2
                if row[HALF_EXTENT] < pi and forth < size * obstacles.spans[k, end]:
                    continue
            if count >= near.shape[0]:
                continue
            vx, vy = cosine * nx - sine * ny, sine * nx + cosine * ny
            near[count, 0] = (nx * y - ny * x) / obstacles.size
            near[count, 1], near[count, 2], near[count, 3], near[count, 4] = -vx, -vy, vx * moving, off
            near[count, 5], near[count, 6] = peg, k
            count += 1
    return add_wall(config, obstacles, reach, near, count)


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
    if norm < 1e-9 or place == 4:
        # There are four unknowns: what a fifth has left is rounding.
        return False
    for j in range(4):
        new[j] /= norm
    return True


@inner
def shortest_out(count: int, work: WorkSpace) -> None:
    """Write the shortest step after which all of ``count`` linearized clearances are kept, as far as there is one.

    A dual active-set method: from no step at all, to what is entered deepest, along the others that were met, of which one
    is let go that would pull (D. Goldfarb and A. Idnani, Mathematical Programming 27, 1983).
    """
    near, basis, triangle, step, way, members = work.near, work.basis, work.triangle, work.step, work.way, work.members
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
def push_out(config: Array, obstacles: Obstacles, reach: float, work: WorkSpace) -> int:
    """Move a configuration out of what it enters by little, by the shortest way; how many clearances there are within a
    reach, or -1 where that was not possible: where pegs are on both sides of what is too wide, the way out of what is
    linearized leads far beyond what was looked at."""
    near, step = work.near, work.step
    count, deepest = 0, 0.0
    for attempt in range(7):
        count = look_around(config, obstacles, reach, work)
        deepest = 0.0
        for i in range(count):
            deepest = min(deepest, near[i, 4])
        if deepest > -1e-10 or attempt == 6:
            break
        shortest_out(count, work)
        if step[0] * step[0] + step[1] * step[1] + step[2] * step[2] + step[3] * step[3] > (FAR * reach) ** 2:
            return -1
        config[0] += step[0] / obstacles.size
        for j in range(1, 4):
            config[j] += step[j]
    return count if deepest >= -ENTERED else -1


@inner
def way_left(work: WorkSpace, size: int, aim: Four) -> Four:
    """The way that leads farthest along the aim of those that ``size`` normals of the basis leave."""
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
def holding_back(work: WorkSpace, size: int, aim: Four) -> int:
    """The place of the working normal that pulls most, -1 where none does: multipliers by back substitution in the triangle
    that orthogonalizing left."""
    basis, triangle = work.basis, work.triangle
    worst, dropped = -1e-9, -1
    for q in range(size - 1, -1, -1):
        multiplier = -(aim[0] * basis[q, 0] + aim[1] * basis[q, 1] + aim[2] * basis[q, 2] + aim[3] * basis[q, 3])
        for p in range(q + 1, size):
            multiplier -= triangle[q, p] * triangle[p, 5]
        triangle[q, 5] = multiplier / triangle[q, q]
        if triangle[q, 5] < worst:
            worst, dropped = triangle[q, 5], q
    return dropped


@inner
def first_to_block(count: int, trust: float, step: Four, way: Four, taken: int, work: WorkSpace) -> tuple[float, int]:
    """How far a step can go on along a way, and the clearance or, from ``count`` on, the side of the box that ends it, -1
    where none does; ``taken`` has a bit for each clearance that the way keeps."""
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
def best_step(count: int, trust: float, work: WorkSpace, aim: Four) -> float:
    """Write the step that leads farthest along a unit vector, of (theta size, x, y, S), within a box of half width ``trust``
    and ``count`` linearized clearances; return how far along it.

    A primal active-set method: descend in the null space of the working normals to what blocks, and drop a normal that holds
    back (M. J. Best and K. Ritter, *Linear Programming: Active Set Analysis and Computer Programs*, 1985).
    """
    step, members = (0.0, 0.0, 0.0, 0.0), work.members
    size, taken = 0, 0
    for _ in range(60):
        way = way_left(work, size, aim)
        if way[0] * way[0] + way[1] * way[1] + way[2] * way[2] + way[3] * way[3] < 1e-14:
            dropped = holding_back(work, size, aim)
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
        length, blocking = first_to_block(count, trust, step, way, taken, work)
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


@inner
def is_in_one_of(config: Array, seats: Array, end: int, size: float) -> bool:
    """Whether a configuration is as good as that of one of the first ``end`` seats, which are ordered by S."""
    for k in range(end - 1, -1, -1):
        if seats[k, 3] <= config[3] - SAME_LEVEL:
            break
        away = abs(config[1] - seats[k, 1]) + abs(config[2] - seats[k, 2])
        turn = config[0] - seats[k, 0]
        if away + abs(turn - 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)) * size < SAME_PLACE:
            return True
    return False


@inner
def add_node(config: Array, trust: float, longest: float, nodes: Array, first: int, at: int) -> int:
    """Write a configuration on a way whose nodes begin with a first one, if there is room, and how long the next steps from
    it are; the next number."""
    if at < nodes.shape[0]:
        node = nodes[at]
        for j in range(4):
            node[j] = config[j]
        node[STEP], node[STEP_ALONG] = trust, longest
        node[COSINE], node[SINE] = cos(config[0]), sin(config[0])
        node[TURNED] = node[MOVED] = 0.0
        if at > first:
            before = nodes[at - 1]
            node[TURNED] = before[TURNED] + abs(node[0] - before[0])
            node[MOVED] = before[MOVED] + abs(node[1] - before[1]) + abs(node[2] - before[2]) + abs(node[3] - before[3])
    return at + 1


@inner
def ahead(trust: float, most: float) -> float:
    """How far around pegs what is near counts in the next step, after one in a box of half width ``trust``."""
    return REACH * min(WIDER * trust, most) + 1e-6


@inner
def close_one(
    config: Array,
    trust: float,
    longest: float,
    most: float,
    obstacles: Obstacles,
    seats: Array,
    work: WorkSpace,
    nodes: Array,
    at: int,
) -> tuple[int, int]:
    """Close the jaws from a configuration, in place; how it ended, and the number after that of the last node."""
    trial, wait, below, first = work.trial, 0, seats.shape[0], at
    count = push_out(config, obstacles, ahead(trust, most), work)
    if count < 0:
        return (GAVE_UP, at)
    at = add_node(config, trust, longest, nodes, first, at)
    for _ in range(MOST_STEPS):
        if config[3] <= obstacles.stop + 1e-9:
            config[3] = obstacles.stop
            return (AT_THE_STOP, at)
        while below > 0 and seats[below - 1, 3] >= config[3] + SAME_LEVEL:
            below -= 1
        if is_in_one_of(config, seats, below, obstacles.size):
            return (AT_REST, at)
        if count < 0:
            count = look_around(config, obstacles, ahead(trust, most), work)
        length = squeeze(config, count, longest, most, obstacles, work) if wait == 0 else 0.0
        if length <= 0.0:
            # What is in the way is a matter of linear programs, for a while.
            wait = WAIT if wait == 0 else wait - 1
        if length > 0.9 * longest:
            longest = min(2.0 * longest, most)
        if length != 0.0:
            for j in range(4):
                config[j] = trial[j]
            at = add_node(config, trust, longest, nodes, first, at)
            count = -1
            continue
        gain = best_step(count, trust, work, DOWN)
        good = gain >= LEAST_GAIN
        if good:
            trial[0] = config[0] + work.step[0] / obstacles.size
            for j in range(1, 4):
                trial[j] = config[j] + work.step[j]
            count = push_out(trial, obstacles, ahead(trust, most), work)
            good = count >= 0 and trial[3] < config[3] - 0.1 * gain
        if not good:
            # Where no step leads down, no shorter one does: that is only seen again, against rounding.
            trust *= 0.4 if gain >= LEAST_GAIN else 0.01
            if trust < LEAST_STEP:
                return (AT_REST, at)
            count = -1
            continue
        if trial[3] < config[3] - 0.7 * gain:
            trust = min(WIDER * trust, most)
        for j in range(4):
            config[j] = trial[j]
        longest = max(longest, trust)
        at = add_node(config, trust, longest, nodes, first, at)
    return (GAVE_UP, at)


@compiled
def close_jaws(
    configs: Array,
    lengths: Array,
    most: float,
    obstacles: Obstacles,
    seats: Array,
    work: WorkSpace,
    ends: NDArray[np.int8],
    begins: IntArray,
    nodes: Array,
) -> None:
    """Close the jaws from configurations (N, 4) of theta, x, y and S, in place, until nothing moves or the stop is met.

    Parameters
    ----------
    lengths : (N, 2) how long the first steps are, in mm: of linear programs, and along both faces.
    most : how long all of them are at most.
    seats : (M, 4) configurations at which closing ends, known beforehand, ordered by S.
    ends : (N,) how each ended, written here: GAVE_UP, AT_REST or AT_THE_STOP.
    begins : (N + 1,) where the nodes of each way begin and, last, end, written here.
    nodes : (M, 10) configurations after each step, with what ``columns`` says, written here as far as there is room.
    """
    count = 0
    for peg in range(obstacles.pegs.shape[0]):
        work.known[peg, 2] = work.places[peg, 2] = -inf
        work.known[peg, 3] = 0.0
    for k in range(configs.shape[0]):
        begins[k] = count
        ends[k], count = close_one(configs[k], lengths[k, 0], lengths[k, 1], most, obstacles, seats, work, nodes, count)
    begins[configs.shape[0]] = count
