"""Closing the jaws without friction, and how far a part can be moved with the separation below a bound.

At a configuration (theta, x, y, S) the clearances of pegs from pieces nearby are linearized. The step that
lowers S most within a box is a linear program of four unknowns; what it enters to second order is undone by
the shortest way out. The box grows and shrinks as steps prove good. Where one peg of each jaw touches, the
step is one of Newton (``antipodal_step``). So the configuration stays free, S only falls, and the path has no
gap wider than a step.

A path that turns or shifts the part takes the steps that lead farthest along its aim, with the bound of S as
one more clearance. So it is connected too, and where it ends something holds the part back.
"""

from __future__ import annotations

from math import floor, inf, pi, sqrt

from workhold.kernels.base.compiling import (
    Array,
    ByteVector,
    IntVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.antipodal_step import antipodal_step
from workhold.kernels.seating.columns import (
    COSINE,
    MOVED,
    SINE,
    STEP,
    STEP_ALONG,
    TURNED,
    DescentWorkSpace,
    Obstacles,
)
from workhold.kernels.seating.linear_program import Four, best_step, shortest_out
from workhold.kernels.seating.obstacles import add_wall, cosine_and_sine

# How a descent ended.
GAVE_UP, AT_REST, AT_THE_STOP = 0, 1, 2
# mm. Shorter steps move nothing; pegs this deep in the part are in it; smaller gains are none.
LEAST_STEP, ENTERED, LEAST_GAIN = 1e-7, 1e-8, 1e-12
MOST_STEPS = 4000
# Of the part's size, how much farther around pegs pieces are listed than is asked for.
AROUND = 0.1
# How many times as wide a step's box is than the last, at most; half widths that a clearance falls in one.
WIDER, REACH = 3.0, 3.6
# How many times as far as is looked at a way out leads at most, which is long out of a narrow corner.
FAR = 8.0
# Steps of linear programs that follow where an antipodal step found something in the way.
WAIT = 3
# mm. Configurations as near to a seat as this, in place and in separation, go there.
SAME_PLACE, SAME_LEVEL = 1e-4, 1e-6
# The way on which S falls.
DOWN = (0.0, 0.0, 0.0, -1.0)


@inner
def remember(
    peg: int, x: float, y: float, reach: float, obstacles: Obstacles, work: DescentWorkSpace
) -> None:
    """Writes the pieces within a reach of a peg's place on the part, in their order, to a peg's list."""
    count, side = 0, obstacles.right[peg]
    for k in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
        gx, gy, far = x - obstacles.discs[k, 0], y - obstacles.discs[k, 1], obstacles.discs[k, 2] + reach
        if gx * gx + gy * gy <= far * far:
            work.lists[peg, count] = k
            count += 1
    work.places[peg, 0], work.places[peg, 1], work.places[peg, 2] = x, y, reach
    work.counts[peg] = count


@inner
def look_around(config: Array, obstacles: Obstacles, reach: float, work: DescentWorkSpace) -> int:
    """Writes the clearances of pegs from pieces within a reach; returns how many.

    Before each clearance stand its gradients over (theta size, x, y, S) in mm per mm, and after it peg and
    piece. The stop and the largest S come first, with -1 in the place of a peg.

    Pieces are listed for each peg farther around than is asked for, and listed anew where it has moved on (L.
    Verlet, Physical Review 159, 1967).
    """
    count, near = 0, work.near
    cosine, sine = cosine_and_sine(config[0], work.turn)
    if config[3] - obstacles.stop <= reach:
        near[0, 0], near[0, 1], near[0, 2], near[0, 3] = 0.0, 0.0, 0.0, 1.0
        near[0, 4] = config[3] - obstacles.stop
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
                forth = dx * row[AXIS_X] + dy * row[AXIS_Y]
                end = 3 if dy * row[AXIS_X] > dx * row[AXIS_Y] else 2
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
def push_out(config: Array, obstacles: Obstacles, reach: float, work: DescentWorkSpace) -> int:
    """Moves a configuration out of what it enters by little, by the shortest way.

    Returns how many clearances there are within a reach, or -1 where that was not possible. Where pegs are on
    both sides of what is too wide, the way out of what is linearized leads far past what was looked at.
    """
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
def is_in_one_of(config: Array, seats: Array, end: int, size: float) -> bool:
    """Whether a configuration is next to that of one of the first ``end`` seats, which are ordered by S."""
    for k in range(end - 1, -1, -1):
        if seats[k, 3] <= config[3] - SAME_LEVEL:
            break
        away = abs(config[1] - seats[k, 1]) + abs(config[2] - seats[k, 2])
        turn = config[0] - seats[k, 0]
        if away + abs(turn - 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)) * size < SAME_PLACE:
            return True
    return False


@inner
def add_node(
    config: Array, trust: float, longest: float, turn: Array, nodes: Array, first: int, at: int
) -> int:
    """Writes a configuration on a path, if there is room, with how long the next steps are.

    Returns the next number.

    The nodes of the path begin with a first one; ``turn`` is that of ``cosine_and_sine``.
    """
    if at < nodes.shape[0]:
        node = nodes[at]
        for j in range(4):
            node[j] = config[j]
        node[STEP], node[STEP_ALONG] = trust, longest
        node[COSINE], node[SINE] = cosine_and_sine(config[0], turn)
        node[TURNED] = node[MOVED] = 0.0
        if at > first:
            before = nodes[at - 1]
            node[TURNED] = before[TURNED] + abs(node[0] - before[0])
            node[MOVED] = (
                before[MOVED] + abs(node[1] - before[1]) + abs(node[2] - before[2]) + abs(node[3] - before[3])
            )
    return at + 1


