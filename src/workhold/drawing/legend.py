"""What the signs on a plan mean: those that every plan has, those of what moves, and those of what the part lies on."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from workhold.drawing.bench import ARROW, PEG_FILL, TOUCHED
from workhold.drawing.clamps import block_arrow, draw_sign
from workhold.drawing.fonts import text_width
from workhold.drawing.panel import Column, pegs_words
from workhold.drawing.plates import draw_wall
from workhold.drawing.scene import BLACK, GREY, Box, Scene, View
from workhold.fixels.carrier import Measure
from workhold.fixels.contact_kind import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END, ContactKind
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point

__all__ = ["draw_legend"]

# Draws a sign about a page point.
Sign = Callable[[Scene, Point], None]

WORDS = 11.5


def peg(scene: Scene, at: Point) -> None:
    """Draw a peg."""
    scene.circle(at, 7, PEG_FILL, BLACK, 1.2)


def hole(scene: Scene, at: Point) -> None:
    """Draw an empty hole."""
    scene.circle(at, 7, "#ffffff", GREY, 0.9)


def push(scene: Scene, at: Point) -> None:
    """Draw the arrow behind a clamp."""
    block_arrow(scene, at, (-1.0, 0.0), 0.55)


def line(scene: Scene, at: Point) -> None:
    """Draw the line that the tip of a clamp is on."""
    scene.line([(at[0] - 15, at[1]), (at[0] + 16, at[1])], BLACK, 1.0, stroke_dasharray="7 4")


def wall(scene: Scene, at: Point) -> None:
    """Draw a piece of a wall."""
    draw_wall(scene, Box(at[0] - 15, -at[1] - 6, at[0] + 16, -at[1] + 3), View(1.0, 0.0, 0.0))


def force(scene: Scene, at: Point) -> None:
    """Draw the arrow of a force from its contact."""
    x, y = at
    scene.circle((x - 14, y), 2.8, ARROW)
    scene.arrow((x - 14, y), (x + 16, y), ARROW, 2.4, 12)


def face(scene: Scene, at: Point) -> None:
    """Draw a face that is touched."""
    ends = [(at[0] - 15, at[1]), (at[0] + 16, at[1])]
    scene.line(ends, TOUCHED, 8)
    scene.line(ends, BLACK, 2.2)


PUSH = push, "which way the clamp pushes"
# The signs of what moves, by what is set on it, and of what else a part touches, by the kind of contact.
OF_MOVING: Mapping[Measure, tuple[tuple[Sign, str], ...]] = {
    "opening": (),
    "stroke": ((draw_sign, "clamp: bolt, body and tip"), PUSH),
    "tip": ((line, "line of holes that the clamp is on"), PUSH),
}
OF_CONTACTS: Mapping[ContactKind, tuple[tuple[Sign, str], ...]] = {
    ROUND_PIN: (),
    FLAT_PIN: (),
    CLAMP_TIP: (),
    WALL_END: ((wall, "{noun} that the part lies flush on"),),
}


def draw_legend(column: Column, toolkit: Toolkit, fill: str = GREY) -> None:
    """Explain the signs; ``fill`` is the colour of the words."""
    first = toolkit.plates[0]
    named = f"{first.noun}, column, row" if first.letter else "column, row"
    signs: list[tuple[Sign, str]] = [
        (peg, f"{first.peg} to place, with its hole: {named}"),
        (hole, "hole, left empty"),
        *OF_MOVING[toolkit.moving.measure],
        *((draw, words.format(noun=one.noun)) for one in toolkit.carriers for draw, words in OF_CONTACTS[one.contact]),
        (force, f"force of the {pegs_words(toolkit)} on the part, longer if larger"),
        (face, "face touched, with its number"),
    ]
    for draw, words in signs:
        y = column.y + 8
        draw(column.scene, (column.x + 16, y))
        size = min(WORDS, WORDS * (column.width - 44) / text_width(words, WORDS))
        column.scene.text((column.x + 44, y), words, size, fill=fill)
        column.y += 21
