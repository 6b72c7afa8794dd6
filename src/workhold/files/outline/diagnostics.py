"""What to say and to ask where a drawing leaves its outline open.

A drawing may not say in which unit it is, and is then shown by its size. Its pieces may not close. The
outlines of several of its layers may not go together, and then the layers to read instead are named.
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
from workhold.files.outline.chain import Chain, Drawing, at, counted, listed
from workhold.files.outline.joining import Stray, join
from workhold.files.outline.nesting import DrawnPart
from workhold.files.questions import JOIN_TOLERANCE, LAYERS, PART_NUMBER, UNIT, UnitAskedError
from workhold.geometry.segment import Point, bounding_box, segment_from_bulge
from workhold.units import INCH

__all__ = [
    "refuse_nothing_closed",
    "refuse_open_outline",
    "size_of",
    "stray_remarks",
    "unit_asked",
    "with_layers_named",
]


def size_of(chains: Sequence[Chain]) -> tuple[float, float] | None:
    """Width and height in mm of the smallest upright rectangle around chains; None without any."""
    boxes = [
        bounding_box(segment_from_bulge(start, end, bulge))
        for chain in chains
        for start, end, bulge in zip(chain.points, chain.points[1:], chain.bulges, strict=False)
        if start != end
    ]
    if not boxes:
        return None
    all_boxes = np.array(boxes)
    low, high = all_boxes[:, :2].min(axis=0), all_boxes[:, 2:].max(axis=0)
    return float(high[0] - low[0]), float(high[1] - low[1])


def unit_asked(lacking: str, chains: Sequence[Chain]) -> UnitAskedError:
    """The question for the unit of a drawing that lacks it, with what it would be in mm and in inches.

    Parameters
    ----------
    lacking : what is not known, up to the colon.
    chains : what is drawn, a unit of the drawing for a mm; nothing where that cannot be read.
    """
    size = size_of(chains)
    shown = ""
    if size is not None:
        wide = f"{size[0]:.5g}"
        shown = f"it is {wide} mm wide, or {wide} in = {size[0] * INCH.millimetres:,.4g} mm; "
        if size[0] * INCH.millimetres >= 1000:
            shown = f"it is {wide} mm wide, or {wide} in = {size[0] * INCH.millimetres:,.0f} mm; "
    return UnitAskedError(f"{lacking}: {shown}say which with {UNIT} mm (or inch, cm, m).")


# A stray whose ends are nearer than this share of its size was meant to close.
NEARLY_CLOSED = 0.2
# Pieces that do not close are looked at together where they are so few, with gaps up to a share of their
# size.
MOST_JOINED, MOST_GAP, MOST_GAPS = 500, 0.02, 20
# How many open ends an error names, and how many ends are searched for the nearest one.
ENDS_NAMED = 4


def refuse_nothing_closed(strays: Sequence[Stray], remarks: Sequence[str]) -> NoReturn:
    """Raise the error for a drawing without any closed outline.

    Raises
    ------
    InputError
        Naming open ends and how far each is from the nearest other one.
    """
    if not strays:
        hint = f" ({' '.join(remarks)})" if remarks else ""
        raise InputError(f"the drawing holds no lines or arcs that could be an outline{hint}.")
    raise InputError(f"no outline is closed: {open_ends(strays)}")


def refuse_open_outline(part: DrawnPart, strays: Sequence[Stray]) -> None:
    """Refuses to take a hole for the part when the outline around it is nearly closed, but not quite.

    Raises
    ------
    InputError
        Naming the open ends.
    """
    x0, y0, x1, y1 = part.bounds
    for stray in strays:
        chain = stray.chain
        low_x, low_y, high_x, high_y = bounds([*chain.points], chain.bulges)
        gap = dist(stray.chain.points[0], stray.chain.points[-1])
        size = dist((low_x, low_y), (high_x, high_y))
        if low_x < x0 and low_y < y0 and high_x > x1 and high_y > y1 and gap < NEARLY_CLOSED * size:
            raise InputError(
                f"the outline around {part} is not closed: {open_ends([stray])} To use the inner part all "
                f"the same, give {PART_NUMBER} {part.number}."
            )
    enough = gap_around(part, strays)
    if enough is not None:
        raise InputError(
            f"the outline around {part} is not closed: {open_ends(strays, enough)} To use the inner part "
            f"all the same, give {PART_NUMBER} {part.number}."
        )


def gap_around(part: DrawnPart, strays: Sequence[Stray]) -> float | None:
    """The smallest gap with which open pieces make an outline around a part; None without one."""
    chains = [stray.chain for stray in strays]
    if not 1 < len(chains) <= MOST_JOINED:
        return None
    x0, y0, x1, y1 = part.bounds
    ends = np.array([end for chain in chains for end in (chain.points[0], chain.points[-1])])
    away = np.hypot(*(ends[:, None] - ends[None]).T)
    np.fill_diagonal(away, np.inf)
    widest = MOST_GAP * float(np.hypot(*np.ptp(ends, axis=0)))
    for gap in sorted({float(gap) for gap in away.min(axis=1) if 0.0 < gap <= widest})[-MOST_GAPS:]:
        try:
            loops = join(chains, gap * (1 + 1e-9)).loops
        except InputError:
            continue
        for loop in loops:
            points = [(float(x), float(y)) for x, y, _ in loop.vertices]
            low_x, low_y, high_x, high_y = bounds([*points, points[0]], loop.vertices[:, 2].tolist())
            if low_x < x0 and low_y < y0 and high_x > x1 and high_y > y1:
                return gap
    return None


def bounds(points: Sequence[Point], bulges: Sequence[float]) -> tuple[float, float, float, float]:
    """Bounding box in mm of the segments from point to point."""
    steps = zip(points, points[1:], bulges, strict=False)
    boxes = np.array([bounding_box(segment_from_bulge(p, q, b)) for p, q, b in steps if p != q]).reshape(
        -1, 4
    )
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def open_ends(strays: Sequence[Stray], enough: float | None = None) -> str:
    """The nearest open ends, how far apart they are, and the remedy; a gap that is enough, if known."""
    ends: list[tuple[Point, str]] = []
    for stray in strays:
        ends += [(stray.chain.points[0], stray.first), (stray.chain.points[-1], stray.last)]
    points = np.array([point for point, _ in ends])
    found = []
    # The first few hundred are enough to name four: files with more are no outlines at all.
    for k, (point, name) in enumerate(ends[:500]):
        away = np.hypot(points[:, 0] - point[0], points[:, 1] - point[1])
        away[k] = np.inf
        nearest = int(away.argmin())
        found.append((float(away[nearest]), point, name, ends[nearest][1], nearest))
    found.sort(key=lambda item: item[0])
    words = [
        f"{name} ends at {at(point)}, {gap:.3g} mm from the nearest other end ({other})"
        for gap, point, name, other, _ in found[:ENDS_NAMED]
    ]
    more = f", and {len(ends) - len(words)} more ends are open" if len(ends) > len(words) else ""
    needed = found[0][0] if enough is None else enough
    larger = f"give a larger {JOIN_TOLERANCE}, above {rounded_up(needed)} mm"
    return f"{'; '.join(words)}{more}; close the drawing, or {larger}."


def rounded_up(gap: float) -> str:
    """A gap rounded up to two digits."""
    return f"{gap * 1.05:.2g}"


def stray_remarks(strays: Sequence[Stray]) -> list[str]:
    """What to say about strays when a closed outline remains."""
    if not strays:
        return []
    places = listed(
        [
            f"{stray.first} at {at(stray.chain.points[0])} to {stray.last} at {at(stray.chain.points[-1])}"
            if stray.first != stray.last
            else f"{stray.first} from {at(stray.chain.points[0])} to {at(stray.chain.points[-1])}"
            for stray in strays
        ]
    )
    return [
        f"Left out {counted(len(strays), 'open piece', 'open pieces')} outside any closed outline: {places}."
    ]


# More layers than this are not tried one by one, and no sentence names them.
MOST_LAYERS = 12


def with_layers_named(error: InputError, drawing: Drawing, usable: Callable[[Drawing], bool]) -> InputError:
    """What is wrong with an outline, the layers that are named in it, and a choice of layers that is usable.

    Parameters
    ----------
    error : what is wrong.
    drawing : with its layers.
    usable : whether a part can be read of a drawing.
    """
    said = str(error)
    meeting = {layer: label for label, layer in drawing.layers.items() if is_named(label, said)}
    every = list(dict.fromkeys(drawing.layers.values()))
    if len(meeting) < 2 or len(every) > MOST_LAYERS:
        return error
    where = " and ".join(f"{label} is on layer '{layer}'" for layer, label in meeting.items())
    # Without one of those that meet, or each of these alone.
    choices = [[other for other in every if other != layer] for layer in reversed(meeting)] + [
        [one] for one in meeting
    ]
    for chosen in choices:
        if usable(of_layers(drawing, chosen)):
            return InputError(
                f"{said.rstrip('.')}. {where}: give {chosen_words(chosen)} to read an outline without the "
                "rest."
            )
    return InputError(f"{said.rstrip('.')}. {where}.")


def is_named(label: str, sentence: str) -> bool:
    """Whether a sentence names a segment, and not only one whose name begins like it."""
    return re.search(rf"{re.escape(label)}(?!\w)", sentence) is not None


def of_layers(drawing: Drawing, layers: Sequence[str]) -> Drawing:
    """The part of a drawing that is on some layers."""
    chains = tuple(chain for chain in drawing.chains if drawing.layers.get(chain.labels[0]) in layers)
    return evolve(drawing, chains=chains)


def chosen_words(layers: Sequence[str]) -> str:
    """A choice of layers as a command takes it, one option after the other."""
    return " ".join(f"{LAYERS} {quote(layer)}" for layer in layers)
