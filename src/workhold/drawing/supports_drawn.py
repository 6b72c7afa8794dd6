"""Supports and the clamp on top on the plan of a set-up: their signs, the triangle, and their names."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos, pi, sin

from attrs import frozen

from workhold.drawing.annotation import Label, LabelPlacer, Place, around, leader_end
from workhold.drawing.scene import Box, Scene, View, text_width
from workhold.geometry.segment import Point
from workhold.model.recounted import ChosenSupports

__all__ = ["SUPPORT", "PlannedSupports", "draw_pad", "draw_supports", "draw_tip", "draw_triangle", "size_of"]

SUPPORT = "#1b6e3c"
# A sign is at least so large, page units.
SMALLEST = 6.0
NAME, HIGH = 13.0, 19.0
TOP_NAME = "clamp on top"


@frozen
class PlannedSupports:
    """Supports in the plan, in mm in the vise frame.

    Parameters
    ----------
    names, places : of the holes of the three.
    holes : their carriers, columns and rows.
    pad_radius : of the pads.
    clamp, tip_radius : of the clamp on top.
    """

    names: tuple[str, ...]
    places: tuple[Point, ...]
    holes: tuple[tuple[str, int, int], ...]
    pad_radius: float
    clamp: Point
    tip_radius: float

    @classmethod
    def of(cls, chosen: ChosenSupports) -> PlannedSupports:
        """The supports of a set-up."""
        pose, request = chosen.recounted.fixture.pose, chosen.supports.request

        def placed(x: float, y: float) -> Point:
            there = pose.apply(x, y)
            return float(there[0]), float(there[1])

        return cls(
            names=tuple(pad.hole for pad in chosen.pads),
            places=tuple(placed(pad.x, pad.y) for pad in chosen.pads),
            holes=tuple((pad.carrier, pad.column, pad.row) for pad in chosen.pads),
            pad_radius=request.pad_radius,
            clamp=placed(*chosen.clamp.at),
            tip_radius=request.tip_radius,
        )

    def holes_on(self, carrier: str) -> set[tuple[int, int]]:
        """Columns and rows of the supports on a carrier."""
        return {(column, row) for name, column, row in self.holes if name == carrier}

    def avoided(self, placer: LabelPlacer, view: View) -> None:
        """Marks where these are drawn, so that labels keep off."""
        corners = [*self.places, self.places[0]]
        for one, other in pairwise(corners):
            placer.avoid_line(view(one), view(other), 1.0)
        pad, tip = (size_of(radius, view) for radius in (self.pad_radius, self.tip_radius))
        for at, radius in (*((place, pad) for place in self.places), (self.clamp, tip)):
            x, y = view(at)
            placer.avoid_box(Box(x, y, x, y).grown(radius))

    def labels(self, view: View) -> list[Label]:
        """Candidates for the names of the three, and for that of the clamp."""
        turns = [2 * pi * k / 24 for k in range(24)]
        found = []
        named = [(name, at, self.pad_radius) for name, at in zip(self.names, self.places, strict=True)]
        for name, at, radius in [*named, (TOP_NAME, self.clamp, self.tip_radius)]:
            size = (text_width(name, NAME, bold=True) + 8, HIGH)
            near = size_of(radius, view)
            found.append(
                around(
                    view(at),
                    -pi / 4,
                    size,
                    [near + gap for gap in (3, 8, 16, 28, 44, 64)],
                    turns,
                    turn_cost=1.0,
                )
            )
        return found

    def draw_names(self, scene: Scene, places: Sequence[Place], view: View) -> None:
        """Writes the names where they were placed, with leaders from the signs."""
        for name, place, radius in zip(
            (*self.names, TOP_NAME), places, (*[self.pad_radius] * 3, self.tip_radius), strict=True
        ):
            (x, y), (u, v) = place.anchor, leader_end(place.anchor, place.box)
            gap = ((u - x) ** 2 + (v - y) ** 2) ** 0.5
            near = size_of(radius, view)
            if gap > near + 1.0:
                scene.line([(x + near * (u - x) / gap, y + near * (v - y) / gap), (u, v)], SUPPORT, 1.2)
            scene.rectangle(place.box, "#ffffff", SUPPORT, 1.2, 3)
            scene.text(place.box.center, name, NAME, "middle", bold=True, fill=SUPPORT)


def size_of(radius: float, view: View) -> float:
    """Radius of a sign on the page."""
    return max(radius * view.scale, SMALLEST)


def draw_supports(scene: Scene, supports: PlannedSupports, view: View) -> None:
    """Draws the triangle of the supports, their pads, and the tip of the clamp on top."""
    group = scene.group("supports", view)
    corners = [view(place) for place in supports.places]
    draw_triangle(group, corners)
    for at in corners:
        draw_pad(group, at, size_of(supports.pad_radius, view))
    draw_tip(group, view(supports.clamp), size_of(supports.tip_radius, view))


def draw_triangle(scene: Scene, corners: Sequence[Point]) -> None:
    """Draws the triangle of three supports, given on the page."""
    for one, other in pairwise([*corners, corners[0]]):
        scene.line([one, other], SUPPORT, 1.1, stroke_dasharray="9 3 2 3", **{"class": "support-triangle"})


def draw_pad(scene: Scene, at: Point, radius: float = 7.0) -> None:
    """Draws a support seen from above about a page point: a disc with a triangle."""
    scene.circle(at, radius, "#ffffff", SUPPORT, 1.6, **{"class": "support"})
    corners = [
        (at[0] + 0.72 * radius * sin(2 * pi * k / 3), at[1] - 0.72 * radius * cos(2 * pi * k / 3))
        for k in range(3)
    ]
    scene.polygon(corners, SUPPORT)


def draw_tip(scene: Scene, at: Point, radius: float = 7.0) -> None:
    """Draws the tip of a clamp that presses down about a page point: a disc with a cross."""
    scene.circle(at, radius, "#ffffff", SUPPORT, 2.2, **{"class": "top-clamp"})
    reach = radius * cos(pi / 4)
    for way in (1, -1):
        scene.line([(at[0] - reach, at[1] - way * reach), (at[0] + reach, at[1] + way * reach)], SUPPORT, 1.8)
