"""Exact resultants of the paper's equations (1) to (5) for whole numbers, and which of their factors hold poses.

    python benchmarks/paper/elimination.py paper/witnesses/degrees.json

derives every system of the file again, by flint's polynomials with whole coefficients and nothing of workhold.

A point touches a line (a, b, c), aX + bY = c, or a circle (xc, yc, r). The first of a system is the characteristic one,
its point and its circle's centre both at the origin; of lines alone there is none, and the place is eliminated linearly.
The resultant is a polynomial in t = tan(theta / 2). A factor that cannot be split over the rationals has only roots that
are alike: all of them are orientations of complex poses, or none is. So the degree of such a factor, of which one root is
a pose, is the number of poses of a general system, and no polynomial with rational coefficients can have fewer roots.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from random import Random
from typing import Any

from flint import Ordering, fmpz_mpoly_ctx

__all__ = ["CASES", "System", "divisible", "factors", "random_system", "resultant"]

CONTEXT = fmpz_mpoly_ctx.get(("t", "u", "s"), Ordering.lex)
T, U, S = CONTEXT.gens()
# 1 + t^2 and 1 + u^2.
A, B = 1 + T**2, 1 + U**2
# (arcs on the left, arcs on the right), or (arcs on the left, -1) for the three pegs of Type II; arcs first on each jaw.
CASES = ((0, 0), (1, 0), (2, 0), (1, 1), (2, 1), (2, 2), (0, -1), (1, -1), (2, -1), (3, -1))
LARGEST = 9

Polynomial = Any
# Pegs (x, y), and what each touches: a circle (xc, yc, r) or a line (a, b, c), by its kind.
System = dict[str, Any]


def random_system(case: tuple[int, int], seed: int) -> System:
    """A system of small whole numbers."""
    random = Random(seed)

    def whole() -> int:
        return random.choice([k for k in range(-LARGEST, LARGEST + 1) if k])

    left, right = case
    arcs = [k < left for k in range(3 if right < 0 else 2)] + [
        k < right for k in range(2 if right >= 0 else 0)
    ]
    contacts = []
    for number, arc in enumerate(arcs):
        first = number == 0
        place = [0, 0] if first else [whole(), whole()]
        feature = [0, 0, abs(whole())] if first and arc else [whole(), whole(), abs(whole())]
        contacts.append({"peg": place, "kind": "circle" if arc else "line", "feature": feature})
    return {"case": list(case), "seed": seed, "contacts": contacts}


def transformed(x: Polynomial, y: Polynomial, radius: int) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Equation (1) for a point."""
    return (
        (1 - T**2) * B * x - 2 * T * B * y + radius * A * (1 - U**2),
        2 * T * B * x + (1 - T**2) * B * y + radius * A * 2 * U,
        A * B,
    )


def on_line(point: Any, line: list[int]) -> Polynomial:
    """Equations (2) and (4)."""
    a, b, c = line
    return a * point[0] + b * point[1] - c * point[2]


def on_circle(point: Any, circle: list[int], as_printed: bool = False) -> Polynomial:
    """The numerator of equations (3) and (5); as printed the centre is not multiplied by (1 + t^2)(1 + u^2)."""
    xc, yc, r = circle
    weight = point[2]
    x, y = (xc, yc) if as_printed else (xc * weight, yc * weight)
    return (point[0] - x) ** 2 + (point[1] - y) ** 2 - r**2 * weight**2


def divisible(circle: list[int], peg: list[int], radius: int, as_printed: bool) -> bool:
    """Whether the numerator of g can be divided by (1 + t^2)(1 + u^2), as the paper says."""
    point = transformed(CONTEXT.constant(peg[0]), CONTEXT.constant(peg[1]), radius)
    return bool(divmod(on_circle(point, circle, as_printed), A * B)[1] == 0)


