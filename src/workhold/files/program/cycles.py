"""Drill cycles as the moves that they make.

Pecks (Q) go up and down between the plane R and the bottom. One move down and one up sweep the same, and
stand for all of them.
"""

from __future__ import annotations

from workhold.errors import InputError
from workhold.files.program.path import DIGITS, PathWriter

__all__ = ["drill"]

MOST_REPEATS = 10_000
PECKING = ("73", "83")


def drill(path: PathWriter, values: dict[str, float]) -> set[str]:
    """Drills a hole, or a row of them in increments: over it, down to R, to Z at the feed, and up again.

    Returns
    -------
    set
        The letters that have a meaning.

    Raises
    ------
    InputError
        For a cycle that lacks something, or that controls read in different ways.
    """
    modes = path.modes
    bottom, plane = depths(path, values)
    for _ in range(repeats(path, values)):
        x, y, z = path.target({key: values[key] for key in ("X", "Y") if key in values})
        if x is None or y is None:
            raise InputError("a hole is drilled at a place that the program does not say: write X and Y.")
        path.move_to([x, y, z], cutting=False)
        path.move_to([x, y, plane], cutting=False)
        path.move_to([x, y, bottom], cutting=True)
        up = modes.initial if modes.back == "98" else plane
        path.move_to([x, y, up], cutting=False)
    return {"X", "Y", "Z", "R", "Q", "P", "L", "K"}


def depths(path: PathWriter, values: dict[str, float]) -> tuple[float, float]:
    """Heights of the hole's bottom and of the plane R in mm; those that a block does not give stay in force.

    Raises
    ------
    InputError
        Where one is missing, or they do not follow each other downward.
    """
    modes, sticky = path.modes, path.modes.sticky
    if modes.plane != "17":
        raise InputError(f"a drill cycle stands in the plane G{modes.plane}: write G17 before it.")
    initial, now = modes.initial, modes.place[2]
    if initial is None or now is None:
        raise InputError(
            "a drill cycle begins at a height that the program does not say: write G0 with Z before it."
        )
    if modes.distance == "91":
        if now != initial:
            raise InputError(
                "a drill cycle in increments (G91) goes on at the plane R (G99), which controls read in "
                "different ways: write it after G90."
            )
        if "R" in values:
            sticky["R"] = initial + path.length(values["R"])
        if "Z" in values and "R" in sticky:
            sticky["Z"] = sticky["R"] + path.length(values["Z"])
    else:
        sticky.update({key: path.length(values[key]) for key in "RZ" if key in values})
    for key, what in (("R", "the plane to which it returns"), ("Z", "the bottom of its hole")):
        if key not in sticky:
            raise InputError(f"a drill cycle has no {key}, {what}: write it.")
    if "Q" in values:
        sticky["Q"] = values["Q"]
    if modes.cycle in PECKING and not sticky.get("Q", 0.0) > 0.0:
        raise InputError(f"G{modes.cycle} has no Q, the depth of a peck: write one above 0.")
    bottom, plane = round(sticky["Z"], DIGITS), round(sticky["R"], DIGITS)
    if bottom > plane:
        raise InputError("the bottom Z of a hole is above the plane R of its cycle: correct them.")
    if now < plane:
        raise InputError(
            "a drill cycle begins below its plane R, where controls go different ways: write G0 with a Z "
            "above R before it."
        )
    return bottom, plane


def repeats(path: PathWriter, values: dict[str, float]) -> int:
    """How often a block drills: L, or K on other controls.

    Raises
    ------
    InputError
        For both, and a number that is none.
    """
    given = [values[key] for key in "LK" if key in values]
    if len(given) > 1:
        raise InputError("a drill cycle has both L and K: write one of them.")
    count = given[0] if given else 1.0
    if count != int(count) or not 1 <= count <= MOST_REPEATS:
        raise InputError(f"a drill cycle is repeated {count:g} times: write a whole number from 1.")
    return int(count)