@inner
def ahead(trust: float, most: float) -> float:
    """The reach around pegs that counts in the next step, after one in a box of half width ``trust``."""
    return REACH * min(WIDER * trust, most) + 1e-6


@inner
def close_one(
    config: Array,
    trust: float,
    longest: float,
    most: float,
    obstacles: Obstacles,
    seats: Array,
    work: DescentWorkSpace,
    nodes: Array,
    at: int,
) -> tuple[int, int]:
    """Closes the jaws from a configuration, in place; returns how it ended, and the next number of a node."""
    trial, wait, below, first = work.trial, 0, seats.shape[0], at
    count = push_out(config, obstacles, ahead(trust, most), work)
    if count < 0:
        return (GAVE_UP, at)
    at = add_node(config, trust, longest, work.turn, nodes, first, at)
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
        length = antipodal_step(config, count, longest, most, obstacles, work) if wait == 0 else 0.0
        if length <= 0.0:
            # What is in the way is a matter of linear programs, for a while.
            wait = WAIT if wait == 0 else wait - 1
        if length > 0.9 * longest:
            longest = min(2.0 * longest, most)
        if length != 0.0:
            for j in range(4):
                config[j] = trial[j]
            at = add_node(config, trust, longest, work.turn, nodes, first, at)
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
        at = add_node(config, trust, longest, work.turn, nodes, first, at)
    return (GAVE_UP, at)


@compiled
def close_jaws(
    configs: Matrix,
    lengths: Matrix,
    most: float,
    obstacles: Obstacles,
    seats: Matrix,
    work: DescentWorkSpace,
    ends: ByteVector,
    begins: IntVector,
    nodes: Matrix,
) -> None:
    """Closes the jaws from configurations (N, 4), in place, until nothing moves or the stop is met.

    Parameters
    ----------
    lengths : (N, 2) how long the first steps are, in mm: of linear programs, and along both faces.
    most : how long all of them are at most.
    seats : (M, 4) configurations at which closing ends, known beforehand, ordered by S.
    ends : (N,) how each ended, written here: GAVE_UP, AT_REST or AT_THE_STOP.
    begins : (N + 1,) where the nodes of each path begin and, last, end, written here.
    nodes : (M, 10) configurations after each step, with what ``columns`` says, written here as far as there
        is room.
    """
    count = 0
    for peg in range(obstacles.pegs.shape[0]):
        work.known[peg, 2] = work.places[peg, 2] = -inf
        work.known[peg, 3] = 0.0
    for k in range(configs.shape[0]):
        begins[k] = count
        ends[k], count = close_one(
            configs[k], lengths[k, 0], lengths[k, 1], most, obstacles, seats, work, nodes, count
        )
    begins[configs.shape[0]] = count


# Steps of one path.
MOST_STEPS_OUT = 600


@inner
def reached(config: Array, aim: Four, size: float) -> float:
    """How far in mm a configuration lies along an aim."""
    return aim[0] * config[0] * size + aim[1] * config[1] + aim[2] * config[2] + aim[3] * config[3]


@inner
def reach_one(
    config: Array,
    aim: Four,
    far: float,
    trust: float,
    most: float,
    obstacles: Obstacles,
    work: DescentWorkSpace,
    nodes: Array,
    at: int,
) -> int:
    """Moves a configuration along an aim, in place, until nothing leads on.

    Returns the next number of a node.
    """
    trial, first, won = work.trial, at, 0.0
    at = add_node(config, trust, trust, work.turn, nodes, first, at)
    count = push_out(config, obstacles, ahead(trust, most), work)
    if count < 0:
        return at
    for _ in range(MOST_STEPS_OUT):
        if count < 0:
            count = look_around(config, obstacles, ahead(trust, most), work)
        gain = best_step(count, trust, work, aim)
        good = gain >= LEAST_GAIN
        if good:
            trial[0] = config[0] + work.step[0] / obstacles.size
            for j in range(1, 4):
                trial[j] = config[j] + work.step[j]
            count = push_out(trial, obstacles, ahead(trust, most), work)
            won = reached(trial, aim, obstacles.size) - reached(config, aim, obstacles.size)
            good = count >= 0 and won > 0.1 * gain
        if not good:
            trust *= 0.4 if gain >= LEAST_GAIN else 0.01
            if trust < LEAST_STEP:
                break
            count = -1
            continue
        if won > 0.7 * gain:
            trust = min(WIDER * trust, most)
        for j in range(4):
            config[j] = trial[j]
        at = add_node(config, trust, trust, work.turn, nodes, first, at)
        if reached(config, aim, obstacles.size) > far:
            break
    return at


@compiled
def reach_out(
    configs: Matrix,
    aims: Matrix,
    far: Vector,
    trust: float,
    most: float,
    obstacles: Obstacles,
    work: DescentWorkSpace,
    begins: IntVector,
    nodes: Matrix,
) -> None:
    """Moves configurations (N, 4) of theta, x, y and S, in place, along aims as far as they lead.

    Parameters
    ----------
    aims : (N, 4) unit vectors of (theta size, x, y, S), in mm.
    far : (N,) how far along them in mm a way ends at the latest.
    trust, most : how long the first steps and all of them are at most, in mm.
    begins : (N + 1,) where the nodes of each path begin and, last, end, written here.
    nodes : (M, 10) configurations after each step, as of ``closing.close_jaws``, as far as there is room.
    """
    count = 0
    for peg in range(obstacles.pegs.shape[0]):
        work.places[peg, 2] = -inf
    for k in range(configs.shape[0]):
        begins[k] = count
        aim = (aims[k, 0], aims[k, 1], aims[k, 2], aims[k, 3])
        count = reach_one(configs[k], aim, far[k], trust, most, obstacles, work, nodes, count)
    begins[configs.shape[0]] = count
