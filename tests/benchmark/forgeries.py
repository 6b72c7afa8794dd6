"""Fifty and more ways to forge a set's file, each by a function that changes a true one.

Every forgery is one that a program or a person could make by mistake or on purpose. Counts are mended after it where it adds
or takes away fixtures, so that they alone give nothing away.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import deepcopy
from typing import Any

__all__ = ["FORGERIES", "MANIFEST_ONLY", "mended"]

Content = dict[str, Any]
Forgery = Callable[[Content], None]
VISE, PLATE, PAIR, FENCE, FLAT, SYMMETRIC = (
    "kite-vise",
    "bar-plate",
    "bar-pair",
    "el-fence",
    "house-flat-opening",
    "triangle-vise",
)


def mended(content: Content) -> None:
    """Make the counts those of the list."""
    for name in content["counts"]:
        content["counts"][name] = sum(f["type"] == name for f in content["fixtures"])


def at(*path: Any, to: Any = None, by: float | None = None, times: float | None = None) -> Forgery:
    """Change one number or word, found by keys and indices."""

    def change(content: Content) -> None:
        where = content
        for key in path[:-1]:
            where = where[key]
        old = where[path[-1]]
        where[path[-1]] = (
            to if by is None and times is None else old * times if times is not None else old + by
        )

    return change


def fixture(number: int, *path: Any, **how: Any) -> Forgery:
    """Change one number of a fixture."""
    return at("fixtures", number, *path, **how)


def lost(number: int) -> Forgery:
    """Leave a fixture out, and mend the counts and the sets under rotations."""

    def change(content: Content) -> None:
        gone = content["fixtures"].pop(number)
        mended(content)
        content["distinct"][gone["type"]] -= 1

    return change


def doubled(number: int, **moved: float) -> Forgery:
    """List a fixture twice, the second time moved a little."""

    def change(content: Content) -> None:
        copy = deepcopy(content["fixtures"][number])
        for key, by in moved.items():
            copy["pose"][key] += by
        content["fixtures"].insert(number + 1, copy)
        mended(content)
        content["distinct"][copy["type"]] += 1
        content["proof"]["verified"] += 1
        content["proof"]["candidates"] += 1

    return change


def doubled_elsewhere(content: Content) -> None:
    """List a fixture again, its pegs a row higher: the same up to a step of the lattice."""
    copy = deepcopy(content["fixtures"][3])
    pitch = content["toolkit"]["pitch"][1]
    copy["pose"]["y"] += pitch
    for peg in copy["pegs"]:
        peg["row"] += 1
        peg["y"] += pitch
    content["fixtures"].append(copy)
    mended(content)


def swapped(one: int, other: int) -> Forgery:
    """Exchange two fixtures in the list."""

    def change(content: Content) -> None:
        listed = content["fixtures"]
        listed[one], listed[other] = listed[other], listed[one]

    return change


def moved_whole(content: Content) -> None:
    """Move pegs and pose together by 1e-5 mm, so that all contacts hold."""
    made = content["fixtures"][0]
    made["pose"]["x"] += 1e-5
    for peg in made["pegs"]:
        peg["x"] += 1e-5


def exchanged_pegs(content: Content) -> None:
    """Exchange the faces of two pegs."""
    pegs = content["fixtures"][0]["pegs"]
    pegs[0]["segment"], pegs[2]["segment"] = pegs[2]["segment"], pegs[0]["segment"]


def scaled_forces(content: Content) -> None:
    """Give forces that sum to one, another unit than that of the format."""
    pegs = content["fixtures"][5]["pegs"]
    total = sum(peg["force"] for peg in pegs)
    for peg in pegs:
        peg["force"] /= total


def mirrored(content: Content) -> None:
    """Give the mirror image of a fixture: the part cannot be turned over."""
    made = content["fixtures"][2]
    made["pose"]["theta_deg"] = 360.0 - made["pose"]["theta_deg"]
    made["pose"]["y"] = -made["pose"]["y"]


def in_radians(content: Content) -> None:
    """Give an angle in radians."""
    pose = content["fixtures"][1]["pose"]
    pose["theta_deg"] = math.radians(pose["theta_deg"])


def other_jaw(content: Content) -> None:
    """Give a peg to the other jaw."""
    pegs = content["fixtures"][0]["pegs"]
    pegs[0]["jaw"] = "right"


def one_hole(content: Content) -> None:
    """Put a peg into the hole of another one."""
    pegs = content["fixtures"][0]["pegs"]
    pegs[1] = dict(pegs[0])


def clamp_on_a_locator(content: Content) -> None:
    """Put a clamp's tip where a locator stands."""
    pegs = content["fixtures"][0]["pegs"]
    pegs[3]["x"], pegs[3]["y"] = pegs[0]["x"], pegs[0]["y"]


