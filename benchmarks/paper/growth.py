"""How contacts, fixtures and time grow with a part's perimeter and area, fitted over parts and sizes, with the spread."""

from __future__ import annotations

from collections.abc import Iterator
from math import exp, hypot, inf, sqrt
from time import process_time
from typing import Any

import numpy as np

from designs import PEG_RADIUS, Design, grown, loaded, warm
from loglog import FRAME, PAGE, SMALL, Axes, draw_grid
from paper.document import Block, Figures, Heading, Inline, Paragraph, Picture, Table
from report import measured
from workhold.drawing.scene import BLACK, Scene

NAME, TITLE = "growth", "Growth with perimeter and area"
SECONDS, QUICK_SECONDS = 90.0, 6.0

PARTS = ("thin4Handle", "8Handle", "small4Handle", "large4Handle", "oblongPart", "widget", "flange")
PITCH = 10.0
# Times each part is grown against the pitch, for each number of columns.
TIMES = {1: (1.0, 1.5, 2.0, 3.0, 4.0), 10: (1.0, 1.5, 2.0)}
QUICK_PARTS, QUICK_TIMES = PARTS[4:], {1: (1.0, 2.0)}
REPEATS = 3
# From so many contacts on what any search costs counts little; a law needs more points than this.
LARGE, FEWEST = 40_000, 3
# What grows, and what it grows with.
QUANTITIES = {"contacts": "contacts A", "fixtures": "fixtures", "seconds": "time"}
COLOURS = ("#1f6fb5", "#b3122a", "#2e7d32", "#e59a00", "#6a3d9a", "#00838f", "#8d6e63")


def measure(data: dict[str, Any], quick: bool) -> Iterator[tuple[float, str]]:
    """Count and time every part in every size, and fit."""
    parts, times = (QUICK_PARTS, QUICK_TIMES) if quick else (PARTS, TIMES)
    data |= {"points": [], "fits": []}
    jobs = [(part, columns) for columns in times for part in parts]
    for number, (part, columns) in enumerate(jobs):
        yield number / len(jobs), f"{part}, {columns} columns"
        sizes = [grown(Design(part, PITCH, columns, PEG_RADIUS), one) for one in times[columns]]  # type: ignore[arg-type]
        told = measured("paper.growth.points", [[d.part, d.pitch, d.columns, d.peg_radius] for d in sizes])
        data["points"] += told
    for columns in times:
        points = [point for point in data["points"] if point["columns"] == columns]
        for quantity in QUANTITIES:
            data["fits"].append({"columns": columns, "quantity": quantity, **fits(points, quantity)})
    large = [point for point in data["points"] if point["contacts"] > LARGE]
    data["large"] = LARGE
    for name, those in (("time", data["points"]), ("time_large", large)):
        if len(those) > FEWEST:
            data[name] = power_law([p["contacts"] for p in those], [p["seconds"] for p in those])


def points(designs: list[list[Any]]) -> list[dict[str, Any]]:
    """Task: perimeter and area in pitches, contacts, fixtures and seconds of some designs."""
    import workhold
    from workhold.search.toolkit_search import count_contacts

    warm()
    out = []
    for part, pitch, columns, peg_radius in designs:
        workpiece, vise = loaded(part, pitch, columns, peg_radius)
        seconds = inf
        for _ in range(REPEATS):
            start = process_time()
            result = workhold.design(workpiece, vise, threads=1)
            seconds = min(seconds, process_time() - start)
        out.append(
            {
                "part": part,
                "columns": columns,
                "times": PITCH / pitch,
                "perimeter": sum(s.length for loop in workpiece.loop_segments for s in loop) / pitch,
                "area": area(workpiece) / pitch**2,
                "contacts": count_contacts(workpiece, vise),
                "fixtures": sum(result.found.values()),
                "seconds": seconds,
            }
        )
    return out


def area(workpiece: Any) -> float:
    """The area of a part in mm^2: shoelace of the vertices, and the segment of circle over each bulge."""
    total = 0.0
    for loop in workpiece.loops:
        for (x0, y0, bulge), (x1, y1, _) in zip(loop, [*loop[1:], loop[0]], strict=True):
            total += (x0 * y1 - x1 * y0) / 2
            if bulge:
                sweep = 4 * np.arctan(bulge)
                radius = hypot(x1 - x0, y1 - y0) / 2 / np.sin(sweep / 2)
                total += radius**2 * (sweep - np.sin(sweep)) / 2
    return float(total)


def fits(points: list[dict[str, Any]], quantity: str) -> dict[str, Any]:
    """The power laws of a quantity in perimeter and in area, of the points where there is any of it."""
    there = [point for point in points if point[quantity] > 0]
    values = [point[quantity] for point in there]
    return {of: power_law([point[of] for point in there], values) for of in ("perimeter", "area")}


