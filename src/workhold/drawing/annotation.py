"""Annotation of drawings: dimensions, scale bars, and labels placed where they hide nothing.

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
from math import dist, floor, hypot, log10
from typing import Literal

import numpy as np
from attrs import frozen
from numpy.typing import ArrayLike, NDArray

from workhold.drawing.scene import BLACK, Box, LengthUnit, Scene, measure_text
from workhold.geometry.segment import Point

__all__ = [
    "PAST_END",
    "Label",
    "LabelPlacer",
    "PlacedLabel",
    "make_label_around",
    "draw_dimension",
    "compute_dimension_box",
    "draw_dimension_line",
    "join_labels",
    "draw_scale_bar",
]

TIGHT = 34.0
# How far the arrows of a tight dimension reach past its ends, and the room beside its line, page units.
OUTSIDE_ARROW, HEAD = 24.0, 5.0
# How far past the end of a line a text too long for it stands, page units.
PAST_END = 8.0


def draw_dimension_line(
    scene: Scene,
    start: Point,
    end: Point,
    tight: float = TIGHT,
    outside: float = OUTSIDE_ARROW,
    head: float = 11.0,
) -> Point:
    """Draw a dimension line between two page points; return its unit direction on the page, from start to
    end.

    All sizes are in page units. On a line shorter than ``tight`` the arrows stand outside and reach
    ``outside`` beyond its ends. Arrow heads are ``head`` long.
    """
    length = dist(start, end)
    ux, uy = ((end[0] - start[0]) / length, (end[1] - start[1]) / length) if length > 0 else (1.0, 0.0)
    if length >= tight:
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        tails = (middle, middle)
    else:
        scene.add_line([start, end], BLACK, 1.0)
        tails = (
            (start[0] - outside * ux, start[1] - outside * uy),
            (end[0] + outside * ux, end[1] + outside * uy),
        )
    for tail, tip in zip(tails, (start, end), strict=True):
        scene.add_arrow(tail, tip, BLACK, 1.0, head)
    return ux, uy


def draw_dimension(
    scene: Scene,
    start: Point,
    end: Point,
    text: str,
    size: float = 15.0,
    bold: bool = False,
    past: Literal["upper", "lower"] | None = None,
) -> Box:
    """Draw a dimension line between two page points, with its text above it or to its left; return the text's
    box.

    The text of an upright line is turned so that it is read from the right. If it is longer than the line, it
    is written beyond the end that ``past`` names; with None it stays beside the line.
    """
    ux, uy = draw_dimension_line(scene, start, end)
    width = measure_text(text, size, bold)
    x, y = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    if abs(ux) >= abs(uy):
        middle = (x + 0.75 * size * uy, y - 0.85 * size * abs(ux))
        scene.add_text(middle, text, size, "middle", bold, halo=3)
        return Box.from_center(middle, width, size)
    if past is not None and width > dist(start, end):
        away = width / 2 + PAST_END
        y = min(start[1], end[1]) - away if past == "upper" else max(start[1], end[1]) + away
    middle = (min(start[0], end[0]) - 0.75 * size, y)
    scene.add_text(middle, text, size, "middle", bold, halo=3, turned=90)
    return Box.from_center(middle, size, width)


def compute_dimension_box(start: Point, end: Point) -> Box:
    """Return the page box of a horizontal or vertical dimension line with its arrows, without its text.

    >>> compute_dimension_box((10.0, 0.0), (20.0, 0.0)).x0
    -19.0
    """
    low, high = (min(start[0], end[0]), min(start[1], end[1])), (max(start[0], end[0]), max(start[1], end[1]))
    past = OUTSIDE_ARROW if hypot(end[0] - start[0], end[1] - start[1]) < TIGHT else 0.0
    upright = abs(end[1] - start[1]) > abs(end[0] - start[0])
    out_x, out_y = (0.0, past) if upright else (past, 0.0)
    return Box(low[0] - out_x, low[1] - out_y, high[0] + out_x, high[1] + out_y).grow(HEAD)


def round_length(length: float) -> float:
    """Return the largest of 1, 2 or 5 times a power of ten that is at most
    ``length``, which must be positive.

    >>> round_length(37.0), round_length(0.9)
    (20.0, 0.5)
    """
    power = 10.0 ** floor(log10(length))
    return float(next(k * power for k in (5, 2, 1) if k * power <= length * (1 + 1e-9)))


def draw_scale_bar(
    scene: Scene,
    at: Point,
    scale: float,
    lengths: LengthUnit,
    longest: float = 150.0,
    size: float = 12.0,
    more: str = "",
) -> float:
    """Draw a bar of a round length, its lower left corner at a page point; return the width of bar and text
    in page units.

    Parameters
    ----------
    scale : page units per mm.
    lengths : the unit in which the length is round.
    longest : largest length of the bar in page units.
    size : font size in page units.
    more : words written after the length.
    """
    scale *= lengths.unit.millimetres
    length = round_length(longest / scale)
    x, y = at
    part = length * scale / 4
    bar = scene.group("scale")
    for k in range(4):
        left, right = x + k * part, x + (k + 1) * part
        corners = [(left, y - 6), (right, y - 6), (right, y), (left, y)]
        bar.add_polygon(corners, BLACK if k % 2 == 0 else "#ffffff", BLACK, 0.8)
    text = f"{length:g} {lengths.sign}{more}"
    bar.add_text((x + 4 * part + 8, y - 3), text, size)
    return 4 * part + 8 + measure_text(text, size)


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
    """A label with its C candidate places.

    Parameters
    ----------
    width, height : size in page units.
    centers, anchors : (C, 2) middle of the label, and the point that its leader runs to, in page units.
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
        """(4,) box x0, y0, x1, y1 around all candidates and anchors, grown by ``GAP``."""
        boxes = np.vstack([self.boxes, np.hstack([self.anchors, self.anchors])])
        return np.concatenate([boxes[:, :2].min(axis=0) - GAP, boxes[:, 2:].max(axis=0) + GAP])

    def keep_cheapest(self, costs: Array) -> Label:
        """Return the label with only its cheapest candidates, ``MOST_CANDIDATES`` at most, cheapest first.

        ``costs`` (C,) take the place of the costs of its C candidates.
        """
        order = np.argsort(costs, kind="stable")[:MOST_CANDIDATES]
        return Label(self.width, self.height, self.centers[order], self.anchors[order], costs[order])


