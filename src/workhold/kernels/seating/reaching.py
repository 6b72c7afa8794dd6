"""How far a part can be turned or shifted with S below a bound: paths on which no peg enters it.

A step leads farthest along the aim within a box and the linearized clearances, of which the bound of S is
one, as a step of ``closing`` leads farthest down. So a path is connected, and where it ends something holds
the part back.
"""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.closing import LEAST_GAIN, LEAST_STEP, WIDER, add_node, ahead, look_around, push_out
from workhold.kernels.seating.columns import DescentWorkSpace, Obstacles
from workhold.kernels.seating.linear_program import Four, best_step

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Steps of one path.
MOST_STEPS = 600


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
    at = add_node(config, trust, trust, nodes, first, at)
    count = push_out(config, obstacles, ahead(trust, most), work)
    if count < 0:
        return at
    for _ in range(MOST_STEPS):
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
        at = add_node(config, trust, trust, nodes, first, at)
        if reached(config, aim, obstacles.size) > far:
            break
    return at


@compiled
def reach_out(
    configs: Array,
    aims: Array,
    far: Array,
    trust: float,
    most: float,
    obstacles: Obstacles,
    work: DescentWorkSpace,
    begins: IntArray,
    nodes: Array,
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