def power_law(xs: list[float], ys: list[float]) -> dict[str, float]:
    """Exponent of y against x by least squares of logarithms, its standard error, and how far points lie off.

    The spread is exp of the residuals' standard deviation: two of three points lie within so many times the law.
    """
    x, y = np.log(np.array(xs, float)), np.log(np.array(ys, float))
    slope, height = np.polyfit(x, y, 1)
    off = y - slope * x - height
    deviation = sqrt(float(off @ off) / max(len(x) - 2, 1))
    error = deviation / sqrt(float(((x - x.mean()) ** 2).sum()))
    return {
        "exponent": float(slope),
        "error": error,
        "factor": exp(float(height)),
        "spread": exp(deviation),
        "points": len(xs),
    }


def told(figures: Figures) -> list[Inline]:
    """How contacts grow, in words, for each number of columns."""
    out: list[Inline] = []
    for k in figures.every("fits"):
        path = f"fits/{k}"
        if figures.value(f"{path}/quantity") != "contacts":
            continue
        out += [
            "In a vise of ",
            figures.count(f"{path}/columns"),
            " column" if figures.value(f"{path}/columns") == 1 else " columns",
            " contacts grow as the perimeter to the power ",
            figures.fixed(f"{path}/perimeter/exponent", 2),
            " or the area to the power ",
            figures.fixed(f"{path}/area/exponent", 2),
            ". ",
        ]
    return out


def told_of_large(figures: Figures) -> list[Inline]:
    """How time grows where what any search costs has ceased to count, if there are such points."""
    if figures.value("time_large") is None:
        return []
    return [
        "Over the points with more than ",
        figures.count("large"),
        " contacts, of which what any search costs is a smaller part, it grows as A to the power ",
        figures.fixed("time_large/exponent", 2),
        " ± ",
        figures.fixed("time_large/error", 2),
        " with a spread of ",
        figures.fixed("time_large/spread", 2),
        ".",
    ]


def render(figures: Figures) -> list[Block]:
    """The table of exponents and the plot."""
    rows: list[list[Inline]] = []
    for k in figures.every("fits"):
        path = f"fits/{k}"
        cells: list[Inline] = [
            QUANTITIES[figures.value(f"{path}/quantity")],
            figures.count(f"{path}/columns"),
            figures.count(f"{path}/perimeter/points"),
        ]
        for of in ("perimeter", "area"):
            cells += [
                figures.fixed(f"{path}/{of}/exponent", 2),
                figures.fixed(f"{path}/{of}/error", 2),
                figures.fixed(f"{path}/{of}/spread", 2),
            ]
        rows.append(cells)
    blocks: list[Block] = [
        Heading(TITLE),
        Paragraph(
            (
                "Each model was grown against the pitch, pegs with the pitch, and a power law was fitted over all "
                "parts and sizes by least squares of logarithms. The error is the standard error of the exponent; "
                "the spread is the factor within which two of three points lie about the law. ",
                *told(figures),
                "Time follows the number of contacts: over all points it grows as A to the power ",
                figures.fixed("time/exponent", 2),
                " ± ",
                figures.fixed("time/error", 2),
                ". ",
                *told_of_large(figures),
            )
        ),
        Table(
            "Table 6",
            "Exponents of growth with the perimeter and with the area, both counted in pitches; the fit "
            "is made for each number of "
            "columns by itself.",
            ("quantity", "columns", "points", "exponent", "±", "spread", "exponent", "±", "spread"),
            rows,
            groups=(("", 3), ("with the perimeter", 3), ("with the area", 3)),
        ),
    ]
    points = figures.value("points") or []
    if len(points) > 1:
        blocks.append(
            Picture(
                "Figure 4",
                "Simultaneous contacts and time as parts grow. Filled: one column; open: ten. Lines "
                "join the sizes of one part.",
                (
                    (
                        drawn(points, "perimeter", "contacts", "perimeter (pitches)", "contacts A"),
                        "contacts by perimeter",
                    ),
                    (
                        drawn(points, "contacts", "seconds", "contacts A", "seconds, one thread"),
                        "time by contacts",
                    ),
                ),
            )
        )
    return blocks


def drawn(points: list[dict[str, Any]], of: str, quantity: str, across: str, up: str) -> str:
    """A plot of all points, those of one part in one colour, in the order of their sizes."""
    axes = Axes.around([(point[of], point[quantity]) for point in points])
    scene = Scene.make_page(PAGE, f"{up} against {across}")
    draw_grid(scene, axes, across, up)
    names = list(dict.fromkeys(point["part"] for point in points))
    for number, name in enumerate(names):
        colour = COLOURS[number % len(COLOURS)]
        for columns in dict.fromkeys(point["columns"] for point in points):
            mine = [point for point in points if (point["part"], point["columns"]) == (name, columns)]
            places = [axes.place(point[of], point[quantity]) for point in mine]
            if len(places) > 1:
                scene.add_line(places, colour, 1.6)
            for place in places:
                scene.add_circle(place, 6.0, colour if columns == 1 else "#ffffff", colour, 2.0)
        at = FRAME.x0 + 24.0, FRAME.y0 + 26.0 + 28.0 * number
        scene.add_circle(at, 6.0, colour, colour, 2.0)
        scene.add_text((at[0] + 20.0, at[1]), name, SMALL, fill=BLACK)
    return scene.to_svg()