def part_under_a_peg(content: Content) -> None:
    """Draw a further loop where a peg stands."""
    made = content["fixtures"][0]
    theta = math.radians(made["pose"]["theta_deg"])
    x, y = (made["pegs"][0][key] - made["pose"][key] for key in ("x", "y"))
    q = [math.cos(theta) * x + math.sin(theta) * y, math.cos(theta) * y - math.sin(theta) * x]
    content["workpiece"]["loops"].append(
        [[q[0] + a, q[1] + b, 0.0] for a, b in ((0.5, 0.5), (0.6, 0.5), (0.5, 0.6))]
    )


def all_of_a_type(content: Content) -> None:
    """Leave out every fixture of Type II."""
    content["fixtures"] = [f for f in content["fixtures"] if f["type"] == "I"]
    content["distinct"]["II"] = 0
    mended(content)


def proof_gone(content: Content) -> None:
    """Leave the account of the search out."""
    del content["proof"]


def undecided_added(content: Content) -> None:
    """Name an undecided candidate, and count it."""
    content["proof"]["undecided"].append({"type": "I", "reason": "double root"})
    content["proof"]["candidates"] += 1


def verified_lowered(content: Content) -> None:
    """Verify fewer than are listed, with a sum that is right."""
    content["proof"]["verified"] -= 200
    content["proof"]["discarded_by_bound"] += 200


def outline_moved(content: Content) -> None:
    """Move a corner of the workpiece by 1e-5 mm."""
    content["workpiece"]["loops"][0][1][0] += 1e-5


