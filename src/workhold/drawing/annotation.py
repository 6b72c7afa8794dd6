"""Annotation of drawings: dimensions, scale bars and angles, and labels placed where they hide nothing.

Dimensions are in the manner of ISO 129: thin lines, text on top, arrows outside when tight. Each label takes
the cheapest of its candidate places.

Glossary
--------
label : a box on the page tied to an anchor by a leader, and the places it may take.
candidate : one such place, with the cost of its own (being far away, say).
ink : points along drawn lines that labels had better not cover, with a price each.
wall : a short straight piece of an outline that leaders had better not cross.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, floor, hypot, log10, pi, radians, sin
from typing import Literal

import numpy as np
from attrs import frozen
from numpy.typing import ArrayLike, NDArray

from workhold.drawing.scene import BLACK, GREY, Box, LengthUnit, Scene, number, text_width
from workhold.geometry.segment import Point

__all__ = [
    "PAST_END",
    "Label",
    "LabelPlacer",
    "Place",
    "angle_mark",
    "around",
    "dimension",
    "dimension_box",
    "joined",
    "leader_end",
    "scale_bar",
]

TIGHT = 34.0
# How far the arrows of a tight dimension reach past its ends, and the room beside its line, page units.
OUTSIDE_ARROW, HEAD = 24.0, 5.0
# How far past the end of a line a text too long for it stands, page units.
PAST_END = 8.0


def dimension(
    scene: Scene,
    start: Point,
    end: Point,
    text: str,
    size: float = 15.0,
    bold: bool = False,
    past: Literal["upper", "lower"] | None = None,
) -> Box:
    """Draws a dimension line between two page points, its text above it, readable from below or the right.

    Parameters
    ----------
    past : the end of an upright line past which a text longer than the line is written.

    Returns the box of the text.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = hypot(dx, dy)
    ux, uy = (dx / length, dy / length) if length > 0 else (1.0, 0.0)
    if length >= TIGHT:
        scene.arrow(((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), start, BLACK, 1.0, 11)
        scene.arrow(((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), end, BLACK, 1.0, 11)
    else:
        scene.line([start, end], BLACK, 1.0)
        scene.arrow((start[0] - OUTSIDE_ARROW * ux, start[1] - OUTSIDE_ARROW * uy), start, BLACK, 1.0, 11)
        scene.arrow((end[0] + OUTSIDE_ARROW * ux, end[1] + OUTSIDE_ARROW * uy), end, BLACK, 1.0, 11)
    middle = ((start[0] + end[0]) / 2 + 0.75 * size * uy, (start[1] + end[1]) / 2 - 0.85 * size * abs(ux))
    if abs(ux) < abs(uy):
        middle = (min(start[0], end[0]) - 0.75 * size, (start[1] + end[1]) / 2)
        if past is not None and text_width(text, size, bold) > length:
            away = text_width(text, size, bold) / 2 + PAST_END
            y = min(start[1], end[1]) - away if past == "upper" else max(start[1], end[1]) + away
            middle = (middle[0], y)
        scene.text(middle, text, size, "middle", bold, halo=3, turned=90)
        return Box.about(middle, size, text_width(text, size, bold))
    scene.text(middle, text, size, "middle", bold, halo=3)
    return Box.about(middle, text_width(text, size, bold), size)


def dimension_box(start: Point, end: Point) -> Box:
    """The page box of a level or upright dimension line with its arrows, without its text.

    >>> dimension_box((10.0, 0.0), (20.0, 0.0)).x0
    -19.0
    """
    low, high = (min(start[0], end[0]), min(start[1], end[1])), (max(start[0], end[0]), max(start[1], end[1]))
    past = OUTSIDE_ARROW if hypot(end[0] - start[0], end[1] - start[1]) < TIGHT else 0.0
    upright = abs(end[1] - start[1]) > abs(end[0] - start[0])
    out_x, out_y = (0.0, past) if upright else (past, 0.0)
    return Box(low[0] - out_x, low[1] - out_y, high[0] + out_x, high[1] + out_y).grown(HEAD)


def round_length(length: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not above ``length``.

    >>> round_length(37.0), round_length(0.9)
    (20.0, 0.5)
    """
    power = 10.0 ** floor(log10(length))
    return float(next(k * power for k in (5, 2, 1) if k * power <= length * (1 + 1e-9)))


def scale_bar(
    scene: Scene,
    at: Point,
    scale: float,
    lengths: LengthUnit,
    longest: float = 150.0,
    size: float = 12.0,
    more: str = "",
) -> float:
    """Draws a bar of a round length with its lower left corner at a page point; returns its total width.

    Parameters
    ----------
    scale : page units for a mm.
    lengths : the unit in which the length is round.
    longest : page units the bar may take.
    more : words behind the length.
    """
    scale *= lengths.unit.millimetres
    length = round_length(longest / scale)
    x, y = at
    part = length * scale / 4
    bar = scene.group("scale")
    for k in range(4):
        corners = [
            (x + k * part, y - 6),
            (x + (k + 1) * part, y - 6),
            (x + (k + 1) * part, y),
            (x + k * part, y),
        ]
        bar.polygon(corners, BLACK if k % 2 == 0 else "#ffffff", BLACK, 0.8)
    text = f"{length:g} {lengths.sign}{more}"
    bar.text((x + 4 * part + 8, y - 3), text, size)
    return 4 * part + 8 + text_width(text, size)


def angle_mark(scene: Scene, center: Point, theta_deg: float, radius: float, reach: float) -> None:
    """Draws the turn from the vise's x axis (a dashed line) to the part's (an arrow) around a page point."""
    x, y = center
    theta = radians(theta_deg % 360.0)
    mark = scene.group("pose")
    mark.line([(x, y), (x + reach, y)], GREY, 1.0, stroke_dasharray="5 3")
    mark.arrow((x, y), (x + reach * cos(theta), y - reach * sin(theta)), GREY, 1.4, 9)
    mark.circle(center, 2.2, GREY)
    if theta * radius < 10.0:
        return
    end = theta - 7.0 / radius  # leave room for the head
    pieces = max(1, floor(end / (pi / 2)) + 1)
    d = f"M{number(x + radius)} {number(y)}"
    for k in range(1, pieces + 1):
        a = end * k / pieces
        end_x, end_y = number(x + radius * cos(a)), number(y - radius * sin(a))
        d += f"A{number(radius)} {number(radius)} 0 0 0 {end_x} {end_y}"
    mark.path(d, GREY, 1.0)
    tip = (x + radius * cos(theta), y - radius * sin(theta))
    mark.arrow_head(tip, -(theta + pi / 2) + 3.5 / radius, GREY, 7.5)


Array = NDArray[np.float64]

OUTSIDE = 1e6
COLLISION = 200.0
CROSSING = 120.0
WALL = 12.0
STRIKE = 120.0
# Labels keep this far apart, page units.
GAP = 4.0
# The dearest candidates are dropped before labels compete with each other.
MOST_CANDIDATES = 240


@frozen(eq=False)
class Label:
    """A label of a size in page units and its C candidates.

    Parameters
    ----------
    centers, anchors : (C, 2) middle of the label and the point its leader runs to, page units.
    costs : (C,) what each candidate costs by itself.
    """

    width: float
    height: float
    centers: Array
    anchors: Array
    costs: Array

    @property
    def boxes(self) -> Array:
        """(C, 4) boxes x0, y0, x1, y1 of the candidates."""
        half = np.array([self.width, self.height]) / 2
        return np.hstack([self.centers - half, self.centers + half])

    @property
    def reach(self) -> Array:
        """(4,) box around all candidates and leaders, and a little more."""
        boxes = np.vstack([self.boxes, np.hstack([self.anchors, self.anchors])])
        return np.concatenate([boxes[:, :2].min(axis=0) - GAP, boxes[:, 2:].max(axis=0) + GAP])

    def kept(self, costs: Array) -> Label:
        """The label with new costs and only its cheapest candidates."""
        order = np.argsort(costs, kind="stable")[:MOST_CANDIDATES]
        return Label(self.width, self.height, self.centers[order], self.anchors[order], costs[order])


@frozen
class Place:
    """Where a label came to stand: its box, and the point its leader runs to."""

    box: Box
    anchor: Point


def around(
    anchor: Point,
    direction: float,
    size: tuple[float, float],
    distances: Sequence[float],
    turns: Sequence[float],
    extra: float = 0.0,
    turn_cost: float = 6.0,
) -> Label:
    """A label with candidates around an anchor.

    Parameters
    ----------
    direction : preferred direction from the anchor, radians on the page (y down).
    size : width and height in page units.
    distances : from the anchor to the label's rim, page units; each page unit costs 0.3.
    turns : turns away from the preferred direction, radians; each radian costs ``turn_cost``.
    extra : cost of every candidate.
    """
    width, height = size
    distance, turn = (grid.ravel() for grid in np.meshgrid(distances, turns, indexing="ij"))
    ways = np.column_stack([np.cos(direction + turn), np.sin(direction + turn)])
    # From the rim of a box to its middle along a direction.
    reach = distance + (np.array([width, height]) / 2 / np.maximum(np.abs(ways), 1e-9)).min(axis=1)
    anchors = np.tile(np.array(anchor, dtype=np.float64), (len(reach), 1))
    costs = extra + turn_cost * np.abs(turn) + 0.3 * distance
    return Label(width, height, anchors + reach[:, None] * ways, anchors, costs)


def joined(labels: Sequence[Label]) -> Label:
    """One label of the size of the first with the candidates of all."""
    return Label(
        labels[0].width,
        labels[0].height,
        np.vstack([label.centers for label in labels]),
        np.vstack([label.anchors for label in labels]),
        np.concatenate([label.costs for label in labels]),
    )


class LabelPlacer:
    """Knows what is drawn and finds the cheapest candidates.

    Parameters
    ----------
    bounds : the labels stay inside this page box.
    """

    def __init__(self, bounds: Box) -> None:
        self.bounds = bounds
        self.boxes = np.zeros((0, 4))
        self.points, self.prices = np.zeros((0, 2)), np.zeros(0)
        self.wall_starts, self.wall_ends = np.zeros((0, 2)), np.zeros((0, 2))

    def avoid_ink(self, points: ArrayLike, price: float) -> None:
        """Sets the price of covering each of some points, (N, 2) page units."""
        array = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        self.points = np.vstack([self.points, array])
        self.prices = np.concatenate([self.prices, np.full(len(array), price)])

    def avoid_box(self, box: Box) -> None:
        """Sets a high price for covering a box."""
        self.boxes = np.vstack([self.boxes, [box.x0, box.y0, box.x1, box.y1]])

    def avoid_line(self, start: Point, end: Point, price: float, step: float = 3.0) -> None:
        """Sets the price of covering a line, for every ``step`` page units."""
        count = max(2, int(np.hypot(end[0] - start[0], end[1] - start[1]) / step))
        shares = np.linspace(0.0, 1.0, count)[:, None]
        self.avoid_ink((1 - shares) * np.array(start) + shares * np.array(end), price)

    def avoid_walls(self, points: Array) -> None:
        """Sets a price for leaders across an open polyline, (N, 2) page units."""
        self.wall_starts = np.vstack([self.wall_starts, points[:-1]])
        self.wall_ends = np.vstack([self.wall_ends, points[1:]])

    def fixed_costs(self, label: Label) -> Array:
        """(C,) what the candidates cost before other labels are there."""
        boxes = label.boxes
        low, high = boxes[:, :2], boxes[:, 2:]
        bounds = self.bounds
        inside = (low >= [bounds.x0, bounds.y0]).all(axis=1) & (high <= [bounds.x1, bounds.y1]).all(axis=1)
        reach = label.reach
        near = meeting(reach, np.hstack([self.points, self.points]))
        (x, y), prices = self.points[near].T, self.prices[near]
        covered = (x > low[:, :1] - 2) & (x < high[:, :1] + 2) & (y > low[:, 1:] - 2) & (y < high[:, 1:] + 2)
        costs: Array = label.costs + np.where(inside, 0.0, OUTSIDE) + covered @ prices
        costs += COLLISION * overlaps(boxes, self.boxes).sum(axis=1)
        costs += STRIKE * entries(label.anchors, label.centers, self.boxes).sum(axis=1)
        # A leader begins on the outline itself, hence not quite at its anchor.
        starts = label.anchors + 0.1 * (label.centers - label.anchors)
        walls = np.hstack(
            [np.minimum(self.wall_starts, self.wall_ends), np.maximum(self.wall_starts, self.wall_ends)]
        )
        near = meeting(reach, walls)
        costs += WALL * crossings(starts, label.centers, self.wall_starts[near], self.wall_ends[near]).sum(
            axis=1
        )
        return costs

    def place(self, labels: Sequence[Label], sweeps: int = 4) -> list[Place]:
        """Places labels together: one after another, then each anew among the others until nothing moves."""
        kept = [label.kept(self.fixed_costs(label)) for label in labels]
        reaches = np.array([label.reach for label in kept]).reshape(-1, 4)
        boxes, anchors = np.zeros((len(kept), 4)), np.zeros((len(kept), 2))
        chosen = np.full(len(kept), -1)
        for _ in range(1 + sweeps):
            before = chosen.copy()
            for k, label in enumerate(kept):
                others = (chosen >= 0) & (np.arange(len(kept)) != k) & meeting(reaches[k], reaches)
                costs = label.costs + mutual_costs(label, boxes[others], anchors[others])
                chosen[k] = best = int(np.argmin(costs))
                boxes[k], anchors[k] = label.boxes[best], label.anchors[best]
            if (chosen == before).all():
                break
        return [
            Place(Box(*map(float, box)), (float(anchor[0]), float(anchor[1])))
            for box, anchor in zip(boxes, anchors, strict=True)
        ]


def mutual_costs(label: Label, boxes: Array, anchors: Array) -> Array:
    """(C,) costs of a label's candidates beside N placed labels, by their (N, 4) boxes and (N, 2) anchors."""
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    costs: Array = COLLISION * overlaps(label.boxes, boxes).sum(axis=1)
    costs += CROSSING * crossings(label.anchors, label.centers, anchors, middles).sum(axis=1)
    costs += CROSSING * entries(label.anchors, label.centers, boxes).sum(axis=1)
    costs += CROSSING * entries(anchors, middles, label.boxes).sum(axis=0)
    return costs


def meeting(box: Array, others: Array) -> NDArray[np.bool_]:
    """(N,) which of (N, 4) boxes a (4,) box meets."""
    return np.asarray((others[:, :2] <= box[2:]).all(axis=1) & (others[:, 2:] >= box[:2]).all(axis=1))


def overlaps(boxes: Array, others: Array) -> Array:
    """(C, N) 0 for (C, 4) boxes well clear of (N, 4) others, else 1 plus the share of the box covered."""
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    sides = np.maximum(high - low + GAP, 0.0)
    shared = sides[..., 0] * sides[..., 1]
    area = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    return np.where(shared > 0, 1 + shared / area[:, None], 0.0)


def crossings(starts: Array, ends: Array, other_starts: Array, other_ends: Array) -> NDArray[np.bool_]:
    """(C, N) whether straight pieces cross others."""

    def side(p: Array, q: Array, r: Array) -> Array:
        cross: Array = (q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0]
        return cross

    a, b, c, d = starts[:, None], ends[:, None], other_starts[None], other_ends[None]
    return (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)


def entries(starts: Array, ends: Array, boxes: Array) -> NDArray[np.bool_]:
    """(C, N) whether straight pieces enter boxes (clipping after Liang and Barsky, 1984)."""
    step = ends - starts
    step = np.where(np.abs(step) < 1e-9, 1e-9, step)[:, None]
    one = (boxes[None, :, :2] - starts[:, None]) / step
    two = (boxes[None, :, 2:] - starts[:, None]) / step
    enter = np.maximum(np.minimum(one, two).max(axis=2), 0.0)
    leave = np.minimum(np.maximum(one, two).min(axis=2), 1.0)
    return np.asarray(enter < leave)


def leader_end(anchor: Point, box: Box) -> Point:
    """Where the straight line from an anchor to a box's middle enters the box."""
    cx, cy = box.center
    dx, dy = anchor[0] - cx, anchor[1] - cy
    share = min(box.width / 2 / max(abs(dx), 1e-9), box.height / 2 / max(abs(dy), 1e-9), 1.0)
    return cx + share * dx, cy + share * dy
