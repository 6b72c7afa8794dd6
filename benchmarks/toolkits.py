"""Target 10: what a simultaneous contact costs in each toolkit, beside the vise's Type II, and two clamps on a plate.

Contacts are counted in runs of their own: sets of four that touch at once, whatever the rules say of them. More of them are
fixtures in some toolkits than in others, and fixtures are what takes the time, so beside the time for each contact stands
that for each fixture found. Of two clamps what counts is the waiting: the best hundred of a rectangle on a plate of eight by
six holes.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

from designs import warm
from report import Column, Section, measured, run_alone

# Times the vise's Type II, by measurements that differ by a tenth from run to run.
MOST_TIMES = 1.1
MOST_SECONDS = 0.5
REPEATS = 5
# Part, pitch and columns of the vise; on plates the same part and pitch.
PARTS = (("widget", 8, 4), ("flange", 8, 4))
# mm. A fence has so few contacts that with a usual pitch a search costs what one costs that finds nothing; with these it has
# about as many as the vise.
FENCE_PITCH, FENCE_PEG_RADIUS = 1, 0.4

# Parts whose searches for two clamps took longest of some hundred as they come out of CAD, and what they are held
# in: rods with round ends about bores, a tee with three bores, and a wedge.
CAD_PRESET, CAD_BEST, MOST_CAD_SECONDS = "two-clamp-plate-20mm", 20, 1.0
ROUND_END, JOINT = 4.541724058, 22.688102609
CAD_PARTS = {
    f"rod {length}": [
        [
            (JOINT, -10.5, 0),
            (length - JOINT, -10.5, ROUND_END),
            (length - JOINT, 10.5, 0),
            (JOINT, 10.5, ROUND_END),
        ],
        [(length + 12.5, 0, -1), (length - 12.5, 0, -1)],
        [(12.5, 0, -1), (-12.5, 0, -1)],
    ]
    for length in (140, 120)
} | {
    "tee": [
        [
            *[(0, 0, 0), (100, 0, 0), (100, 12, 0), (62, 12, -0.414213562), (56, 18, 0), (56, 92, 1)],
            *[(44, 92, 0), (44, 18, -0.414213562), (38, 12, 0), (0, 12, 0)],
        ],
        *([(x + r, y, -1), (x - r, y, -1)] for x, y, r in ((50, 92, 5), (8, 6, 3.3), (92, 6, 3.3))),
    ],
    "wedge": [[(0, 0, 0), (140, 0, 0), (140, 25, 0), (0, 60, 0)], [(38, 20, -1), (22, 20, -1)]],
}

COLUMNS = (
    Column("toolkit", 26, right=False),
    Column("part", 14, right=False),
    Column("contacts A", 12),
    Column("fixtures", 10),
    Column("seconds", 9),
    Column("ns each", 8),
    Column("us a fixture", 12),
)


def run(quick: bool) -> Section:
    """Measure plates beside the vise, then two clamps."""
    section = Section("toolkits", "Other toolkits, one thread", COLUMNS).begin()
    worst = fences = 0.0
    for part, pitch, columns in PARTS[:1] if quick else PARTS:
        vise = told(section, "vise, Type II", part, ("Vise", part, pitch, columns, "II"))
        for name in ("-x", "-y"):
            plate = told(section, f"plate, clamp {name}", part, ("Plate", part, pitch, 8, name))
            worst = max(worst, plate / vise)
        fence = told(section, "fence, clamp any way", part, ("Fence", part, FENCE_PITCH, 0, ""))
        fences = max(fences, fence / vise)
    section.target(
        10,
        f"a contact on a plate costs at most {MOST_TIMES:g} times one of the vise's Type II",
        f"{worst:.2f} times",
        worst <= MOST_TIMES,
    )
    section.target(
        10,
        f"a contact on a fence costs at most {MOST_TIMES:g} times one of the vise's Type II",
        f"{fences:.2f} times",
        fences <= MOST_TIMES,
    )
    outcome = measured("toolkits.two_clamps", REPEATS)
    section.row(
        "plate, two clamps, best 100",
        "100 × 60",
        f"{outcome['contacts']:,}",
        "",
        f"{outcome['seconds']:.3f}",
        "",
        "",
    )
    words = f"the best 100 of a rectangle on 8 × 6 holes with two clamps in under {MOST_SECONDS:g} s"
    section.target(10, words, f"{outcome['seconds']:.3f} s", outcome["seconds"] < MOST_SECONDS)
    slowest = 0.0
    for name in list(CAD_PARTS)[:1] if quick else CAD_PARTS:
        outcome = measured("toolkits.cad_part", name, REPEATS)
        contacts, seconds = f"{outcome['contacts']:,}", f"{outcome['seconds']:.3f}"
        section.row(f"{CAD_PRESET}, best {CAD_BEST}", name, contacts, "", seconds, "", "")
        slowest = max(slowest, outcome["seconds"])
    words = f"the best {CAD_BEST} of a part as it comes out of CAD on {CAD_PRESET} in under {MOST_CAD_SECONDS:g} s"
    section.target(10, words, f"{slowest:.3f} s", slowest < MOST_CAD_SECONDS)
    return section


def told(section: Section, toolkit: str, part: str, task: tuple[Any, ...]) -> float:
    """Measure one design and tell its row; nanoseconds for each contact."""
    contacts, outcome = measured("toolkits.contacts", *task), measured("toolkits.design_seconds", *task)
    each = 1e9 * outcome["seconds"] / contacts
    numbers = f"{contacts:,}", f"{outcome['fixtures']:,}", f"{outcome['seconds']:.3f}", f"{each:.0f}"
    section.row(toolkit, part, *numbers, f"{1e6 * outcome['seconds'] / outcome['fixtures']:.1f}")
    return each


def query_of(kind: str, part: str, pitch: float, columns: int, way: str) -> Any:
    """A design in a vise of one type, on a plate with one direction, or on a fence."""
    import workhold

    workpiece = workhold.load(part)
    if kind == "Vise":
        return workhold.Query(workpiece, workhold.Vise(pitch=pitch, columns=columns, peg_radius=3), way)
    if kind == "Fence":
        return workhold.Query(
            workpiece, workhold.Fence(pitch=pitch, peg_radius=FENCE_PEG_RADIUS, wall_offset=5)
        )
    plate = workhold.Plate(pitch=pitch, peg_radius=3, columns=columns, rows=columns, directions=[way])
    return workhold.Query(workpiece, plate)


def contacts(*task: Any) -> int:
    """Task: simultaneous contacts of a design."""
    query = query_of(*task)
    if query.toolkit.wall is not None:
        import workhold

        return int(workhold.answer(query, threads=1).statistics["contacts_examined"])
    from workhold.contact.problem import Problem
    from workhold.search.toolkit_search import count_problem_contacts

    return count_problem_contacts(Problem.from_query(query), 1)


def design_seconds(*task: Any) -> dict[str, Any]:
    """Task: a proven design, its kernels compiled and loaded; the best of some runs."""
    import workhold

    warm()
    query, least = query_of(*task), float("inf")
    for _ in range(REPEATS):
        start = perf_counter()
        result = workhold.answer(query, threads=1)
        least = min(least, perf_counter() - start)
    return {"seconds": least, "fixtures": len(result)}


def two_clamps(repeats: int) -> dict[str, Any]:
    """Task: the best hundred ways to hold a rectangle with two clamps; the best of some runs."""
    import workhold

    loop = [(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]
    workpiece = workhold.Workpiece.from_loops("rectangle", [loop])
    plate = workhold.Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
    least = float("inf")
    for _ in range(repeats + 1):
        start = perf_counter()
        result = workhold.design(workpiece, plate, best=100, threads=1)
        least = min(least, perf_counter() - start)
    return {"seconds": least, "contacts": result.statistics["contacts_examined"]}


def cad_part(name: str, repeats: int) -> dict[str, Any]:
    """Task: the best ways to hold one of the slow parts with two clamps; the best of some runs."""
    import workhold

    workpiece, plate = workhold.Workpiece.from_loops(name, CAD_PARTS[name]), workhold.Plate.preset(CAD_PRESET)
    least = float("inf")
    for _ in range(repeats + 1):
        start = perf_counter()
        result = workhold.design(workpiece, plate, best=CAD_BEST)
        least = min(least, perf_counter() - start)
    return {"seconds": least, "contacts": result.statistics["contacts_examined"]}


if __name__ == "__main__":
    run_alone(__doc__, run)
