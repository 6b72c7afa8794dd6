"""Closing of the jaws on a part without friction, and motion of a part with the jaw separation below a bound.

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
from workhold.kernels.seating.antipodal_step import write_antipodal_step
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
from workhold.kernels.seating.linear_program import Four, write_best_step, write_shortest_step_out
from workhold.kernels.seating.obstacles import add_wall, compute_cosine_and_sine

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
def remember_near_pieces(
    peg: int, x: float, y: float, reach: float, obstacles: Obstacles, work: DescentWorkSpace
) -> None:
    """List the pieces within ``reach`` mm of the point (x, y) of the part for a peg, in ascending order.

    They go to ``work.lists[peg]``, their number to ``work.counts``, the point and reach to ``work.places``.
    """
    count, side = 0, obstacles.right[peg]
    for k in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
        gx, gy, far = x - obstacles.discs[k, 0], y - obstacles.discs[k, 1], obstacles.discs[k, 2] + reach
        if gx * gx + gy * gy <= far * far:
            work.lists[peg, count] = k
            count += 1
    work.places[peg, 0], work.places[peg, 1], work.places[peg, 2] = x, y, reach
    work.counts[peg] = count


@inner
def write_near_clearances(config: Array, obstacles: Obstacles, reach: float, work: DescentWorkSpace) -> int:
    """Write the clearances of pegs from pieces within ``reach`` mm to
    ``work.near``, and return how many there are.

    Each row (7,) holds the gradient over (theta size, x, y, S) in mm per mm, the clearance in mm, peg and
    piece. The stop and the largest S come first, with -1 in place of a peg; the wall comes last. Rows beyond
    64 are left out.

    The pieces within a wider reach are listed for each peg, and listed anew when the peg has moved on (L.
    Verlet, Physical Review 159, 1967). S is the jaw separation in mm.
    """
    count, near = 0, work.near
    cosine, sine = compute_cosine_and_sine(config[0], work.turn)
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
            remember_near_pieces(peg, x, y, reach + AROUND * obstacles.size, obstacles, work)
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
def move_out_of_obstacles(config: Array, obstacles: Obstacles, reach: float, work: DescentWorkSpace) -> int:
    """Move a configuration in place, by the shortest way, out of obstacles that it enters by little.

    Return the number of clearances within ``reach`` mm, now in ``work.near``, or -1 where that was not
    possible. Such a case are pegs on both sides of something too wide: the linearized way out then leads far
    beyond the clearances that were examined. A configuration is theta in radians, x, y and the jaw separation
    S in mm.
    """
    near, step = work.near, work.step
    count, deepest = 0, 0.0
    for attempt in range(7):
        count = write_near_clearances(config, obstacles, reach, work)
        deepest = 0.0
        for i in range(count):
            deepest = min(deepest, near[i, 4])
        if deepest > -1e-10 or attempt == 6:
            break
        write_shortest_step_out(count, work)
        if step[0] * step[0] + step[1] * step[1] + step[2] * step[2] + step[3] * step[3] > (FAR * reach) ** 2:
            return -1
        config[0] += step[0] / obstacles.size
        for j in range(1, 4):
            config[j] += step[j]
    return count if deepest >= -ENTERED else -1


@inner
def is_at_a_seat(config: Array, seats: Array, end: int, size: float) -> bool:
    """Return whether a configuration is next to one of the seats
    ``seats[:end]``, which are in ascending order of S.

    Seats lower than the configuration by ``SAME_LEVEL`` or more are not examined. A configuration is theta in
    radians, x, y and the jaw separation S in mm.
    """
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
    """Append a configuration to a path as node ``at``, if ``nodes`` has room; return ``at`` + 1 in any case.

    ``first`` is the number of the path's first node; ``trust`` and ``longest`` in mm become its columns STEP
    and STEP_ALONG. ``turn`` is described at ``obstacles.compute_cosine_and_sine``. A configuration is theta
    in radians, x, y and the jaw separation S in mm. See ``seating.columns`` for the layout of ``nodes``.
    """
    if at < nodes.shape[0]:
        node = nodes[at]
        for j in range(4):
            node[j] = config[j]
        node[STEP], node[STEP_ALONG] = trust, longest
        node[COSINE], node[SINE] = compute_cosine_and_sine(config[0], turn)
        node[TURNED] = node[MOVED] = 0.0
        if at > first:
            before = nodes[at - 1]
            node[TURNED] = before[TURNED] + abs(node[0] - before[0])
            node[MOVED] = (
                before[MOVED] + abs(node[1] - before[1]) + abs(node[2] - before[2]) + abs(node[3] - before[3])
            )
    return at + 1


@inner
def compute_reach_ahead(trust: float, most: float) -> float:
    """Return the reach in mm around pegs that the next step needs,
    after one in a box of half width ``trust``.
    """
    return REACH * min(WIDER * trust, most) + 1e-6


@inner
def close_from(
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
    """Close the jaws from a configuration (4,), in place, and append
    the path to ``nodes`` from number ``at`` on.

    Return (GAVE_UP, AT_REST or AT_THE_STOP; number after the last node, which may exceed the rows of
    ``nodes``). Steps begin with ``trust`` (linear programs) and ``longest`` (along both faces), at most
    ``most``, in mm. A configuration is theta in radians, x, y and the jaw separation S in mm. See
    ``seating.columns`` for the layout of ``nodes``.
    """
    trial, wait, below, first = work.trial, 0, seats.shape[0], at
    count = move_out_of_obstacles(config, obstacles, compute_reach_ahead(trust, most), work)
    if count < 0:
        return (GAVE_UP, at)
    at = add_node(config, trust, longest, work.turn, nodes, first, at)
    for _ in range(MOST_STEPS):
        if config[3] <= obstacles.stop + 1e-9:
            config[3] = obstacles.stop
            return (AT_THE_STOP, at)
        while below > 0 and seats[below - 1, 3] >= config[3] + SAME_LEVEL:
            below -= 1
        if is_at_a_seat(config, seats, below, obstacles.size):
            return (AT_REST, at)
        if count < 0:
            count = write_near_clearances(config, obstacles, compute_reach_ahead(trust, most), work)
        length = write_antipodal_step(config, count, longest, most, obstacles, work) if wait == 0 else 0.0
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
        gain = write_best_step(count, trust, work, DOWN)
        good = gain >= LEAST_GAIN
        if good:
            trial[0] = config[0] + work.step[0] / obstacles.size
            for j in range(1, 4):
                trial[j] = config[j] + work.step[j]
            count = move_out_of_obstacles(trial, obstacles, compute_reach_ahead(trust, most), work)
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
    """Close the jaws from configurations (N, 4), in place, until nothing moves or the stop is met.

    See ``seating.columns`` for the layout of ``nodes``. S is the jaw separation in mm.

    Parameters
    ----------
    configs : (N, 4) theta, x, y, S, each replaced by the end of its path.
    lengths : (N, 2) lengths of the first steps, in mm: of linear programs, and along both faces.
    most : greatest length of all steps, in mm.
    seats : (M, 4) configurations at which closing ends, known beforehand, in ascending order of S.
    ends : (N,) receives how each path ended: GAVE_UP, AT_REST or AT_THE_STOP.
    begins : (N + 1,) receives the number of the first node of each path and, last, the total number of nodes.
    nodes : (M, 10) receives the configurations after each step, see ``columns``, as far as there is room.
    """
    count = 0
    for peg in range(obstacles.pegs.shape[0]):
        work.known[peg, 2] = work.places[peg, 2] = -inf
        work.known[peg, 3] = 0.0
    for k in range(configs.shape[0]):
        begins[k] = count
        ends[k], count = close_from(
            configs[k], lengths[k, 0], lengths[k, 1], most, obstacles, seats, work, nodes, count
        )
    begins[configs.shape[0]] = count


# Steps of one path.
MOST_STEPS_OUT = 600


@inner
def measure_along_aim(config: Array, aim: Four, size: float) -> float:
    """Return the scalar product in mm of a configuration (theta size, x, y, S) with the unit vector ``aim``.

    S is the jaw separation in mm.
    """
    return aim[0] * config[0] * size + aim[1] * config[1] + aim[2] * config[2] + aim[3] * config[3]


@inner
def move_one_along_aim(
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
    """Move a configuration (4,) along an aim, in place, until no step
    leads on or it has gone farther than ``far`` mm.

    Append the path to ``nodes`` from number ``at`` on, and return the number after its last node. A
    configuration is theta in radians, x, y and the jaw separation S in mm. See ``seating.columns`` for the
    layout of ``nodes``.
    """
    trial, first, won = work.trial, at, 0.0
    at = add_node(config, trust, trust, work.turn, nodes, first, at)
    count = move_out_of_obstacles(config, obstacles, compute_reach_ahead(trust, most), work)
    if count < 0:
        return at
    for _ in range(MOST_STEPS_OUT):
        if count < 0:
            count = write_near_clearances(config, obstacles, compute_reach_ahead(trust, most), work)
        gain = write_best_step(count, trust, work, aim)
        good = gain >= LEAST_GAIN
        if good:
            trial[0] = config[0] + work.step[0] / obstacles.size
            for j in range(1, 4):
                trial[j] = config[j] + work.step[j]
            count = move_out_of_obstacles(trial, obstacles, compute_reach_ahead(trust, most), work)
            won = measure_along_aim(trial, aim, obstacles.size) - measure_along_aim(
                config, aim, obstacles.size
            )
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
        if measure_along_aim(config, aim, obstacles.size) > far:
            break
    return at


@compiled
def move_along_aims(
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
    """Move configurations (N, 4) of theta, x, y and S along aims, in place, as far as steps lead.

    See ``seating.columns`` for the layout of ``nodes``. S is the jaw separation in mm.

    Parameters
    ----------
    aims : (N, 4) unit vectors of (theta size, x, y, S), in mm.
    far : (N,) coordinate along the aim in mm, see :func:`measure_along_aim`, beyond which a path ends.
    trust, most : greatest length of the first steps and of all steps, in mm.
    begins : (N + 1,) receives the number of the first node of each path and, last, the total number of nodes.
    nodes : (M, 10) receives the configurations after each step, see ``columns``, as far as there is room.
    """
    count = 0
    for peg in range(obstacles.pegs.shape[0]):
        work.places[peg, 2] = -inf
    for k in range(configs.shape[0]):
        begins[k] = count
        aim = (aims[k, 0], aims[k, 1], aims[k, 2], aims[k, 3])
        count = move_one_along_aim(configs[k], aim, far[k], trust, most, obstacles, work, nodes, count)
    begins[configs.shape[0]] = count