def constraints(system: System) -> list[Polynomial]:
    """h and g of all contacts but the first, right pegs with the separation s."""
    contacts = system["contacts"]
    radius, moving = contacts[0]["feature"][2], 2 if len(contacts) == 4 else len(contacts)
    out = []
    for number, contact in enumerate(contacts[1:], 1):
        x, y = (CONTEXT.constant(one) for one in contact["peg"])
        point = transformed(x + S if number >= moving else x, y, radius)
        if contact["kind"] == "line":
            out.append(on_line(point, contact["feature"]))
        else:
            quotient, rest = divmod(on_circle(point, contact["feature"]), A * B)
            assert rest == 0
            out.append(quotient)
    return out


def resultant(system: System) -> Polynomial:
    """The polynomial in t that is left of a system."""
    contacts = system["contacts"]
    if contacts[0]["kind"] == "line":
        return determinant(straight_rows(contacts))
    held = constraints(system)
    if len(contacts) == 3:
        return held[0].resultant(held[1], "u")
    return held[1].resultant(held[2], "s").resultant(held[0], "u")


def straight_rows(contacts: list[Any]) -> list[list[Polynomial]]:
    """Contacts with lines are linear in place and separation: a row each, (a, b, factor of s, rest), times 1 + t^2."""
    rows = []
    for number, contact in enumerate(contacts):
        (x, y), (a, b, c) = contact["peg"], contact["feature"]
        factor = a * (1 - T**2) + b * 2 * T
        rest = a * ((1 - T**2) * x - 2 * T * y) + b * (2 * T * x + (1 - T**2) * y) - c * A
        row = [CONTEXT.constant(a), CONTEXT.constant(b)]
        if len(contacts) == 4:
            row.append(factor if number >= 2 else CONTEXT.constant(0))
        rows.append([*row, rest])
    return rows


def determinant(rows: list[list[Polynomial]]) -> Polynomial:
    """By the first row."""
    if len(rows) == 1:
        return rows[0][0]
    return sum(
        (-1) ** k * rows[0][k] * determinant([row[:k] + row[k + 1 :] for row in rows[1:]])
        for k in range(len(rows))
    )


def meaningless(system: System) -> Polynomial:
    """A polynomial in t that is zero where equation (1) has no meaning: at 1 + t^2 = 0, or where u^2 = -1 solves."""
    if system["contacts"][0]["kind"] == "line":
        return A
    return A * constraints(system)[0].resultant(B, "u")


def factors(system: System) -> dict[str, Any]:
    """The degree of a system's resultant in t, and its factors over the rationals: degree, power, coefficients."""
    polynomial = resultant(system)
    _, parts = polynomial.factor()
    spurious = meaningless(system)
    rows = []
    for part, power in parts:
        degree = int(part.degrees()[0])
        values = {exponent[0]: int(value) for exponent, value in part.to_dict().items()}
        coefficients = [values.get(k, 0) for k in range(degree + 1)]
        holds = bool(divmod(spurious, part)[1] != 0)
        rows.append(
            {"degree": degree, "power": int(power), "coefficients": coefficients, "holds_poses": holds}
        )
    rows.sort(key=lambda row: (-row["degree"], row["coefficients"]))
    return {"degree": int(polynomial.degrees()[0]), "factors": rows}


def main() -> None:
    """Derive the systems of a file again, and divide equation (3); exit code 1 if anything differs."""
    wrong = 0
    for words, as_printed in (("as printed", True), ("with its centre weighted", False)):
        divides = divisible([3, -2, 5], [4, 1], 2, as_printed)
        sys.stdout.write(f"equation (3) {words}: {'divides' if divides else 'leaves a rest'}\n")
        wrong += divides == as_printed
    for row in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["systems"]:
        again = factors(row["system"])
        same = again == {key: row[key] for key in ("degree", "factors")}
        wrong += not same
        degree = again["factors"][0]["degree"]
        words = "as in the file" if same else "NOT as in the file"
        sys.stdout.write(
            f"arcs {row['system']['case']}: degree {again['degree']}, of which {degree} cannot be split, {words}\n"
        )
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