# The set to forge, what is forged, and a word of the fault that the checker must state.
FORGERIES: dict[str, tuple[str, Forgery, str]] = {
    "a fixture lost, counts mended": (PLATE, lost(17), "missing"),
    "a fixture of a symmetric part lost": (SYMMETRIC, lost(100), "image"),
    "a fixture of a vise lost": (VISE, lost(52), "missing"),
    "a fixture lost, counts as before": (VISE, lambda c: c["fixtures"].pop(3), "counts"),
    "a fixture beside a fence lost": (FENCE, lost(11), "missing"),
    "a fixture of a fence and two clamps lost": ("el-fence-pair", lost(23), "missing"),
    "two pegs in one hole": (VISE, one_hole, "one hole"),
    "a clamp on a locator": (PLATE, clamp_on_a_locator, "meets a locator"),
    "a peg within the part": (VISE, part_under_a_peg, "enters"),
    "every fixture of a type lost": (VISE, all_of_a_type, "missing"),
    "a fixture doubled": (VISE, doubled(7), "again"),
    "a fixture doubled, moved by 1e-8": (VISE, doubled(7, x=1e-8), "again"),
    "a fixture doubled a row higher": (PLATE, doubled_elsewhere, "again"),
    "two fixtures exchanged": (VISE, swapped(3, 4), "order"),
    "the list turned round": (VISE, lambda c: c["fixtures"].reverse(), "order"),
    "a force altered": (VISE, fixture(0, "pegs", 1, "force", by=1e-5), "force"),
    "a force of a clamp altered": (PLATE, fixture(2, "pegs", 3, "force", times=1.001), "force"),
    "a force of a fence altered": (FENCE, fixture(2, "wall", "forces", 0, by=1e-4), "force"),
    "a force of a flat jaw altered": (FLAT, fixture(2, "pegs", 0, "force", by=1e-4), "force"),
    "a force of one of two clamps altered": (PAIR, fixture(9, "pegs", 0, "force", 1, by=1e-4), "force"),
    "forces in another unit": (VISE, scaled_forces, "force"),
    "a force of the wrong sign": (VISE, fixture(4, "pegs", 0, "force", times=-1.0), "force"),
    "a pose moved by 1e-5 along x": (VISE, fixture(0, "pose", "x", by=1e-5), "touch"),
    "a pose moved by 1e-5 along y": (VISE, fixture(6, "pose", "y", by=-1e-5), "touch"),
    "a pose turned by 1e-5 degrees": (VISE, fixture(6, "pose", "theta_deg", by=1e-5), "touch"),
    "pose and pegs moved together by 1e-5": (VISE, moved_whole, "hole"),
    "a pose of a plate moved by 1e-5": (PLATE, fixture(8, "pose", "y", by=1e-5), "touch"),
    "a pose on a fence moved by 1e-5": (FENCE, fixture(1, "pose", "y", by=1e-5), "wall"),
    "an angle of a turn more": (VISE, fixture(3, "pose", "theta_deg", by=360.0), "outside"),
    "an angle in radians": (VISE, in_radians, "touch"),
    "a mirrored pose": (VISE, mirrored, "touch"),
    "a peg moved by 1e-5": (VISE, fixture(5, "pegs", 2, "y", by=1e-5), "hole"),
    "a column altered": (VISE, fixture(5, "pegs", 2, "column", by=1), "hole"),
    "a row altered": (PLATE, fixture(5, "pegs", 0, "row", by=1), "hole"),
    "a clamp's line altered": (PLATE, fixture(5, "pegs", 3, "row", by=1), "line"),
    "a fractional row": (VISE, fixture(5, "pegs", 0, "row", by=0.5), "whole"),
    "a face altered": (VISE, fixture(5, "pegs", 1, "segment", by=1), "face"),
    "a face that is not there": (VISE, fixture(5, "pegs", 1, "segment", to=99), "segment"),
    "two faces exchanged": (VISE, exchanged_pegs, "face"),
    "a peg of the other jaw": (VISE, other_jaw, "role"),
    "a type altered": (VISE, fixture(0, "type", to="II"), "role"),
    "a type that is not there": (VISE, fixture(0, "type", to="III"), "type"),
    "a direction altered": (PLATE, fixture(0, "direction", to="+x"), "direction"),
    "directions that were not asked for": (PLATE, at("toolkit", "directions", to=["-y"]), "asked"),
    "an opening altered": (VISE, fixture(0, "jaw_separation", by=1e-5), "hole"),
    "an opening of a flat jaw altered": (FLAT, fixture(0, "jaw_separation", by=1e-5), "hole"),
    "a wall's end altered": (FENCE, fixture(0, "wall", "to", 0, by=1e-4), "wall"),
    "a ratio altered": (PAIR, fixture(3, "ratio", 0, by=1e-3), "ratio"),
    "a closure margin altered": (VISE, fixture(0, "quality", "closure_margin", by=1e-5), "closure margin"),
    "an amplification altered": (PAIR, fixture(0, "quality", "clamp_amplification", by=1e-5), "amplification"),
    "a wrench radius altered": (FENCE, fixture(0, "quality", "wrench_radius", by=1e-5), "wrench radius"),
    "a location error altered": (FLAT, fixture(0, "quality", "location_error", by=1e-5), "location error"),
    "a clamp freedom altered": (PAIR, fixture(0, "quality", "clamp_freedom", by=1e-2), "clamp freedom"),
    "a figure left out": (VISE, lambda c: c["fixtures"][0]["quality"].pop("wrench_radius"), "figures"),
    "a figure that is not finite": (VISE, fixture(0, "quality", "location_error", to=math.inf), "finite"),
    "candidates altered": (VISE, at("proof", "candidates", by=1), "candidates"),
    "a number discarded altered": (VISE, at("proof", "discarded_by_bound", by=-1), "candidates"),
    "fewer verified than listed": (VISE, verified_lowered, "verified"),
    "an undecided candidate named": (VISE, undecided_added, "undecided"),
    "the account left out": (VISE, proof_gone, "proof"),
    "more escalated than there are": (VISE, at("proof", "escalated", to=10**9), "escalated"),
    "sets under rotations altered": (SYMMETRIC, at("distinct", "I", by=1), "distinct"),
    "a corner of the workpiece moved by 1e-5": (VISE, outline_moved, "touch"),
    "a peg radius altered": (VISE, at("toolkit", "peg_radius", by=1e-5), "touch"),
    "a pitch altered": (VISE, at("toolkit", "pitch", 1, by=1e-5), "hole"),
    "a smaller plate claimed": (PLATE, at("toolkit", "columns", to=2), "column"),
    "a greater gap claimed": (VISE, at("toolkit", "min_gap", by=30.0), "near"),
    "a tolerance altered": (VISE, at("options", "tolerance", "peg", to=0.02), "location error"),
    "inches claimed": (VISE, at("workpiece", "units", to="inch"), "mm"),
    "another format claimed": (VISE, at("format", to="workhold-result/1"), "format"),
}  # fmt: skip
# What only the checksums of the manifest can show.
MANIFEST_ONLY: dict[str, tuple[str, Forgery]] = {
    "cells of the account altered": (VISE, at("proof", "cells", by=1)),
    "a statistic altered": (VISE, at("statistics", "chord_curves", by=1)),
    "a coordinate altered in its last digit": (VISE, fixture(0, "pose", "x", by=1e-9)),
    "another set's name": (VISE, at("set", to="kite-oblong-pitch")),
}  # fmt: skip