@frozen
class PlacedLabel:
    """A placed label: its box on the page, and the point its leader runs to."""

    box: Box
    anchor: Point

    def compute_leader(self, radius: float = 0.0) -> list[Point]:
        """Return the two ends of the leader: on a circle of ``radius`` page units about the anchor, and on
        the rim of the box.
        """
        (x, y), (cx, cy) = self.anchor, self.box.center
        dx, dy = x - cx, y - cy
        share = min(self.box.width / 2 / max(abs(dx), 1e-9), self.box.height / 2 / max(abs(dy), 1e-9), 1.0)
        end = (cx + share * dx, cy + share * dy)
        off = min(radius / max(dist(self.anchor, end), 1e-9), 1.0)
        return [(x + off * (end[0] - x), y + off * (end[1] - y)), end]


def make_label_around(
    anchor: Point,
    direction: float,
    size: tuple[float, float],
    distances: Sequence[float],
    turns: Sequence[float],
    extra: float = 0.0,
    turn_cost: float = 6.0,
) -> Label:
    """Return a label with one candidate for each combination of a distance and a turn around an anchor.

    Parameters
    ----------
    anchor : page point.
    direction : preferred direction from the anchor, in radians on the page (y down).
    size : width and height of the label, page units.
    distances : from the anchor to the label's rim, page units; each unit costs 0.3.
    turns : angles away from ``direction``, in radians; each radian costs ``turn_cost``.
    extra : cost added to every candidate.
    """
    width, height = size
    distance, turn = (grid.ravel() for grid in np.meshgrid(distances, turns, indexing="ij"))
    ways = np.column_stack([np.cos(direction + turn), np.sin(direction + turn)])
    # From the rim of a box to its middle along a direction.
    reach = distance + (np.array([width, height]) / 2 / np.maximum(np.abs(ways), 1e-9)).min(axis=1)
    anchors = np.tile(np.array(anchor, dtype=np.float64), (len(reach), 1))
    costs = extra + turn_cost * np.abs(turn) + 0.3 * distance
    return Label(width, height, anchors + reach[:, None] * ways, anchors, costs)


