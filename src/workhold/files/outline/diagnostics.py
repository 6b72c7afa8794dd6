"""Messages and questions for drawings whose outline is not clear.

A drawing may not give its unit; then its size in each unit is shown. Its pieces may not close. The outlines
of several of its layers may not go together, and then the layers to read instead are named.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from math import dist
from shlex import quote
from typing import NoReturn

import numpy as np
from attrs import evolve

from workhold.errors import InputError
from workhold.files.outline.chain import Chain, Drawing, format_count, format_point, list_first_items
from workhold.files.outline.joining import OpenChain, join
from workhold.files.outline.nesting import DrawnPart
from workhold.files.questions import JOIN_TOLERANCE, LAYERS, PART_NUMBER, UNIT, UnitAskedError
from workhold.geometry.loop import make_loop_segments
from workhold.geometry.segment import Point, compute_box_around
from workhold.limits import MOST_RADIUS
from workhold.units import INCH, PIXELS

__all__ = [
    "refuse_nothing_closed",
    "refuse_open_outline",
    "measure_size",
    "describe_strays",
    "make_unit_question",
    "name_layers_in_error",
]


def measure_size(chains: Sequence[Chain]) -> tuple[float, float] | None:
    """Return the width and height in mm of the bounding box of chains; None where they have no segments."""
    segments = [segment for chain in chains for segment in chain.segments]
    if not segments:
        return None
    x0, y0, x1, y1 = compute_box_around(segments)
    return x1 - x0, y1 - y0


def has_sound_numbers(chain: Chain) -> bool:
    """Return whether all numbers of a chain are finite and small enough for a drawing in some unit."""
    return all(abs(value) <= MOST_RADIUS for value in chain.bulges) and all(
        abs(x) <= MOST_RADIUS and abs(y) <= MOST_RADIUS for x, y in chain.points
    )


def make_unit_question(
    lacking: str, chains: Sequence[Chain], pixels: float | None = None, in_pixels: bool = False
) -> UnitAskedError:
    """Return the error that asks for the unit of a drawing, with the drawing's size in each unit.

    Parameters
    ----------
    lacking : what is not known, up to the colon.
    chains : all that is drawn, with each unit of the drawing counted as 1 mm; empty where the drawing cannot
        be read.
    pixels : pixels in one unit of the drawing; None for files without pixels.
    in_pixels : whether the drawing says that it is in pixels.
    """
    size = measure_size(chains) if all(map(has_sound_numbers, chains)) else None
    shown = of_pixels = ""
    counts = f"{', '.join(f'px{count}' for count in PIXELS[:-1])} or px{PIXELS[-1]}"
    if size is not None:
        wide, inches = f"{size[0]:.5g}", size[0] * INCH.millimetres
        shown = f"it is {wide} mm wide, or {wide} in = {inches:,{'.0f' if inches >= 1000 else '.4g'}} mm; "
        by_count = [f"{inches * (pixels or 1.0) / count:.4g}" for count in PIXELS]
        first = f"{', '.join(map(str, PIXELS[:-1]))} or {PIXELS[-1]}"
        of_pixels = f"with {first} to the inch it is {', '.join(by_count[:-1])} or {by_count[-1]} mm wide"
    if in_pixels:
        of_pixels = f"{of_pixels}; " if of_pixels else ""
        return UnitAskedError(
            f"{lacking}: {of_pixels}say which with {UNIT} {counts}, or with {UNIT} mm (or inch, cm, m) if its "
            "numbers are not pixels."
        )
    asked = f"{lacking}: {shown}say which with {UNIT} mm (or inch, cm, m)"
    if pixels is None:
        return UnitAskedError(f"{asked}.")
    return UnitAskedError(f"{asked}, or with {UNIT} {counts} for pixels{of_pixels and f': {of_pixels}'}.")


# A stray whose ends are nearer than this share of its size was meant to close.
NEARLY_CLOSED = 0.2
# Pieces that do not close are looked at together where they are so few, with gaps up to a share of their
# size.
MOST_JOINED, MOST_GAP, MOST_GAPS = 500, 0.02, 20
# How many open ends an error names, and how many ends are searched for the nearest one.
ENDS_NAMED = 4


def refuse_nothing_closed(strays: Sequence[OpenChain], remarks: Sequence[str]) -> NoReturn:
    """Raise InputError for a drawing without any closed outline.

    It names open ends and how far each is from the nearest other one.

    Parameters
    ----------
    strays : all runs of chains, which do not close.
    remarks : on the drawing, for a message where there are no chains.
    """
    if not strays:
        hint = f" ({' '.join(remarks)})" if remarks else ""
        raise InputError(f"the drawing holds no lines or arcs that could be an outline{hint}.")
    raise InputError(f"no outline is closed: {describe_open_ends(strays)}")


def refuse_open_outline(part: DrawnPart, strays: Sequence[OpenChain]) -> None:
    """Raise InputError where a part is likely a hole, because
    an outline around it is nearly closed, but not quite.
    """
    for stray in strays:
        box = compute_box_around(stray.chain.segments)
        gap, size = dist(stray.chain.points[0], stray.chain.points[-1]), dist(box[:2], box[2:])
        if surrounds_box(box, part.bounds) and gap < NEARLY_CLOSED * size:
            raise InputError(
                f"the outline around {part} is not closed: {describe_open_ends([stray])} To use the inner part "
                f"anyway, give {PART_NUMBER} {part.number}."
            )
    enough = find_gap_around_part(part, strays)
    if enough is not None:
        raise InputError(
            f"the outline around {part} is not closed: {describe_open_ends(strays, enough)} To use the inner part "
            f"anyway, give {PART_NUMBER} {part.number}."
        )


def find_gap_around_part(part: DrawnPart, strays: Sequence[OpenChain]) -> float | None:
    """Return the smallest gap in mm whose closing makes open
    pieces an outline around a part; None where no gap does.
    """
    chains = [stray.chain for stray in strays]
    if not 1 < len(chains) <= MOST_JOINED:
        return None
    ends = np.array([end for chain in chains for end in (chain.points[0], chain.points[-1])])
    away = np.hypot(*(ends[:, None] - ends[None]).T)
    np.fill_diagonal(away, np.inf)
    widest = MOST_GAP * float(np.hypot(*np.ptp(ends, axis=0)))
    for gap in sorted({float(gap) for gap in away.min(axis=1) if 0.0 < gap <= widest})[-MOST_GAPS:]:
        try:
            joined = join(chains, gap * (1 + 1e-9))
        except InputError:
            continue
        loops = () if joined.junctions else joined.loops
        if any(
            surrounds_box(compute_box_around(make_loop_segments(loop.vertices)), part.bounds)
            for loop in loops
        ):
            return gap
    return None


def surrounds_box(a: Sequence[float], b: Sequence[float]) -> bool:
    """Return whether the bounding box ``a`` reaches beyond the box ``b`` on all four sides."""
    return a[0] < b[0] and a[1] < b[1] and a[2] > b[2] and a[3] > b[3]


def describe_open_ends(strays: Sequence[OpenChain], enough: float | None = None) -> str:
    """Return a text that names the open ends nearest to another one, and
    the join tolerance that would close the gap.

    Each end is given with its distance from the nearest other end. ``enough`` is the gap in mm that has to be
    closed; the smallest of these distances if None.
    """
    ends: list[tuple[Point, str]] = []
    for stray in strays:
        ends += [(stray.chain.points[0], stray.first), (stray.chain.points[-1], stray.last)]
    points = np.array([point for point, _ in ends])
    found = []
    # The first few hundred are enough to name four: files with more are not outlines at all.
    for k, (point, name) in enumerate(ends[:500]):
        away = np.hypot(points[:, 0] - point[0], points[:, 1] - point[1])
        away[k] = np.inf
        nearest = int(away.argmin())
        found.append((float(away[nearest]), point, name, ends[nearest][1]))
    found.sort(key=lambda item: item[0])
    words = [
        f"{name} ends at {format_point(point)}, {gap:.3g} mm from the nearest other end ({other})"
        for gap, point, name, other in found[:ENDS_NAMED]
    ]
    more = f", and {len(ends) - len(words)} more ends are open" if len(ends) > len(words) else ""
    needed = found[0][0] if enough is None else enough
    # A little more than is needed, in two digits.
    larger = f"give a larger {JOIN_TOLERANCE}, above {needed * 1.05:.2g} mm"
    return f"{'; '.join(words)}{more}; close the drawing, or {larger}."


def describe_strays(strays: Sequence[OpenChain]) -> list[str]:
    """Return a sentence on open runs of chains that were left out beside a closed outline; [] without any."""
    if not strays:
        return []
    places = list_first_items(
        [
            f"{stray.first} at {format_point(stray.chain.points[0])} to "
            f"{stray.last} at {format_point(stray.chain.points[-1])}"
            if stray.first != stray.last
            else f"{stray.first} from {format_point(stray.chain.points[0])} to {format_point(stray.chain.points[-1])}"
            for stray in strays
        ]
    )
    return [
        f"Left out {format_count(len(strays), 'open piece', 'open pieces')} outside any closed outline: {places}."
    ]


# More layers than this are not tried one by one, and no sentence names them.
MOST_LAYERS = 12


def name_layers_in_error(
    error: InputError, drawing: Drawing, usable: Callable[[Drawing], bool]
) -> InputError:
    """Return an error whose message also has the layers of the segments that it names, and a choice of layers
    with which a part can be read.

    The error itself is returned where its segments are not on several layers. ``usable`` returns whether a
    part can be read from a drawing.
    """
    said = str(error)
    # The name of a segment may begin like that of another one.
    meeting = {
        layer: label
        for label, layer in drawing.layers.items()
        if label in said and re.search(rf"{re.escape(label)}(?!\w)", said) is not None
    }
    every = list(dict.fromkeys(drawing.layers.values()))
    if len(meeting) < 2 or len(every) > MOST_LAYERS:
        return error
    where = " and ".join(f"{label} is on layer '{layer}'" for layer, label in meeting.items())
    # Without one of those that meet, or each of these alone.
    choices = [[other for other in every if other != layer] for layer in reversed(meeting)] + [
        [one] for one in meeting
    ]
    for chosen in choices:
        chains = tuple(chain for chain in drawing.chains if drawing.layers.get(chain.labels[0]) in chosen)
        if usable(evolve(drawing, chains=chains)):
            # As a command takes it, one option after the other.
            words = " ".join(f"{LAYERS} {quote(layer)}" for layer in chosen)
            return InputError(
                f"{said.rstrip('.')}. {where}: give {words} to read an outline without the rest."
            )
    return InputError(f"{said.rstrip('.')}. {where}.")
