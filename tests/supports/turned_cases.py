"""Complete sets with the part turned in its drawing, and with part and vise mirrored or given a half turn.

Each way takes what a file says to what the same fixture is called after it. Holes and sides have other numbers then.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from math import cos, radians, sin
from typing import Any

__all__ = ["half_turned", "mirrored", "turned"]

Truth = dict[str, Any]
Hole = tuple[str, int, int]
Point = tuple[float, float]
# How a hole of the planar fixture is called after.
Renamed = Callable[[Hole], Hole]


def moved(truth: Truth, over: Callable[[float, float], Point], turn: float, sign: float) -> Truth:
    """The part, its zones, the clamp's point and the loads with every point taken over.

    Parameters
    ----------
    turn, sign : a direction d, in degrees, becomes sign d + turn, and moments about z change by the sign.
    """
    out = deepcopy(truth)
    for zone in (*out["supports"]["zones"], *out["clamp"]["zones"]):
        x, y, radius = zone["circle"]
        zone["circle"] = [*over(x, y), radius]
    if out["clamp"]["point"] is not None:
        out["clamp"]["point"] = over(*out["clamp"]["point"])
    (x0, y0) = over(0.0, 0.0)
    for load in out["loads"]:
        load["points"] = [over(x, y) for x, y in load["points"]]
        low, high = (sign * one + turn for one in load["directions"])
        load["directions"] = [min(low, high), max(low, high)]
        load["moment"] *= sign
        # Tilting is a vector about an axis: it turns like one, and changes its sign with the mirror.
        x, y = over(*load["tilt"])
        load["tilt"] = [sign * (x - x0), sign * (y - y0)]
    return out


def turned(truth: Truth, angle: float, shift: Point) -> tuple[Truth, Renamed]:
    """The part drawn otherwise, turned by an angle in degrees and shifted, in the same place of the vise."""
    c, s = cos(radians(angle)), sin(radians(angle))

    def over(x: float, y: float) -> Point:
        return c * x - s * y + shift[0], s * x + c * y + shift[1]

    out = moved(truth, over, angle, 1.0)
    out["workpiece"]["loops"] = [
        [[*over(x, y), bulge] for x, y, bulge in loop] for loop in truth["workpiece"]["loops"]
    ]
    pose = out["fixture"]["pose"]
    theta = pose["theta_deg"] - angle
    c, s = cos(radians(theta)), sin(radians(theta))
    pose |= {
        "theta_deg": theta % 360.0,
        "x": pose["x"] - c * shift[0] + s * shift[1],
        "y": pose["y"] - s * shift[0] - c * shift[1],
    }
    return out, lambda hole: hole


def mirrored(truth: Truth) -> tuple[Truth, Renamed]:
    """Part and vise in a mirror that swaps up and down in both frames."""
    out = moved(truth, lambda x, y: (x, -y), 0.0, -1.0)
    first, last, sides = 0, [], {}
    for loop in truth["workpiece"]["loops"]:
        count = len(loop)
        last.append(
            [[loop[-1 - j][0], -loop[-1 - j][1], loop[(count - 2 - j) % count][2]] for j in range(count)]
        )
        sides |= {first + k: first + (count - 2 - k) % count for k in range(count)}
        first += count
    out["workpiece"]["loops"] = last
    fixture, pitch = out["fixture"], truth["vise"]["pitch"][1]
    top = max(peg["row"] for peg in fixture["pegs"])
    for peg in fixture["pegs"]:
        peg |= {"row": top - peg["row"], "y": top * pitch - peg["y"], "segment": sides[peg["segment"]]}
    pose = fixture["pose"]
    pose |= {"theta_deg": -pose["theta_deg"] % 360.0, "y": top * pitch - pose["y"]}
    return out, lambda hole: (hole[0], hole[1], top - hole[2])


def half_turned(truth: Truth) -> tuple[Truth, Renamed]:
    """The same fixture of two pegs on each jaw, seen from the other side: left is right."""
    out, other = deepcopy(truth), {"left": "right", "right": "left"}
    fixture, (pitch, rows) = out["fixture"], truth["vise"]["pitch"]
    most, top = truth["vise"]["columns"] - 1, max(peg["row"] for peg in fixture["pegs"])
    # Where the first column of the left jaw comes to lie is where the last of the right jaw was.
    width = 2 * most * pitch + fixture["jaw_separation"]
    for peg in fixture["pegs"]:
        peg |= {
            "jaw": other[peg["jaw"]],
            "column": most - peg["column"],
            "row": top - peg["row"],
            "x": width - peg["x"],
            "y": top * rows - peg["y"],
        }
    fixture["pegs"].sort(key=lambda peg: (peg["jaw"], peg["column"], peg["row"]))
    pose = fixture["pose"]
    pose |= {
        "theta_deg": (pose["theta_deg"] + 180.0) % 360.0,
        "x": width - pose["x"],
        "y": top * rows - pose["y"],
    }
    return out, lambda hole: (other[hole[0]], most - hole[1], top - hole[2])