def join_labels(labels: Sequence[Label]) -> Label:
    """Return one label, of the size of the first of ``labels``, with the candidates of all of them."""
    return Label(
        labels[0].width,
        labels[0].height,
        np.vstack([label.centers for label in labels]),
        np.vstack([label.anchors for label in labels]),
        np.concatenate([label.costs for label in labels]),
    )


class LabelPlacer:
    """Places labels where they hide least of what is drawn.

    Parameters
    ----------
    bounds : page box that labels stay inside.
    """

    def __init__(self, bounds: Box) -> None:
        self.bounds = bounds
        self.boxes = np.zeros((0, 4))
        self.points, self.prices = np.zeros((0, 2)), np.zeros(0)
        self.wall_starts, self.wall_ends = np.zeros((0, 2)), np.zeros((0, 2))

    def avoid_ink(self, points: ArrayLike, price: float) -> None:
        """Add points (N, 2) in page units, each of which costs a label that covers it ``price``."""
        array = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        self.points = np.vstack([self.points, array])
        self.prices = np.concatenate([self.prices, np.full(len(array), price)])

    def avoid_box(self, box: Box) -> None:
        """Add a page box that is costly for labels to cover, and for their leaders to cross."""
        self.boxes = np.vstack([self.boxes, [box.x0, box.y0, box.x1, box.y1]])

    def avoid_line(self, start: Point, end: Point, price: float, step: float = 3.0) -> None:
        """Add points on a line, ``step`` page units apart, each of which costs a label that covers it
        ``price``.
        """
        count = max(2, int(np.hypot(end[0] - start[0], end[1] - start[1]) / step))
        shares = np.linspace(0.0, 1.0, count)[:, None]
        self.avoid_ink((1 - shares) * np.array(start) + shares * np.array(end), price)

    def avoid_crossing(self, points: Array) -> None:
        """Add an open polyline (N, 2), page units; each crossing of it costs a leader ``WALL``."""
        self.wall_starts = np.vstack([self.wall_starts, points[:-1]])
        self.wall_ends = np.vstack([self.wall_ends, points[1:]])

    def compute_fixed_costs(self, label: Label) -> Array:
        """Return the costs (C,) of a label's candidates when no other label is placed."""
        boxes = label.boxes
        low, high = boxes[:, :2], boxes[:, 2:]
        bounds = self.bounds
        inside = (low >= [bounds.x0, bounds.y0]).all(axis=1) & (high <= [bounds.x1, bounds.y1]).all(axis=1)
        reach = label.reach
        near = find_boxes_met(reach, np.hstack([self.points, self.points]))
        (x, y), prices = self.points[near].T, self.prices[near]
        covered = (x > low[:, :1] - 2) & (x < high[:, :1] + 2) & (y > low[:, 1:] - 2) & (y < high[:, 1:] + 2)
        costs: Array = label.costs + np.where(inside, 0.0, OUTSIDE) + covered @ prices
        costs += COLLISION * compute_overlaps(boxes, self.boxes).sum(axis=1)
        costs += STRIKE * find_entries_into_boxes(label.anchors, label.centers, self.boxes).sum(axis=1)
        # A leader begins on the outline itself, hence not quite at its anchor.
        starts = label.anchors + 0.1 * (label.centers - label.anchors)
        first, last = self.wall_starts, self.wall_ends
        near = find_boxes_met(reach, np.hstack([np.minimum(first, last), np.maximum(first, last)]))
        costs += WALL * find_crossings(starts, label.centers, first[near], last[near]).sum(axis=1)
        return costs

    def place(self, labels: Sequence[Label], sweeps: int = 4) -> list[PlacedLabel]:
        """Return a place for each label, in the order of ``labels``.

        First each label in turn takes its cheapest candidate beside the labels placed so far. Then each is
        chosen again with all others in place, at most ``sweeps`` times, until no label moves.
        """
        kept = [label.keep_cheapest(self.compute_fixed_costs(label)) for label in labels]
        reaches = np.array([label.reach for label in kept]).reshape(-1, 4)
        boxes, anchors = np.zeros((len(kept), 4)), np.zeros((len(kept), 2))
        chosen = np.full(len(kept), -1)
        for _ in range(1 + sweeps):
            before = chosen.copy()
            for k, label in enumerate(kept):
                others = (chosen >= 0) & (np.arange(len(kept)) != k) & find_boxes_met(reaches[k], reaches)
                costs = label.costs + compute_mutual_costs(label, boxes[others], anchors[others])
                chosen[k] = best = int(np.argmin(costs))
                boxes[k], anchors[k] = label.boxes[best], label.anchors[best]
            if (chosen == before).all():
                break
        return [
            PlacedLabel(Box(*map(float, box)), (float(anchor[0]), float(anchor[1])))
            for box, anchor in zip(boxes, anchors, strict=True)
        ]


