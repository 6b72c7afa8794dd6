"""Loose sets: what lies in which, each once, and where ways off them begin."""

from __future__ import annotations

from math import hypot, inf, pi

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import CONTACTS, SEPARATION, Families
from workhold.kernels.seating.pieces import length

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. How much farther than to the next of its steps a place may be from a set in which it lies.
BESIDE = 0.02
# Contacts that a candidate has at most.
MOST_CONTACTS = 4


@inner
def longest_step(sets: Array, begin: int, end: int, arm: float) -> float:
    """The longest in mm of the steps along a set."""
    longest = 0.0
    for n in range(begin + 1, end):
        dx, dy = sets[n, 1] - sets[n - 1, 1], sets[n, 2] - sets[n - 1, 2]
        longest = max(longest, abs(sets[n, 0] - sets[n - 1, 0]) * arm + abs(dx) + abs(dy))
    return longest


@inner
def lies_in(config: Array, families: Families, number: int, arm: float, most: float) -> bool:
    """Whether a configuration (4,) is as near to one of a set's as these are to each other.

    Parameters
    ----------
    arm : in mm, by which turns are counted.
    most : by how much in mm the separation may differ.
    """
    if not abs(config[3] - families.rows[number, SEPARATION]) < most:
        return False
    sets, nearest = families.configs, inf
    begin, end = families.begins[number], families.begins[number + 1]
    for n in range(begin, end):
        turn = (sets[n, 0] - config[0] + pi) % (2.0 * pi) - pi
        nearest = min(nearest, abs(turn) * arm + length(sets[n, 1] - config[1], sets[n, 2] - config[2]))
    return nearest <= BESIDE or nearest <= longest_step(sets, begin, end, arm) + BESIDE


@inner
def first_of(config: Array, families: Families, asked: IntArray, arm: float, most: float) -> int:
    """The place among those asked of, by their numbers, of the first set in which a configuration lies; -1 where none is."""
    for k in range(asked.shape[0]):
        if lies_in(config, families, asked[k], arm, most):
            return k
    return -1


@compiled
def first_sets(configs: Array, families: Families, asked: IntArray, arm: float, most: float, out: IntArray) -> None:
    """Write ``first_of`` of configurations (N, 4) to ``out`` (N,)."""
    for n in range(configs.shape[0]):
        out[n] = first_of(configs[n], families, asked, arm, most)


@inner
def write_set(families: Families, number: int, out: Families, at: int) -> None:
    """Write one of some sets in a place among others, after those before it."""
    begin, to = families.begins[number], out.begins[at]
    for j in range(families.rows.shape[1]):
        out.rows[at, j] = families.rows[number, j]
    for n in range(families.begins[number + 1] - begin):
        for j in range(4):
            out.configs[to + n, j] = families.configs[begin + n, j]
    out.begins[at + 1] = to + families.begins[number + 1] - begin
    out.closed[at] = families.closed[number]
    out.across[at, 0], out.across[at, 1] = families.across[number, 0], families.across[number, 1]


@compiled
def write_each_once(families: Families, arm: float, most: float, out: Families) -> int:
    """Write sets, of those that lie in each other the one with the most contacts; how many they are.

    Parameters
    ----------
    arm, most : as of ``lies_in``, of the middle of one in the other.
    out : written here, by the number of their contacts.
    """
    count = 0
    for contacts in range(MOST_CONTACTS, -1, -1):
        for number in range(families.rows.shape[0]):
            if families.rows[number, CONTACTS] == contacts:
                is_new = True
                for k in range(count):
                    if lies_in(families.rows[number], out, k, arm, most):
                        is_new = False
                        break
                if is_new:
                    write_set(families, number, out, count)
                    count += 1
    return count


@compiled
def write_beyond(families: Families, arm: float, step: float, configs: Array, whose: IntArray) -> int:
    """Write configurations just beyond both ends of each set, or to both sides of the middle of one that gives way, and none
    of a whole turn; how many they are.

    Parameters
    ----------
    arm : in mm, by which turns are counted.
    step : how far beyond, in mm.
    configs, whose : (2 F, 4) and (2 F,) written here, the latter the numbers of the sets.
    """
    count = 0
    for number in range(families.rows.shape[0]):
        begin, end = families.begins[number], families.begins[number + 1]
        gives = families.across[number, 0] == families.across[number, 0]
        if not gives and (families.closed[number] != 0 or end - begin < 3):
            continue
        for side in range(2):
            config = configs[count]
            # The end may be the same as the configuration before it, but not as the one before that.
            at, before = (begin, begin + 2) if side == 0 else (end - 1, end - 3)
            turn = (families.configs[at, 0] - families.configs[before, 0] + pi) % (2.0 * pi) - pi
            dx = families.configs[at, 1] - families.configs[before, 1]
            dy = families.configs[at, 2] - families.configs[before, 2]
            away = abs(turn) * arm + hypot(dx, dy)
            for j in range(4):
                config[j] = families.rows[number, j] if gives else families.configs[at, j]
            if gives:
                sign = 1.0 if side == 0 else -1.0
                config[1] += sign * (step * families.across[number, 0])
                config[2] += sign * (step * families.across[number, 1])
            elif away > 0.0:
                config[0] += step * turn / away
                config[1] += step * dx / away
                config[2] += step * dy / away
            if gives or away > 0.0:
                whose[count] = number
                count += 1
    return count