def compute_mutual_costs(label: Label, boxes: Array, anchors: Array) -> Array:
    """Return the costs (C,) that N placed labels add to each candidate of a label.

    ``boxes`` (N, 4) and ``anchors`` (N, 2) are those of the placed labels.
    """
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    costs: Array = COLLISION * compute_overlaps(label.boxes, boxes).sum(axis=1)
    costs += CROSSING * find_crossings(label.anchors, label.centers, anchors, middles).sum(axis=1)
    costs += CROSSING * find_entries_into_boxes(label.anchors, label.centers, boxes).sum(axis=1)
    costs += CROSSING * find_entries_into_boxes(anchors, middles, label.boxes).sum(axis=0)
    return costs


def find_boxes_met(box: Array, others: Array) -> NDArray[np.bool_]:
    """Return (N,) booleans: whether each of the boxes ``others`` (N, 4) touches or overlaps ``box`` (4,)."""
    return np.asarray((others[:, :2] <= box[2:]).all(axis=1) & (others[:, 2:] >= box[:2]).all(axis=1))


def compute_overlaps(boxes: Array, others: Array) -> Array:
    """Return (C, N): by how much each of C boxes is covered by each of N others, 0 where they are ``GAP``
    clear.

    Where they are not, it is 1 plus the covered share of the first box's area, measured as if the boxes were
    ``GAP`` closer. ``boxes`` is (C, 4), ``others`` (N, 4).
    """
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    sides = np.maximum(high - low + GAP, 0.0)
    shared = sides[..., 0] * sides[..., 1]
    area = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    return np.where(shared > 0, 1 + shared / area[:, None], 0.0)


def find_crossings(starts: Array, ends: Array, other_starts: Array, other_ends: Array) -> NDArray[np.bool_]:
    """Return (C, N) booleans: whether each of C straight segments properly crosses each of N others.

    Segments run from ``starts`` to ``ends`` (C, 2), and from ``other_starts`` to ``other_ends`` (N, 2).
    """

    def compute_side(p: Array, q: Array, r: Array) -> Array:
        """Return twice the signed areas of the triangles p, q, r: the sign says on which side of the line p q
        the point r is.
        """
        cross: Array = (q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0]
        return cross

    a, b, c, d = starts[:, None], ends[:, None], other_starts[None], other_ends[None]
    return (compute_side(a, b, c) * compute_side(a, b, d) < 0) & (
        compute_side(c, d, a) * compute_side(c, d, b) < 0
    )


def find_entries_into_boxes(starts: Array, ends: Array, boxes: Array) -> NDArray[np.bool_]:
    """Return (C, N) booleans: whether each of C straight segments enters each of N boxes.

    Segments run from ``starts`` to ``ends`` (C, 2); ``boxes`` is (N, 4). Clipped after Liang and Barsky,
    1984.
    """
    step = ends - starts
    step = np.where(np.abs(step) < 1e-9, 1e-9, step)[:, None]
    one = (boxes[None, :, :2] - starts[:, None]) / step
    two = (boxes[None, :, 2:] - starts[:, None]) / step
    enter = np.maximum(np.minimum(one, two).max(axis=2), 0.0)
    leave = np.minimum(np.maximum(one, two).min(axis=2), 1.0)
    return np.asarray(enter < leave)
